// The finished picture: samples averaged, encoded as sRGB, dithered against banding.

#include "encode.glsl"

uniform sampler2D picture;          // one sample a pixel, linear 0..1
#ifdef EDGE_LIST
uniform sampler2D extra_samples;    // further samples at edges, two by two
uniform usampler2D edge_squares;    // which two by two those of a pixel are, counted from 1; 0 for none
#else
uniform sampler2D extra_samples;    // sum of further samples at edges; alpha counts them
#endif

layout(location = 0) out vec4 screen;

// Interleaved gradient noise (Jimenez 2014), -0.5..0.5: less visible than random noise, and still in time.
float dither(vec2 pixel) {
    return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715)))) - 0.5;
}

// Their sum; alpha counts them.
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
    vec4 more = further_samples(texel);
    vec3 color = (texelFetch(picture, texel, 0).rgb + more.rgb) / (1.0 + more.a);
    screen = vec4(srgb_from_linear(color) + dither(gl_FragCoord.xy) / 255.0, 1.0);
}
