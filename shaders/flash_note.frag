// Records the changes of each cell after the limiter (tests/flash_twin/src/limiter.rs).

#include "flash_swing.glsl"
#include "flash_limited.glsl"

uniform sampler2D shown_cells;      // mean colours of this frame after the limiter
uniform sampler2D own_ceilings;     // output of flash_decide.frag
uniform sampler2D shown_swings;     // output of this pass for the last frame
uniform sampler2D shown_ages;
uniform sampler2D shown_rest;
uniform sampler2D shown_lows;
uniform sampler2D shown_red_swings;
uniform sampler2D shown_red_ages;

#include "flash_halves.glsl"

FIRST_HALF(0) vec4 swing;       // xyz the swing of the luminance, w the cell's own ceiling
FIRST_HALF(1) vec4 newest;      // ages of the luminance's changes
FIRST_HALF(2) vec4 others;      // xy two older ages, z fraction of grey, w the fifth age of red
OTHER_HALF(0) vec4 lows;        // xy darkest luminance of this part of the memory and of the previous one, zw 1 if the
                                // cell's light and red are limited
OTHER_HALF(1) vec4 red_swing;   // xyz the swing of the red, w the sixth age of the red's changes
OTHER_HALF(2) vec4 red_newest;  // ages of the red's changes

void main() {
    ivec2 cell = ivec2(gl_FragCoord.xy);
    vec3 color = texelFetch(shown_cells, cell, 0).rgb;
    vec4 own = texelFetch(own_ceilings, cell, 0);
    float light = luminance(color);

    vec4 state = remembered(texelFetch(shown_swings, cell, 0), vec4(NO_SWING, NEVER));
    vec4 rest = remembered(texelFetch(shown_rest, cell, 0), vec4(NEVER, NEVER, 0.0, NEVER));
    Ages ages = aged(remembered(texelFetch(shown_ages, cell, 0), vec4(NEVER)), rest.xy);
    bool renews = may_count_only_at(state.xyz, light);
    float change = light_change(state.xyz, light);
    note_change(ages, change, renews);

    vec4 dark = remembered(texelFetch(shown_lows, cell, 0), vec4(NEVER, NEVER, 0.0, 0.0));
    bvec2 limited = are_limited(cell, dark.zw);
    dark.xy = flash_step.y > 0.5 ? vec2(NEVER, dark.x) : dark.xy;
    lows = vec4(min(dark.x, light), dark.y, limited);

    vec4 red = remembered(texelFetch(shown_red_swings, cell, 0), vec4(NO_RED_SWING, NEVER));
    Ages reds = aged(remembered(texelFetch(shown_red_ages, cell, 0), vec4(NEVER)), vec2(rest.w, red.w));
    renews = may_count_only_as_red(red.xyz, color);
    change = red_change(red.xyz, color);
    note_change(reds, change, renews);

    swing = vec4(state.xyz, own.x);
    newest = ages.newest;
    others = vec4(ages.oldest, own.w, reds.oldest.x);
    red_swing = vec4(red.xyz, reds.oldest.y);
    red_newest = reds.newest;
}
