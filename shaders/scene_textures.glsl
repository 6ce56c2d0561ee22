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

// Reads a texture with the footprint of a pixel. dx and dy are the changes of uv to the pixel to the right and to the
// pixel above.
vec4 sample_texture(int index, vec2 uv, vec2 dx, vec2 dy) {
#if TEXTURES > 0
    if (index == 0) return textureGrad(scene_texture_0, uv, dx, dy);
#endif
#if TEXTURES > 1
    if (index == 1) return textureGrad(scene_texture_1, uv, dx, dy);
#endif
#if TEXTURES > 2
    if (index == 2) return textureGrad(scene_texture_2, uv, dx, dy);
#endif
#if TEXTURES > 3
    if (index == 3) return textureGrad(scene_texture_3, uv, dx, dy);
#endif
#if TEXTURES > 4
    if (index == 4) return textureGrad(scene_texture_4, uv, dx, dy);
#endif
#if TEXTURES > 5
    if (index == 5) return textureGrad(scene_texture_5, uv, dx, dy);
#endif
#if TEXTURES > 6
    if (index == 6) return textureGrad(scene_texture_6, uv, dx, dy);
#endif
#if TEXTURES > 7
    if (index == 7) return textureGrad(scene_texture_7, uv, dx, dy);
#endif
#if TEXTURES > 8
    if (index == 8) return textureGrad(scene_texture_8, uv, dx, dy);
#endif
#if TEXTURES > 9
    if (index == 9) return textureGrad(scene_texture_9, uv, dx, dy);
#endif
#if TEXTURES > 10
    if (index == 10) return textureGrad(scene_texture_10, uv, dx, dy);
#endif
#if TEXTURES > 11
    if (index == 11) return textureGrad(scene_texture_11, uv, dx, dy);
#endif
    return vec4(0.0);
}

// Reads a texture at its finest level, for coordinates that depend on another texture.
vec4 read_texture(int index, float u, float v) {
    return sample_texture(index, vec2(u, v), vec2(0.0), vec2(0.0));
}
