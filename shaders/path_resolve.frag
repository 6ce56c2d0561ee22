// Computes the mean light of each pixel's finished paths.

#include "post_block.glsl"
#include "sample_light.glsl"
#include "path_state.glsl"

layout(location = 0) out vec4 light;

void main() {
    // The state begins at this pixel of the frame.
    ivec2 texel = ivec2(gl_FragCoord.xy - post_target.zw);
    float count = float(max(paths_of(texelFetch(path_state, ivec3(texel, 0), 0).w), 1));
    light = vec4(storable(texelFetch(path_state, ivec3(texel, 3), 0).rgb / count), 1.0);
}
