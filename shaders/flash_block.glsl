// The block that the program gives to the passes of the flash limiter; written by src/gpu/flash_pass.rs.

layout(std140) uniform FlashBlock {
    vec4 flash_step;    // x seconds since the last picture, y 1 if a part of the memory ends, z 1 if nothing is known
                        // of any picture before
};
