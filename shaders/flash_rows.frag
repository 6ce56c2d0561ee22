// Gathers each row's marks of cells into bits, for the passes that look at fields of many cells.

#include "flash_swing.glsl"
#include "flash_rows.glsl"

uniform sampler2D cells;            // mean colours
uniform sampler2D light_swings;     // of flash_follow.frag, for this picture
uniform sampler2D red_swings;
uniform sampler2D light_rest;

layout(location = 0) out vec4 marked;   // xy cells whose light flashes too often, zw whose red does
layout(location = 1) out vec4 bright;   // xy cells that are brighter than a limited cell may be

void main() {
    int row = int(gl_FragCoord.y);
    uvec2 light = uvec2(0u);
    uvec2 red = uvec2(0u);
    uvec2 over = uvec2(0u);
    for (int column = 0; column < COLUMNS; column++) {
        ivec2 cell = ivec2(column, row);
        uvec2 bit = row_bit(column);
        vec2 lows = texelFetch(light_rest, cell, 0).zw;
        light |= texelFetch(light_swings, cell, 0).w > 0.0 ? bit : uvec2(0u);
        red |= texelFetch(red_swings, cell, 0).w > 0.0 ? bit : uvec2(0u);
        over |= luminance(texelFetch(cells, cell, 0).rgb) > min(lows.x, lows.y) + SWING ? bit : uvec2(0u);
    }
    marked = vec4(light, red);
    bright = vec4(over, 0.0, 0.0);
}
