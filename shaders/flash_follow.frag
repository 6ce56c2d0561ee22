// Detects changes of cells before the limiter, and rises that would exceed the number of flashes
// (tests/flash_twin/src/limiter.rs).

#include "flash_swing.glsl"

uniform sampler2D cells;            // mean colours of this frame
uniform sampler2D light_swings;     // output of this pass for the last frame
uniform sampler2D red_swings;
uniform sampler2D light_ages;
uniform sampler2D light_rest;
uniform sampler2D red_ages;
uniform sampler2D red_rest;
uniform sampler2D shown_swings;     // output of flash_note.frag
uniform sampler2D shown_rest;
uniform sampler2D shown_red_swings;

#include "flash_halves.glsl"

FIRST_HALF(0) vec4 light_swing;     // xyz the swing, w the remaining seconds of the cell's mark
FIRST_HALF(1) vec4 red_swing;       // xyz the swing, w the remaining seconds of the cell's mark
FIRST_HALF(2) vec4 light_newest;    // ages of changes
OTHER_HALF(0) vec4 light_others;    // xy two older ages
OTHER_HALF(1) vec4 red_newest;
OTHER_HALF(2) vec4 red_others;

void main() {
    ivec2 cell = ivec2(gl_FragCoord.xy);
    vec3 color = texelFetch(cells, cell, 0).rgb;
    float light = luminance(color);

    vec4 rest = remembered(texelFetch(light_rest, cell, 0), vec4(NEVER));

    vec4 state = remembered(texelFetch(light_swings, cell, 0), vec4(NO_SWING, 0.0));
    Ages ages = aged(remembered(texelFetch(light_ages, cell, 0), vec4(NEVER)), rest.xy);
    float change = light_change(state.xyz, light);
    float hold = left_of(state.w);
    hold = change > 0.0 && are_enough(ages, EARLY) ? HOLD : hold;
    note_change(ages, change, false);
    // Mark the cell if its allowed colour after the limiter would rise once too often.
    vec4 shown = remembered(texelFetch(shown_swings, cell, 0), vec4(NO_SWING, NEVER));
    vec4 shown_ages = remembered(texelFetch(shown_rest, cell, 0), vec4(NEVER));
    bool rises = light_change(shown.xyz, min(light, shown.w + RELEASE * flash_step.x)) > 0.0;
    hold = max(hold, rises ? hold_after(aged(vec4(NEVER), shown_ages.xy)) : 0.0);
    light_swing = vec4(state.xyz, hold);
    light_newest = ages.newest;
    light_others = vec4(ages.oldest, 0.0, 0.0);

    state = remembered(texelFetch(red_swings, cell, 0), vec4(NO_RED_SWING, 0.0));
    ages = aged(remembered(texelFetch(red_ages, cell, 0), vec4(NEVER)), remembered(texelFetch(red_rest, cell, 0), vec4(NEVER)).xy);
    change = red_change(state.xyz, color);
    hold = change > 0.0 && are_enough(ages, EARLY) ? HOLD : left_of(state.w);
    note_change(ages, change, false);
    shown = remembered(texelFetch(shown_red_swings, cell, 0), vec4(NO_RED_SWING, NEVER));
    rises = red_change(shown.xyz, color) > 0.0;
    hold = max(hold, rises ? hold_after(aged(vec4(NEVER), vec2(NEVER, shown.w))) : 0.0);
    red_swing = vec4(state.xyz, hold);
    red_newest = ages.newest;
    red_others = vec4(ages.oldest, 0.0, 0.0);
}
