// Halves the resolution for depth of field. The result is light, with the radius of its disc in alpha: in pixels of the
// halved image, negative in front of the sharp distance.

#include "post_block.glsl"

uniform sampler2D picture;          // twice as large
uniform sampler2D spreads;          // as large as `picture`: radius of each point's disc, in pixels

layout(location = 0) out vec4 smaller;

void main() {
    ivec2 limit = textureSize(spreads, 0) - 1;
    ivec2 corner = 2 * ivec2(gl_FragCoord.xy);
    vec4 sum = vec4(0.0);
    // Use the nearest of the four pixels, so that a sharp point is not blurred together with its background.
    float spread = 1e4;
    for (int i = 0; i < 8; i++) {
        ivec2 texel = min(corner + ivec2(i & 1, (i >> 1) & 1), limit);
        float own = texelFetch(spreads, texel, 0).r;
        spread = min(spread, own);
        if (i >= 4 && own < spread + 1.0) sum += vec4(texelFetch(picture, texel, 0).rgb, 1.0);
    }
    // Subtract the blur of halving and enlarging, so that the total blur is the lens's blur.
    float disc = sqrt(max(0.25 * spread * spread - 2.6, 0.0));
    smaller = vec4(sum.rgb / max(sum.a, 1.0), spread < 0.0 ? -disc : disc);
}
