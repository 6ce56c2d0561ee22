// How the picture is made from the scene's light; written by src/frame/picture.rs, in this order.

layout(std140) uniform PictureBlock {
    vec4 picture_look;      // exposure, share of bloom, vignette, grain
    vec4 picture_lens;      // x its radius, 0 if everything is sharp; y 1 / sharp distance; z largest blur, in
                            // heights of the picture
    vec4 picture_edges;     // smallest difference that gets more samples: x between surfaces, y on one
};
