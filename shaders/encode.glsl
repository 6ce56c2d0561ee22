// Conversion between linear light and sRGB (IEC 61966-2-1). Conversion happens only here, not in framebuffers.

vec3 srgb_from_linear(vec3 color) {
    vec3 low = 12.92 * color;
    vec3 high = 1.055 * pow(max(color, 0.0031308), vec3(1.0 / 2.4)) - 0.055;
    return mix(high, low, lessThan(color, vec3(0.0031308)));
}

vec3 linear_from_srgb(vec3 color) {
    vec3 low = color / 12.92;
    vec3 high = pow((max(color, 0.04045) + 0.055) / 1.055, vec3(2.4));
    return mix(high, low, lessThan(color, vec3(0.04045)));
}
