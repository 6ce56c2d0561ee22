// The uniform block of the settings that turn light into an image; written by crates/render/src/frame/picture.rs, in
// this order.

layout(std140) uniform PictureBlock {
    vec4 picture_look;      // exposure, fraction of bloom, vignette, grain
    vec4 picture_lens;      // x lens radius, 0 for a sharp image; y 1 / sharp distance; z largest blur, in heights of
                            // the frame
    vec4 picture_edges;     // smallest difference that gets more samples: x between surfaces, y on one surface
};
