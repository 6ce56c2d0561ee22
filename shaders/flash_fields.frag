// For each row, finds the columns of the crowded fields that begin in the row. A field is crowded if it has too many
// marked cells (tests/flash_twin/src/fields.rs).

#include "flash_rows.glsl"

uniform sampler2D marked_rows;      // output of flash_rows.frag

layout(location = 0) out vec4 covered;  // xy for light, zw for red

uint bits_of(uint row) {
    row -= row >> 1u & 0x5555u;
    row = (row & 0x3333u) + (row >> 2u & 0x3333u);
    row = row + (row >> 4u) & 0x0f0fu;
    return row + (row >> 8u) & 0x1fu;
}

// Returns the cells of a row that a field covers if it begins at this column.
uint window(uvec2 row, int column) {
    uvec2 rest = column < HALF ? row : uvec2(row.y, 0u);
    uint by = uint(column % HALF);
    return (rest.x >> by | rest.y << (uint(HALF) - by)) & ((1u << uint(FIELD_COLUMNS)) - 1u);
}

uvec2 crowded(uvec2 rows[FIELD_ROWS]) {
    uvec2 any = uvec2(0u);
    for (int j = 0; j < FIELD_ROWS; j++) {
        any |= rows[j];
    }
    uvec2 first = uvec2(0u);
    for (int column = 0; (any.x | any.y) != 0u && column <= COLUMNS - FIELD_COLUMNS; column++) {
        uint count = 0u;
        for (int j = 0; j < FIELD_ROWS; j++) {
            count += bits_of(window(rows[j], column));
        }
        first |= float(count) > AREA * float(FIELD_COLUMNS * FIELD_ROWS) ? row_bit(column) : uvec2(0u);
    }
    // `first` marks where each field begins. Mark all columns of the fields.
    for (int reach = 1; reach < FIELD_COLUMNS; reach *= 2) {
        first |= moved_up(first, min(reach, FIELD_COLUMNS - reach));
    }
    return first;
}

void main() {
    int row = int(gl_FragCoord.y);
    uvec2 light[FIELD_ROWS];
    uvec2 red[FIELD_ROWS];
    bool whole = row <= ROWS - FIELD_ROWS;
    for (int j = 0; j < FIELD_ROWS; j++) {
        vec4 marks = whole ? texelFetch(marked_rows, ivec2(0, row + j), 0) : vec4(0.0);
        light[j] = row_of(marks.xy);
        red[j] = row_of(marks.zw);
    }
    covered = vec4(crowded(light), crowded(red));
}
