// Packs the new marks of each row's cells into bits, for the passes over fields of cells.

#include "flash_swing.glsl"
#include "flash_rows.glsl"

uniform sampler2D light_swings;     // output of flash_follow.frag for this frame
uniform sampler2D red_swings;

layout(location = 0) out vec4 marked;   // xy cells whose light has just flashed too often, zw the same for red

void main() {
    int row = int(gl_FragCoord.y);
    uvec2 light = uvec2(0u);
    uvec2 red = uvec2(0u);
    for (int column = 0; column < COLUMNS; column++) {
        ivec2 cell = ivec2(column, row);
        uvec2 bit = row_bit(column);
        vec4 swing = texelFetch(light_swings, cell, 0);
        light |= swing.x > 0.0 && is_fresh(swing.w) ? bit : uvec2(0u);
        swing = texelFetch(red_swings, cell, 0);
        red |= swing.x > 0.5 && is_fresh(swing.w) ? bit : uvec2(0u);
    }
    marked = vec4(light, red);
}
