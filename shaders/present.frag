// The finished picture: exposed, tone-mapped, encoded as sRGB, dithered against banding.

#include "picture_block.glsl"
#include "tone_map.glsl"
#include "encode.glsl"

uniform sampler2D picture;          // linear light

layout(location = 0) out vec4 screen;

// Interleaved gradient noise (Jimenez 2014), -0.5..0.5: less visible than random noise, and still in time.
float dither(vec2 pixel) {
    return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715)))) - 0.5;
}

void main() {
    vec3 light = picture_look.x * texelFetch(picture, ivec2(gl_FragCoord.xy), 0).rgb;
    screen = vec4(srgb_from_linear(tone_map(light)) + dither(gl_FragCoord.xy) / 255.0, 1.0);
}
