// The cells of each row that are limited: the marked ones of crowded fields and, of light, the brighter ones around
// them, so that no edge is seen where a flashing light becomes too faint to count (src/flash/limiter.rs).

#include "flash_rows.glsl"

uniform sampler2D marked_rows;      // of flash_rows.frag
uniform sampler2D bright_rows;
uniform sampler2D covered_rows;     // of flash_fields.frag

layout(location = 0) out vec4 limited;  // xy of light, zw of red

// How often the spread may turn round before it is left as it is.
const int TURNS_MAX = 24;

uvec2 with_neighbours(uvec2 row) {
    return row | moved_up(row, 1) | moved_down(row, 1);
}

void main() {
    int own = int(gl_FragCoord.y);
    uvec2 red = uvec2(0u);
    uvec2 open[ROWS];
    uvec2 known[ROWS];
    uvec2 any = uvec2(0u);
    for (int row = 0; row < ROWS; row++) {
        vec4 covered = texelFetch(covered_rows, ivec2(0, row), 0);
        open[row] = row_of(covered.xy);
        any |= open[row];
        red |= row <= own && row > own - FIELD_ROWS ? row_of(covered.zw) : uvec2(0u);
    }
    red &= row_of(texelFetch(marked_rows, ivec2(0, own), 0).zw);
    limited = vec4(vec2(0.0), red);
    if ((any.x | any.y) == 0u) {
        return;
    }
    for (int row = ROWS - 1; row >= 0; row--) {
        // A field that begins in a row covers those after it, too.
        uvec2 crowded = uvec2(0u);
        for (int j = 0; j < FIELD_ROWS; j++) {
            crowded |= row >= j ? open[max(row - j, 0)] : uvec2(0u);
        }
        known[row] = crowded & row_of(texelFetch(marked_rows, ivec2(0, row), 0).xy);
        open[row] = crowded & (known[row] | row_of(texelFetch(bright_rows, ivec2(0, row), 0).xy));
    }
    // Down the rows and up again, until no cell joins.
    bool grows = true;
    for (int turn = 0; grows && turn < TURNS_MAX; turn++) {
        grows = false;
        uvec2 before = uvec2(0u);
        for (int i = 0; i < ROWS; i++) {
            int row = turn % 2 == 0 ? i : ROWS - 1 - i;
            uvec2 joined = known[row] | (with_neighbours(before) & open[row]);
            for (int column = 0; column < COLUMNS; column++) {
                uvec2 wider = joined | (with_neighbours(joined) & open[row]);
                if (wider == joined) {
                    break;
                }
                joined = wider;
            }
            grows = grows || joined != known[row];
            known[row] = joined;
            before = joined;
        }
        // The first turn goes only one way.
        grows = grows || turn == 0;
    }
    limited.xy = vec2(known[own]);
}
