// Mixes sharp and blurred light. The light is sharp where a point's disc is smaller than a pixel, and blurred
// elsewhere. A pixel at the edge of a sharp surface shows both: its samples have also met the surface behind, which is
// blurred in the picture.

#include "post_block.glsl"

uniform sampler2D picture;          // sharp light
uniform sampler2D blurred;          // blurred, half as large; alpha the fraction in front
uniform sampler2D spreads;          // radius of each point's disc, in pixels

layout(location = 0) out vec4 light;

// Discs of surfaces behind an edge are larger by this many pixels.
const float EDGE = 2.0;

float blurred_fraction(float spread) {
    return smoothstep(0.5, 3.0, abs(spread));
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    ivec2 limit = textureSize(picture, 0) - 1;
    vec2 place = post_place();
    // Use a tent filter, so that the taps and the texels of the smaller image do not show.
    vec2 step = 0.5 / vec2(textureSize(blurred, 0));
    vec4 soft = vec4(0.0);
    for (int i = 0; i < 4; i++) soft += 0.25 * texture(blurred, place + step * vec2(2 * (i & 1) - 1, 2 * (i >> 1) - 1));
    vec3 sharp = texelFetch(picture, texel, 0).rgb;
    float fraction = blurred_fraction(texelFetch(spreads, texel, 0).r);
    // Around the pixel: the least and the largest disc, the mean of the fractions, and the direction to blurred pixels.
    float least = 1e4;
    float most = -1e4;
    float mean = 0.0;
    vec2 towards = vec2(0.0);
    for (int i = 0; i < 9; i++) {
        ivec2 offset = ivec2(i % 3, i / 3) - 1;
        float spread = texelFetch(spreads, clamp(texel + offset, ivec2(0), limit), 0).r;
        float weight = (2.0 - abs(float(offset.x))) * (2.0 - abs(float(offset.y))) * (1.0 / 16.0);
        least = min(least, spread);
        most = max(most, spread);
        mean += weight * blurred_fraction(spread);
        towards += weight * blurred_fraction(spread) * vec2(offset);
    }
    if (most - least > EDGE && blurred_fraction(least) < 0.5 && dot(towards, towards) > 0.0) {
        // The surface's light without the light behind it; of a thin surface, its middle.
        vec2 back = normalize(towards);
        for (int i = 3; i > 0; i--) {
            ivec2 at = clamp(texel - ivec2(round(float(i) * back)), ivec2(0), limit);
            if (blurred_fraction(texelFetch(spreads, at, 0).r) < 0.5) {
                sharp = texelFetch(picture, at, 0).rgb;
                fraction = mean;
                break;
            }
        }
    }
    light = vec4(mix(sharp, soft.rgb, max(fraction, soft.a)), 1.0);
}
