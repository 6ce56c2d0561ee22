// The scene's textures. Each texture has its own sampler, because in OpenGL 3.3 a variable cannot index an array of
// samplers.

#if TEXTURES > 0
uniform sampler2D scene_texture_0;
#endif
#if TEXTURES > 1
uniform sampler2D scene_texture_1;
#endif
#if TEXTURES > 2
uniform sampler2D scene_texture_2;
#endif
#if TEXTURES > 3
uniform sampler2D scene_texture_3;
#endif
#if TEXTURES > 4
uniform sampler2D scene_texture_4;
#endif
#if TEXTURES > 5
uniform sampler2D scene_texture_5;
#endif
#if TEXTURES > 6
uniform sampler2D scene_texture_6;
#endif
#if TEXTURES > 7
uniform sampler2D scene_texture_7;
#endif
#if TEXTURES > 8
uniform sampler2D scene_texture_8;
#endif
#if TEXTURES > 9
uniform sampler2D scene_texture_9;
#endif
#if TEXTURES > 10
uniform sampler2D scene_texture_10;
#endif
#if TEXTURES > 11
uniform sampler2D scene_texture_11;
#endif

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

// Reads a texture with the footprint of a pixel. dx and dy are the changes of uv to the pixel to the right and to the
// pixel above.
vec4 sample_texture(int index, vec2 uv, vec2 dx, vec2 dy) {
#if TEXTURES > 0
    if (index == 0) return textureGrad(scene_texture_0, PLACE_IN(scene_texture_0), dx, dy);
#endif
#if TEXTURES > 1
    if (index == 1) return textureGrad(scene_texture_1, PLACE_IN(scene_texture_1), dx, dy);
#endif
#if TEXTURES > 2
    if (index == 2) return textureGrad(scene_texture_2, PLACE_IN(scene_texture_2), dx, dy);
#endif
#if TEXTURES > 3
    if (index == 3) return textureGrad(scene_texture_3, PLACE_IN(scene_texture_3), dx, dy);
#endif
#if TEXTURES > 4
    if (index == 4) return textureGrad(scene_texture_4, PLACE_IN(scene_texture_4), dx, dy);
#endif
#if TEXTURES > 5
    if (index == 5) return textureGrad(scene_texture_5, PLACE_IN(scene_texture_5), dx, dy);
#endif
#if TEXTURES > 6
    if (index == 6) return textureGrad(scene_texture_6, PLACE_IN(scene_texture_6), dx, dy);
#endif
#if TEXTURES > 7
    if (index == 7) return textureGrad(scene_texture_7, PLACE_IN(scene_texture_7), dx, dy);
#endif
#if TEXTURES > 8
    if (index == 8) return textureGrad(scene_texture_8, PLACE_IN(scene_texture_8), dx, dy);
#endif
#if TEXTURES > 9
    if (index == 9) return textureGrad(scene_texture_9, PLACE_IN(scene_texture_9), dx, dy);
#endif
#if TEXTURES > 10
    if (index == 10) return textureGrad(scene_texture_10, PLACE_IN(scene_texture_10), dx, dy);
#endif
#if TEXTURES > 11
    if (index == 11) return textureGrad(scene_texture_11, PLACE_IN(scene_texture_11), dx, dy);
#endif
    return vec4(0.0);
}

// Reads a texture at its finest level, for coordinates that depend on another texture.
vec4 read_texture(int index, float u, float v) {
    return sample_texture(index, vec2(u, v), vec2(0.0), vec2(0.0));
}
