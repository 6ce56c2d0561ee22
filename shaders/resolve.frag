// The light of each pixel: the weighed mean of its samples.

#include "sample_light.glsl"

uniform sampler2D picture;          // the first samples
#ifdef EDGE_LIST
uniform sampler2D extra_samples;    // further samples at edges, weighed, two by two
uniform usampler2D edge_squares;    // which two by two those of a pixel are, counted from 1; 0 for none
#else
uniform sampler2D extra_samples;    // sum of further samples at edges, weighed
#endif

layout(location = 0) out vec4 light;

// Their sum; alpha sums the weights.
vec4 further_samples(ivec2 texel) {
#ifdef EDGE_LIST
    ivec2 square = ivec2(texelFetch(edge_squares, texel, 0).xy);
    vec4 sum = vec4(0.0);
    if (square.x == 0) return sum;
    for (int i = 0; i < 4; i++) {
        sum += texelFetch(extra_samples, 2 * (square - 1) + ivec2(i & 1, i >> 1), 0);
    }
    return sum;
#else
    return texelFetch(extra_samples, texel, 0);
#endif
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    vec3 first = texelFetch(picture, texel, 0).rgb;
    vec4 more = further_samples(texel);
    float weight = sample_weight(first);
    vec3 mean = (first * weight + more.rgb) / (weight + more.a);
    light = vec4(more.a > 0.0 ? min(mean, LIGHT_MAX) : first, 1.0);
}
