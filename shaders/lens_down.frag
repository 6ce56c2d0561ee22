// Half the size, for the blur of a lens: light, and in alpha how far it is spread, as the largest radius in pixels of
// the half size; negative in front of the sharp distance.

#include "post_block.glsl"

uniform sampler2D picture;          // twice as large
uniform sampler2D spreads;          // the same size: radius of the disc that a point becomes, in its pixels

layout(location = 0) out vec4 smaller;

void main() {
    ivec2 limit = textureSize(spreads, 0) - 1;
    ivec2 corner = 2 * ivec2(gl_FragCoord.xy);
    vec3 sum = vec3(0.0);
    // The nearest of them, so that what is sharp is not spread together with what is behind it.
    float spread = 1e4;
    for (int i = 0; i < 4; i++) {
        ivec2 texel = min(corner + ivec2(i & 1, i >> 1), limit);
        sum += texelFetch(picture, texel, 0).rgb;
        spread = min(spread, texelFetch(spreads, texel, 0).r);
    }
    // Without the spread that the halving and the way back add by themselves, so that both together are what the lens
    // does.
    float disc = sqrt(max(0.25 * spread * spread - 2.6, 0.0));
    smaller = vec4(0.25 * sum, spread < 0.0 ? -disc : disc);
}
