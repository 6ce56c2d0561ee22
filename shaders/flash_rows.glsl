// A row of cells has one bit per cell: x holds the lower half of the columns, y the upper half.

#include "flash_rules.glsl"

const int HALF = COLUMNS / 2;
const uint HALF_BITS = (1u << uint(HALF)) - 1u;

uvec2 row_bit(int column) {
    uint bit = 1u << uint(column % HALF);
    return column < HALF ? uvec2(bit, 0u) : uvec2(0u, bit);
}

bool has_bit(uvec2 row, int column) {
    return ((column < HALF ? row.x : row.y) >> uint(column % HALF) & 1u) != 0u;
}

// Moves a row to higher columns, by less than half of the columns.
uvec2 moved_up(uvec2 row, int by) {
    return uvec2(row.x << uint(by), row.y << uint(by) | row.x >> uint(HALF - by)) & HALF_BITS;
}

uvec2 moved_down(uvec2 row, int by) {
    return uvec2(row.x >> uint(by) | row.y << uint(HALF - by), row.y >> uint(by)) & HALF_BITS;
}

// Decodes a row; 32-bit floats hold each half exactly.
uvec2 row_of(vec2 stored) {
    return uvec2(stored);
}
