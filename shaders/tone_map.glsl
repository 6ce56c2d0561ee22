// From exposed light, which is finite and not negative, to the screen's range. TONE_MAP says how, as
// src/lang/scene.rs numbers them.

vec3 tone_map(vec3 color) {
#if TONE_MAP == 2
    // Extended Reinhard on luminance (thesis section 3.2): what is as bright as WHITE becomes white.
    const float WHITE = 6.0;
    color *= 1.35;  // as bright as the other curves where light is neither weak nor strong
    float luminance = dot(color, vec3(0.2126, 0.7152, 0.0722));
    color *= (1.0 + luminance / (WHITE * WHITE)) / (1.0 + luminance);
#endif
    return clamp(color, 0.0, 1.0);
}
