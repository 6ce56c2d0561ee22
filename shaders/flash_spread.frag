// Spreads ceilings and fractions of grey to neighbouring cells, along one axis (tests/flash_twin/src/limiter.rs).

#include "flash_rules.glsl"
// post_target.zw is a step along the axis.
#include "post_block.glsl"

uniform sampler2D ceilings;     // output of flash_decide.frag, or of this pass for the first axis

layout(location = 0) out vec4 spread;   // x ceiling, y highest luminance while a rise is delayed, z fraction of grey, w
                                        // the lower of x and y

void main() {
    ivec2 cell = ivec2(gl_FragCoord.xy);
    ivec2 axis = ivec2(post_target.zw);
    vec3 all = texelFetch(ceilings, cell, 0).xyz;
    for (int at = -REACH; at <= REACH; at++) {
        vec3 other = texelFetch(ceilings, clamp(cell + at * axis, ivec2(0), ivec2(COLUMNS, ROWS) - 1), 0).xyz;
        float beyond = float(max(abs(at), 1) - 1);
        float rise = CEILING_RISE * beyond * beyond;
        all.x = min(all.x, other.x + rise);
        all.y = beyond > 0.0 ? all.y : min(all.y, other.y);
        all.z = max(all.z, other.z - rise);
    }
    spread = vec4(all, min(min(all.x, all.y), OPEN));
}
