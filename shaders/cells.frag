// Computes the mean colour of each cell of the finished frame in linear light, for the flash limiter. With SHOWN, it
// computes the colours that the limiter produces.

#include "flash_rules.glsl"
#ifdef SHOWN
#include "flash_ceiling.glsl"

uniform sampler2D cells;        // the means of the finished frame
#endif

uniform sampler2D picture;      // finished

layout(location = 0) out vec4 mean;

// A cell's colour is the mean of a square of samples, with this number of samples along each side.
const int SAMPLES = 8;

// Approximates linear_from_srgb of encode.glsl within 0.0005. It avoids powers, which took half of this pass on a CPU.
vec3 roughly_linear(vec3 color) {
    return color * (0.044876 + color * (0.501656 + color * (0.599042 - 0.145574 * color)));
}

void main() {
    ivec2 size = textureSize(picture, 0);
    vec2 pixels_per_cell = vec2(size) / vec2(float(COLUMNS), float(ROWS));
    vec3 sum = vec3(0.0);
    int samples = SAMPLES * SAMPLES;
#ifdef SHOWN
    // Skip cells whose colour the limiter does not change.
    bool changes = false;
    ivec2 cell = ivec2(gl_FragCoord.xy);
    for (int i = 0; i < 9; i++) {
        changes = changes || limits(ceiling_of(cell + ivec2(i % 3, i / 3) - 1));
    }
    samples = changes ? samples : 0;
#endif
    for (int i = 0; i < samples; i++) {
        vec2 inside = (vec2(i % SAMPLES, i / SAMPLES) + 0.5) / float(SAMPLES);
        ivec2 texel = ivec2((floor(gl_FragCoord.xy) + inside) * pixels_per_cell);
        vec3 light = roughly_linear(texelFetch(picture, min(texel, size - 1), 0).rgb);
#ifdef SHOWN
        light = below_ceiling(light, ceiling_at(floor(gl_FragCoord.xy) + inside));
#endif
        sum += light;
    }
    mean = vec4(sum / float(SAMPLES * SAMPLES), 1.0);
#ifdef SHOWN
    if (!changes) mean = texelFetch(cells, cell, 0);
#endif
}
