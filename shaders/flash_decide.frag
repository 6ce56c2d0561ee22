// Decides how bright each cell is shown, and remembers the changes of that (src/flash/limiter.rs).

#include "flash_swing.glsl"
#include "flash_rows.glsl"

uniform sampler2D cells;            // mean colours
uniform sampler2D light_rest;       // of flash_follow.frag, for this picture
uniform sampler2D limited_rows;     // of flash_areas.frag
uniform sampler2D shown_swings;     // what this pass wrote for the last picture: see below
uniform sampler2D shown_ages;
uniform sampler2D shown_rest;

layout(location = 0) out vec4 swing;        // xyz the swing of the luminance that is shown, w its ceiling
layout(location = 1) out vec4 newest;       // ages of its changes
layout(location = 2) out vec4 others;       // xy two more, z share of grey
layout(location = 3) out vec4 correction;   // x gain, y share of grey, z whether the cell is limited, w the mean gain

void main() {
    ivec2 cell = ivec2(gl_FragCoord.xy);
    vec4 limited = texelFetch(limited_rows, ivec2(0, cell.y), 0);
    bool of_light = has_bit(row_of(limited.xy), cell.x);
    bool of_red = has_bit(row_of(limited.zw), cell.x);
    float came = luminance(texelFetch(cells, cell, 0).rgb);
    vec2 lows = texelFetch(light_rest, cell, 0).zw;
    vec4 state = remembered(texelFetch(shown_swings, cell, 0), vec4(NO_SWING, NEVER));
    vec4 rest = remembered(texelFetch(shown_rest, cell, 0), vec4(NEVER, NEVER, 0.0, 0.0));
    Ages ages = aged(remembered(texelFetch(shown_ages, cell, 0), vec4(NEVER)), rest.xy);

    float seconds = flash_step.x;
    float ceiling = of_light ? min(min(lows.x, lows.y) + SWING, state.w + FOLLOW * seconds)
                             : state.w + RELEASE * seconds;
    ceiling = !of_light && ceiling >= 1.0 ? NEVER : ceiling;
    float shown = min(came, ceiling);
    vec3 tried = state.xyz;
    if (of_light && light_change(tried, shown) > 0.0 && are_enough(ages)) {
        shown = min(shown, state.y + SWING);
    }
    note_change(ages, light_change(state.xyz, shown));
    float grey = of_red ? GREY : max(rest.z - RED_RELEASE * seconds, 0.0);

    swing = vec4(state.xyz, ceiling);
    newest = ages.newest;
    others = vec4(ages.oldest, grey, 0.0);
    float gain = shown < came ? shown / came : 1.0;
    correction = vec4(gain, grey, shown < came || grey > 0.0 ? 1.0 : 0.0, gain);
}
