// Computes the ceilings of brightness and the fractions of grey of cells (tests/flash_twin/src/limiter.rs).

#include "flash_swing.glsl"
#include "flash_limited.glsl"

uniform sampler2D cells;            // mean colours
uniform sampler2D shown_swings;     // output of flash_note.frag for the last frame
uniform sampler2D shown_rest;
uniform sampler2D shown_lows;
uniform sampler2D shown_red_swings;

layout(location = 0) out vec4 own;  // x ceiling, y highest luminance while a rise is delayed, z fraction of grey that
                                    // is shown, w the fraction without delayed rises

void main() {
    ivec2 cell = ivec2(gl_FragCoord.xy);
    vec4 lows = remembered(texelFetch(shown_lows, cell, 0), vec4(NEVER, NEVER, 0.0, 0.0));
    bvec2 limited = are_limited(cell, lows.zw);
    bool of_light = limited.x;
    bool of_red = limited.y;
    bool holds_light = of_light && !is_put_off(texelFetch(light_swings, cell, 0).w);
    bool holds_red = of_red && !is_put_off(texelFetch(red_swings, cell, 0).w);
    vec3 color = texelFetch(cells, cell, 0).rgb;
    float came = luminance(color);
    vec4 state = remembered(texelFetch(shown_swings, cell, 0), vec4(NO_SWING, NEVER));
    vec4 rest = remembered(texelFetch(shown_rest, cell, 0), vec4(NEVER, NEVER, 0.0, NEVER));
    Ages ages = aged(vec4(NEVER), rest.xy);

    float seconds = flash_step.x;
    float ceiling = holds_light ? min(min(lows.x, lows.y) + SWING, state.w + FOLLOW * seconds)
                                : state.w + RELEASE * seconds;
    ceiling = !holds_light && ceiling >= OPEN ? NEVER : ceiling;
    float shown = min(came, ceiling);
    vec3 tried = state.xyz;
    bool puts_off = of_light && light_change(tried, shown) > 0.0 && are_enough(ages, 0.0);
    float highest = puts_off ? state.y + SWING : NEVER;
    shown = min(shown, highest);

    float grey = holds_red ? GREY : max(rest.z - RED_RELEASE * seconds, 0.0);
    float gain = shown < came ? shown / came : 1.0;
    vec4 red = remembered(texelFetch(shown_red_swings, cell, 0), vec4(NO_RED_SWING, NEVER));
    Ages reds = aged(vec4(NEVER), vec2(rest.w, red.w));
    tried = red.xyz;
    bool puts_off_red =
        of_red && red_change(tried, mix(color, vec3(came), grey) * gain) > 0.0 && are_enough(reds, 0.0);
    own = vec4(ceiling, highest, puts_off_red ? GREY : grey, grey);
}
