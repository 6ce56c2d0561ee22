// The block that the program gives to one pass over light; written by src/gpu/post.rs.

layout(std140) uniform PostBlock {
    vec4 post_target;       // xy 1 / width, 1 / height of what is drawn into; zw parameters of the pass
};

// The place of the pixel that is drawn, 0..1.
vec2 post_place() {
    return gl_FragCoord.xy * post_target.xy;
}
