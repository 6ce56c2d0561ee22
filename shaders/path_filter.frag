// Smooths the noise that paths leave, but no edges: the edge-avoiding wavelets of Dammertz et al. 2010, in the form of
// Schied et al. 2017 (SVGF), without the earlier frames.
//
// FIRST divides the light of each pixel by the colour that it shows and adds its variance; passes with growing steps
// mix neighbours with a similar normal, depth, colour and light; LAST multiplies by the colour again.

#include "post_block.glsl"
#include "sample_light.glsl"
#include "path_state.glsl"

// Means over each pixel, directly or in mirrors and glass: layer 0 the normal and the distance, layer 1 the colour with the
// emitted light.
uniform sampler2DArray path_guides;
uniform sampler2D path_light;       // light and variance of the pass before

layout(location = 0) out vec4 light;

// Difference of light, in standard deviations, at which a neighbour counts less than half. The first pass allows more, so
// that single bright paths spread.
const float DEVIATIONS = 3.0;
const float FIRST_DEVIATIONS = 9.0;
const float NORMAL_SHARPNESS = 24.0;
const float COLOR_SHARPNESS = 6.0;
// Depths that differ by this fraction more than the surface's slope explains are on different surfaces.
const float DEPTH_FRACTION = 0.01;
// Total weight of the neighbours, of 220, below which a pixel is like too few.
const float LONELY = 40.0;

vec4 guide_of(ivec2 texel) {
    vec4 guide = texelFetch(path_guides, ivec3(texel, 0), 0);
    return vec4(guide.xyz * inversesqrt(max(dot(guide.xyz, guide.xyz), 1e-12)), guide.w);
}

vec3 color_of(ivec2 texel) {
    return max(texelFetch(path_guides, ivec3(texel, 1), 0).rgb, 0.02);
}

#if defined(FIRST)
// Returns the light of a pixel divided by its colour, and its variance.
vec4 light_of_state(ivec2 texel) {
    float count = float(max(paths_of(texelFetch(path_state, ivec3(texel, 0), 0).w), 1));
    vec4 sum = texelFetch(path_state, ivec3(texel, 3), 0) / count;
    float mean = brightness_of(sum.rgb);
    vec3 color = color_of(texel);
    float scale = 1.0 / brightness_of(color);
    // A single path tells nothing about its error.
    float variance = count > 1.0 ? max(sum.a - mean * mean, 0.0) / (count - 1.0) : mean * mean;
    return vec4(sum.rgb / color, variance * scale * scale);
}

