// The scene's textures. texture_samplers.glsl is written for each scene (crates/render/src/gpu/scene_program.rs): a sampler
// for each texture, because in OpenGL 3.3 a variable cannot index an array of samplers, and
//
//     vec4 sample_texture(int index, vec2 uv, vec2 dx, vec2 dy)
//
// which reads a texture with the footprint of a pixel. dx and dy are the changes of uv to the pixel to the right and to
// the pixel above.

#ifdef PROJECTED
// Returns the place in a texture of `size` texels. Each of two eyes reads its own part of the last frame, and repeats the
// edge of this part.
vec2 texture_place(int index, vec2 uv, ivec2 size) {
    if (index != int(medium_low.w)) return uv;
    vec2 parts = viewport.xy / eye_size();
    vec2 edge = 0.5 * parts / vec2(size);
    return eye_corner(sample_place()).xy * viewport.zw + clamp(uv, edge, 1.0 - edge) / parts;
}
#define PLACE_IN(pixels) texture_place(index, uv, textureSize(pixels, 0))
#else
#define PLACE_IN(pixels) uv
#endif

#include "texture_samplers.glsl"

// Reads a texture at its finest level, for coordinates that depend on another texture.
vec4 read_texture(int index, float u, float v) {
    return sample_texture(index, vec2(u, v), vec2(0.0), vec2(0.0));
}
