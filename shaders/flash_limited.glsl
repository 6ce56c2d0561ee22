// Finds the limited cells (tests/flash_twin/src/limiter.rs). Include flash_swing.glsl first.

#include "flash_rows.glsl"

uniform sampler2D light_swings;     // output of flash_follow.frag for this frame
uniform sampler2D red_swings;
uniform sampler2D crowded_rows;     // output of flash_areas.frag

// For the light and the red of a cell: true if it is limited. `were` is 1 if it was limited in the last frame.
bvec2 are_limited(ivec2 cell, vec2 were) {
    vec4 crowded = texelFetch(crowded_rows, ivec2(0, cell.y), 0);
    bvec2 are_crowded = bvec2(has_bit(row_of(crowded.xy), cell.x), has_bit(row_of(crowded.zw), cell.x));
    vec2 holds = vec2(texelFetch(light_swings, cell, 0).w, texelFetch(red_swings, cell, 0).w);
    return bvec2(holds.x > 0.0 && (are_crowded.x || were.x > 0.5), holds.y > 0.0 && (are_crowded.y || were.y > 0.5));
}
