// The uniform block of a pass over light; written by crates/render/src/gpu/post.rs.

layout(std140) uniform PostBlock {
    vec4 post_target;       // xy 1 / width, 1 / height of the target; zw parameters of the pass
};

// Returns the position of the current pixel, 0..1.
vec2 post_place() {
    return gl_FragCoord.xy * post_target.xy;
}
