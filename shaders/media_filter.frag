// The mean of nine neighbouring rays of the pass of media, whose steps are at different places (media.glsl).

#include "frame_block.glsl"
#include "media_texels.glsl"

layout(location = 0) out vec4 light;
layout(location = 1) out float end;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    SeenMedium own = medium_texel(texel);
    SeenMedium sum = SeenMedium(vec3(0.0), 0.0, 0.0, 0.0);
    float weights = 0.0;
    for (int i = 0; i < 9; i++) weights += add_medium(sum, medium_texel(texel + ivec2(i % 3, i / 3) - 1), own, 1.0);
    SeenMedium mean = mean_medium(sum, weights, own.end);
    light = vec4(mean.light, mean.left);
    end = packed_end(mean);
}
