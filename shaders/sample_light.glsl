// Encoding of a sample's light, and its weight among the samples of its pixel.

#include "picture_block.glsl"

// The largest 16-bit float is 65504.
const float LIGHT_MAX = 60000.0;

// Replaces invalid and infinite light by black.
vec3 storable(vec3 light) {
    float luminance = dot(light, vec3(0.2126, 0.7152, 0.0722));
    if (!(luminance >= 0.0 && luminance < 1e30)) return vec3(0.0);
    return clamp(light, 0.0, LIGHT_MAX);
}

// With this weight, the visible brightness of the samples' mean is nearly the mean of their visible brightness, so
// edges of bright light stay smooth (Karis 2014). The weight is bounded so that sums fit in 16-bit floats.
float sample_weight(vec3 light) {
    float exposure = clamp(picture_look.x, 0.01, 1.0);
    return 1.0 / (1.0 + exposure * max(light.r, max(light.g, light.b)));
}

// Returns the sample to store. For a pixel's first sample, alpha is the key of the surfaces. Further samples are
// weighted, and alpha is the sum of the weights.
vec4 stored_sample(vec3 light, float key, bool further) {
    light = storable(light);
    float weight = sample_weight(light);
    return further ? vec4(light * weight, weight) : vec4(light, key);
}
