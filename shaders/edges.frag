// Keeps the pixels whose neighbourhood differs visibly: those get more samples. The others are discarded, so
// that the stencil marks the edges.

#include "encode.glsl"

uniform sampler2D picture;

// Smallest difference between neighbours, in encoded steps of 0..1, that gets more samples.
const float EDGE_CONTRAST = 0.045;

vec3 seen(ivec2 texel, ivec2 limit) {
    return srgb_from_linear(texelFetch(picture, clamp(texel, ivec2(0), limit), 0).rgb);
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    ivec2 limit = textureSize(picture, 0) - 1;
    vec3 low = seen(texel, limit);
    vec3 high = low;
    for (int i = 0; i < 4; i++) {
        ivec2 step = i == 0 ? ivec2(1, 0) : i == 1 ? ivec2(-1, 0) : i == 2 ? ivec2(0, 1) : ivec2(0, -1);
        vec3 color = seen(texel + step, limit);
        low = min(low, color);
        high = max(high, color);
    }
    vec3 contrast = high - low;
    if (max(contrast.r, max(contrast.g, contrast.b)) < EDGE_CONTRAST) discard;
}
