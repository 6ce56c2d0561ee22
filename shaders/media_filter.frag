// The mean of nine neighbouring rays in each layer of the pass of media, whose steps are at different places
// (media.glsl).

#include "frame_block.glsl"
#include "post_block.glsl"
#include "media_texels.glsl"

layout(location = 0) out vec4 light;
layout(location = 1) out float end;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    SeenMedium own = medium_texel(texel);
    SeenMedium sum = SeenMedium(vec3(0.0), 0.0, 0.0, 0.0);
    float weights = 0.0;
    ivec2 size = ivec2(1.0 / post_target.xy + 0.5);
    int layers = textureSize(medium_light, 0).y / size.y;
    for (int i = 0; i < 9 * layers; i++) {
        ivec2 near = clamp(texel + ivec2(i % 3, i / 3 % 3) - 1, ivec2(0), size - 1);
        weights += add_medium(sum, medium_texel(near + ivec2(0, i / 9 * size.y)), own, 1.0);
    }
    SeenMedium mean = mean_medium(sum, weights, own.end);
    light = vec4(mean.light, mean.left);
    end = packed_end(mean);
}
