// Dims those parts of a finished frame that would flash too often (`gpu::flash_pass`). The result is drawn over the
// frame in the window or over a copy of it, so that all other pixels stay unchanged.

#include "post_block.glsl"
#include "encode.glsl"
#include "flash_ceiling.glsl"
#ifdef ENLARGED
#include "enlarge.glsl"
#else
uniform sampler2D picture;      // finished
#endif

layout(location = 0) out vec4 screen;

void main() {
    vec2 ceiling = ceiling_at(post_place() * vec2(float(COLUMNS), float(ROWS)));
    if (!limits(ceiling)) {
        discard;
    }
#ifdef ENLARGED
    vec3 color = enlarged(post_place());
#else
    vec3 color = texelFetch(picture, ivec2(gl_FragCoord.xy), 0).rgb;
#endif
    screen = vec4(srgb_from_linear(below_ceiling(linear_from_srgb(color), ceiling)), 1.0);
}
