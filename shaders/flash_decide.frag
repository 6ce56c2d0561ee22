// Decides how bright each cell is shown, and remembers the changes of that (src/flash/limiter.rs).

#include "flash_swing.glsl"
#include "flash_rows.glsl"

uniform sampler2D cells;            // mean colours
uniform sampler2D light_swings;     // of flash_follow.frag, for this picture
uniform sampler2D red_swings;
uniform sampler2D light_rest;
uniform sampler2D limited_rows;     // of flash_areas.frag
uniform sampler2D shown_swings;     // what this pass wrote for the last picture: see below
uniform sampler2D shown_ages;
uniform sampler2D shown_rest;
uniform sampler2D shown_red_swings;
uniform sampler2D shown_red_ages;

layout(location = 0) out vec4 swing;        // xyz the swing of the luminance that is shown, w its ceiling
layout(location = 1) out vec4 newest;       // ages of its changes
layout(location = 2) out vec4 others;       // xy two more, z share of grey, w the fifth age of red
layout(location = 3) out vec4 correction;   // x gain, y share of grey, z whether the cell is limited, w the mean gain
layout(location = 4) out vec4 red_swing;    // xyz the swing of the red that is shown, w the sixth age of its changes
layout(location = 5) out vec4 red_newest;   // ages of its changes

void main() {
    ivec2 cell = ivec2(gl_FragCoord.xy);
    vec4 limited = texelFetch(limited_rows, ivec2(0, cell.y), 0);
    bool of_light = has_bit(row_of(limited.xy), cell.x);
    bool of_red = has_bit(row_of(limited.zw), cell.x);
    bool holds_light = of_light && !is_put_off(texelFetch(light_swings, cell, 0).w);
    bool holds_red = of_red && !is_put_off(texelFetch(red_swings, cell, 0).w);
    vec3 color = texelFetch(cells, cell, 0).rgb;
    float came = luminance(color);
    vec2 lows = texelFetch(light_rest, cell, 0).zw;
    vec4 state = remembered(texelFetch(shown_swings, cell, 0), vec4(NO_SWING, NEVER));
    vec4 rest = remembered(texelFetch(shown_rest, cell, 0), vec4(NEVER, NEVER, 0.0, NEVER));
    Ages ages = aged(remembered(texelFetch(shown_ages, cell, 0), vec4(NEVER)), rest.xy);

    float seconds = flash_step.x;
    float ceiling = holds_light ? min(min(lows.x, lows.y) + SWING, state.w + FOLLOW * seconds)
                                : state.w + RELEASE * seconds;
    ceiling = !holds_light && ceiling >= 1.0 ? NEVER : ceiling;
    float shown = min(came, ceiling);
    vec3 tried = state.xyz;
    if (of_light && light_change(tried, shown) > 0.0 && are_enough(ages, 0.0)) {
        shown = min(shown, state.y + SWING);
    }
    bool renews = may_count_only_at(state.xyz, shown);
    float change = light_change(state.xyz, shown);
    note_change(ages, change, renews);

    float grey = holds_red ? GREY : max(rest.z - RED_RELEASE * seconds, 0.0);
    float gain = shown < came ? shown / came : 1.0;
    vec4 red = remembered(texelFetch(shown_red_swings, cell, 0), vec4(NO_RED_SWING, NEVER));
    Ages reds = aged(remembered(texelFetch(shown_red_ages, cell, 0), vec4(NEVER)), vec2(rest.w, red.w));
    tried = red.xyz;
    bool puts_off = of_red && red_change(tried, mix(color, vec3(came), grey) * gain) > 0.0 && are_enough(reds, 0.0);
    float shown_grey = puts_off ? GREY : grey;
    vec3 shown_color = mix(color, vec3(came), shown_grey) * gain;
    renews = may_count_only_as_red(red.xyz, shown_color);
    change = red_change(red.xyz, shown_color);
    note_change(reds, change, renews);

    swing = vec4(state.xyz, ceiling);
    newest = ages.newest;
    others = vec4(ages.oldest, grey, reds.oldest.x);
    correction = vec4(gain, shown_grey, shown < came || shown_grey > 0.0 ? 1.0 : 0.0, gain);
    red_swing = vec4(red.xyz, reds.oldest.y);
    red_newest = reds.newest;
}
