// The uniform block for the passes of the flash limiter; written by crates/render/src/gpu/flash_pass.rs.

layout(std140) uniform FlashBlock {
    vec4 flash_step;    // x seconds since the last frame; y 1 if a part of the memory ends; z 1 if there is no earlier
                        // frame
};
