// From scene light to the screen's range.

const float EXPOSURE = 1.35;
const float WHITE = 6.0;

// Extended Reinhard on luminance (thesis section 3.2), the result linear in 0..1. Non-finite light becomes black
// rather than reach a pixel; the division is safe because luminance + 1 > 0.
vec3 tone_map(vec3 light) {
    vec3 color = light * EXPOSURE;
    float luminance = dot(color, vec3(0.2126, 0.7152, 0.0722));
    if (!(luminance >= 0.0 && luminance < 1e9)) return vec3(0.0);
    color *= (1.0 + luminance / (WHITE * WHITE)) / (1.0 + luminance);
    return clamp(color, 0.0, 1.0);
}
