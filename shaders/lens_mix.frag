// Mixes sharp and blurred light. The light is sharp where a point's disc is smaller than a pixel, and blurred
// elsewhere.

#include "post_block.glsl"

uniform sampler2D picture;          // sharp light
uniform sampler2D blurred;          // blurred, half as large; alpha the fraction in front
uniform sampler2D spreads;          // radius of each point's disc, in pixels

layout(location = 0) out vec4 light;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    vec2 place = post_place();
    // Use a tent filter, so that the taps and the texels of the smaller image do not show.
    vec2 step = 0.5 / vec2(textureSize(blurred, 0));
    vec4 soft = vec4(0.0);
    for (int i = 0; i < 4; i++) soft += 0.25 * texture(blurred, place + step * vec2(2 * (i & 1) - 1, 2 * (i >> 1) - 1));
    float spread = abs(texelFetch(spreads, texel, 0).r);
    float fraction = max(smoothstep(0.5, 3.0, spread), soft.a);
    light = vec4(mix(texelFetch(picture, texel, 0).rgb, soft.rgb, fraction), 1.0);
}
