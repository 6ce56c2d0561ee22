// Multiplies a finished frame's light by a factor, for brightness and blackout (`gpu::renderer`).

#include "post_block.glsl"
#include "encode.glsl"

uniform sampler2D picture;      // finished

layout(location = 0) out vec4 screen;

void main() {
    vec3 color = texelFetch(picture, ivec2(gl_FragCoord.xy), 0).rgb;
    screen = vec4(srgb_from_linear(linear_from_srgb(color) * post_target.z), 1.0);
}