// The part of a pixel's light that is far above the light of all its neighbours, from 0 to 1. A few bright paths make
// it, and the filter would leave it as a speck.
float excess_of(ivec2 texel, ivec2 last, vec4 own) {
    float most = 0.0;
    for (int i = 0; i < 9; i++) {
        ivec2 at = clamp(texel + ivec2(i % 3, i / 3) - 1, ivec2(0), last);
        if (at != texel) most = max(most, brightness_of(light_of_state(at).rgb));
    }
    float brightness = brightness_of(own.rgb);
    bool is_noisy = own.a > 0.05 * brightness * brightness;
    return is_noisy ? max(1.0 - 2.0 * most / max(brightness, 1e-12), 0.0) : 0.0;
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    ivec2 last = textureSize(path_state, 0).xy - 1;
    vec4 own = light_of_state(texel);
    // Neighbours share the excess, so that no light is lost.
    vec3 taken = vec3(0.0);
    for (int i = 0; i < 9; i++) {
        ivec2 at = texel + ivec2(i % 3, i / 3) - 1;
        if (any(lessThan(at, ivec2(0))) || any(greaterThan(at, last))) continue;
        vec4 other = light_of_state(at);
        taken += excess_of(at, last, other) * other.rgb / 9.0;
    }
    own.rgb = own.rgb * (1.0 - excess_of(texel, last, own)) + taken;
    vec3 normal = guide_of(texel).xyz;
    // A few paths that found no light seem to be certain. The mean of many neighbours knows better.
    float variance = 0.0;
    float weights = 0.0;
    for (int i = 0; i < 49; i++) {
        ivec2 at = clamp(texel + ivec2(i % 7, i / 7) - 3, ivec2(0), last);
        float weight = 0.01 + max(dot(normal, guide_of(at).xyz), 0.0);
        variance += weight * light_of_state(at).a;
        weights += weight;
    }
    light = vec4(own.rgb, variance / weights);
}
#elif defined(LAST)
void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy - post_target.zw);
    light = vec4(storable(texelFetch(path_light, texel, 0).rgb * color_of(texel)), 1.0);
}
#else
void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    ivec2 last = textureSize(path_light, 0) - 1;
    int stride = int(post_target.z);
    vec4 own = texelFetch(path_light, texel, 0);
    vec4 guide = guide_of(texel);
    vec3 color = color_of(texel);
    // The variance is noisy too, so the mean of 3 x 3 neighbours decides.
    float variance = 0.0;
    for (int i = 0; i < 9; i++) {
        ivec2 offset = ivec2(i % 3, i / 3) - 1;
        float weight = 0.25 * float(2 - abs(offset.x)) * 0.25 * float(2 - abs(offset.y));
        variance += weight * texelFetch(path_light, clamp(texel + offset, ivec2(0), last), 0).a;
    }
    float deviation = (stride == 1 ? FIRST_DEVIATIONS : DEVIATIONS) * sqrt(variance) + 1e-6;
    vec2 slope = vec2(1e9);
    for (int i = 0; i < 4; i++) {
        ivec2 offset = ivec2(i == 0 ? 1 : i == 1 ? -1 : 0, i == 2 ? 1 : i == 3 ? -1 : 0);
        float change = abs(guide_of(clamp(texel + offset, ivec2(0), last)).w - guide.w);
        if (i < 2) slope.x = min(slope.x, change); else slope.y = min(slope.y, change);
    }
    vec4 sum = vec4(0.0);
    float weights = 0.0;
    vec4 around = vec4(0.0);
    float weights_around = 0.0;
    for (int i = 0; i < 25; i++) {
        ivec2 offset = ivec2(i % 5, i / 5) - 2;
        ivec2 at = texel + stride * offset;
        if (any(lessThan(at, ivec2(0))) || any(greaterThan(at, last))) continue;
        vec4 other = texelFetch(path_light, at, 0);
        vec4 other_guide = guide_of(at);
        // The cubic B-spline: 1, 4, 6, 4, 1.
        vec2 kernel = vec2(offset.x == 0 ? 6.0 : abs(offset.x) == 1 ? 4.0 : 1.0,
                           offset.y == 0 ? 6.0 : abs(offset.y) == 1 ? 4.0 : 1.0);
        float facing = pow(max(dot(guide.xyz, other_guide.xyz), 0.0), NORMAL_SHARPNESS);
        float allowed = dot(vec2(abs(stride * offset)), slope) + DEPTH_FRACTION * guide.w;
        float away = abs(other_guide.w - guide.w) / max(allowed, 1e-6);
        float tinted = COLOR_SHARPNESS * distance(color_of(at), color);
        float unlike = abs(brightness_of(other.rgb) - brightness_of(own.rgb)) / deviation;
        float alike = kernel.x * kernel.y * exp(-tinted - unlike * unlike);
        float weight = alike * facing * exp(-away);
        weight = offset == ivec2(0) ? kernel.x * kernel.y : weight;
        if (stride == 1 && offset != ivec2(0)) {
            alike *= exp(-8.0 * unlike * unlike);  // DEVIATIONS instead of FIRST_DEVIATIONS
            around += alike * vec4(other.rgb, alike * other.a);
            weights_around += alike;
        }
        sum.rgb += weight * other.rgb;
        sum.a += weight * weight * other.a;
        weights += weight;
    }
    // Pixels on edges show several surfaces, and are like no neighbour. Noisy ones take the light around them.
    float lonely = 1.0 - smoothstep(0.0, LONELY, weights - 36.0);
    lonely *= smoothstep(0.1, 0.5, sqrt(variance) / (brightness_of(own.rgb) + 1e-6));
    around *= lonely;
    sum += vec4(around.rgb, lonely * around.a);
    weights += lonely * weights_around;
    light = vec4(sum.rgb / weights, sum.a / (weights * weights));
}
#endif
