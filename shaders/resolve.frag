// Computes each pixel's light as the weighted mean of the pixel's samples.

#include "post_block.glsl"
#include "sample_light.glsl"

uniform sampler2D picture;          // the first samples
#ifdef EDGE_LIST
uniform sampler2D extra_samples;    // further samples at edges, weighted, in blocks
uniform usampler2D edge_squares;    // number of the block of each pixel's samples, starting at 1; 0 for no block
#else
uniform sampler2D extra_samples;    // weighted sum of further samples
#endif

layout(location = 0) out vec4 light;

// Maximum number of samples in a block.
const int BLOCK_MAX = 16;

// Returns the weighted sum of a pixel's further samples. Alpha is the sum of the weights.
vec4 further_samples(ivec2 texel) {
#ifdef EDGE_LIST
    ivec2 square = ivec2(texelFetch(edge_squares, texel, 0).xy);
    ivec2 block = ivec2(post_target.zw);
    int count = square.x == 0 ? 0 : block.x * block.y;
    vec4 sum = vec4(0.0);
    for (int i = 0; i < BLOCK_MAX; i++) {
        if (i >= count) break;
        sum += texelFetch(extra_samples, block * (square - 1) + ivec2(i % block.x, i / block.x), 0);
    }
    return sum;
#else
    return texelFetch(extra_samples, texel, 0);
#endif
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    vec4 more = further_samples(texel);
#ifdef ALL_SAMPLES
    vec3 first = vec3(0.0);
    float weight = 0.0;
#else
    vec3 first = texelFetch(picture, texel, 0).rgb;
    float weight = sample_weight(first);
#endif
    vec3 mean = (first * weight + more.rgb) / max(weight + more.a, 1e-9);
    light = vec4(more.a > 0.0 ? min(mean, LIGHT_MAX) : first, 1.0);
}
