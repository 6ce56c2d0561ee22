// The mean colour of each cell of the finished picture, in linear light, for the flash limiter.

#include "encode.glsl"

uniform sampler2D picture;      // finished
uniform sampler2D corrections;  // has one texel for each cell

layout(location = 0) out vec4 mean;

// A cell's colour is the mean of a square of its pixels, this many to each side.
const int SAMPLES = 8;

void main() {
    ivec2 size = textureSize(picture, 0);
    vec2 pixels_per_cell = vec2(size) / vec2(textureSize(corrections, 0));
    vec3 sum = vec3(0.0);
    for (int i = 0; i < SAMPLES * SAMPLES; i++) {
        vec2 inside = (vec2(i % SAMPLES, i / SAMPLES) + 0.5) / float(SAMPLES);
        ivec2 texel = ivec2((floor(gl_FragCoord.xy) + inside) * pixels_per_cell);
        sum += linear_from_srgb(texelFetch(picture, min(texel, size - 1), 0).rgb);
    }
    mean = vec4(sum / float(SAMPLES * SAMPLES), 1.0);
}
