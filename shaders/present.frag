// The finished picture: samples averaged, encoded as sRGB, dithered against banding.

#include "encode.glsl"

uniform sampler2D picture;          // one sample a pixel, linear 0..1
uniform sampler2D extra_samples;    // sum of further samples at edges; alpha counts them

layout(location = 0) out vec4 screen;

// Interleaved gradient noise (Jimenez 2014), -0.5..0.5: less visible than random noise, and still in time.
float dither(vec2 pixel) {
    return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715)))) - 0.5;
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    vec4 more = texelFetch(extra_samples, texel, 0);
    vec3 color = (texelFetch(picture, texel, 0).rgb + more.rgb) / (1.0 + more.a);
    screen = vec4(srgb_from_linear(color) + dither(gl_FragCoord.xy) / 255.0, 1.0);
}
