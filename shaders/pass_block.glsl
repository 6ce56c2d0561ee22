// What the program tells one pass.

layout(std140) uniform PassBlock {
    vec4 pass_sample;       // z 0 for each pixel's first sample, at its centre; 1 for a further one, xy which; 2 for those of
                            // the pixels in edge_pixels, side by side. In upscale.frag xy pixels of the picture for one
                            // of the window
};
