// How a sample's light is stored, and how much it counts among those of its pixel.

#include "picture_block.glsl"

// 16-bit floats end at 65504.
const float LIGHT_MAX = 60000.0;

// Invalid and infinite light becomes black and never reaches a pixel.
vec3 storable(vec3 light) {
    float luminance = dot(light, vec3(0.2126, 0.7152, 0.0722));
    if (!(luminance >= 0.0 && luminance < 1e30)) return vec3(0.0);
    return clamp(light, 0.0, LIGHT_MAX);
}

// With this weight the mean of the samples is nearly the mean of their visible brightness: an edge of bright light
// stays smooth, because one sample of five does not outshine the others (Karis 2014). The bounds keep sums within
// 16-bit floats.
float sample_weight(vec3 light) {
    float exposure = clamp(picture_look.x, 0.01, 1.0);
    return 1.0 / (1.0 + exposure * max(light.r, max(light.g, light.b)));
}

// A pixel's first sample stores a key of its surfaces in alpha; further samples are weighted, and alpha sums the
// weights.
vec4 stored_sample(vec3 light, float key, bool further) {
    light = storable(light);
    float weight = sample_weight(light);
    return further ? vec4(light * weight, weight) : vec4(light, key);
}
