// Dims those cells of a finished picture that would flash too often (src/gpu/flash_pass.rs). It is drawn over that
// picture, where it is shown or over a copy, so that all other pixels stay as they are.

#include "post_block.glsl"
#include "encode.glsl"
#ifdef ENLARGED
#include "enlarge.glsl"
#else
uniform sampler2D picture;      // finished
#endif

// Of each cell: x gain of linear light at its centre, y share of grey, z 1 if it is limited, 2 if all over by the gain
// w instead.
uniform sampler2D corrections;

layout(location = 0) out vec4 screen;

// The correction of a cell, or `own` if it is not limited: cells that do not flash must not affect those that do.
vec4 correction_of(vec2 cell, vec4 own) {
    ivec2 last = textureSize(corrections, 0) - 1;
    vec4 correction = texelFetch(corrections, clamp(ivec2(cell), ivec2(0), last), 0);
    return correction.z > 0.5 ? correction : own;
}

void main() {
    vec2 place = post_place() * vec2(textureSize(corrections, 0));
    vec4 own = correction_of(floor(place), vec4(1.0, 0.0, 0.0, 0.0));
    if (own.z < 0.5) {
        discard;
    }
#ifdef ENLARGED
    vec3 color = enlarged(post_place());
#else
    vec3 color = texelFetch(picture, ivec2(gl_FragCoord.xy), 0).rgb;
#endif
    // Interpolated between the centres of four cells.
    vec2 first = floor(place - 0.5);
    vec2 share = fract(place - 0.5);
    vec4 low = mix(correction_of(first, own), correction_of(first + vec2(1.0, 0.0), own), share.x);
    vec4 high = mix(correction_of(first + vec2(0.0, 1.0), own), correction_of(first + 1.0, own), share.x);
    vec4 correction = mix(low, high, share.y);
    correction.x = own.z > 1.5 ? own.w : correction.x;
    vec3 light = linear_from_srgb(color);
    float grey = dot(light, vec3(0.2126, 0.7152, 0.0722));
    screen = vec4(srgb_from_linear(mix(light, vec3(grey), correction.y) * correction.x), 1.0);
}
