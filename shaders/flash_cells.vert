// Draws a rectangle for each group that contains a limited cell, as two triangles without a vertex buffer. The
// rectangles of other groups are empty. (A rectangle for each cell would be mostly edges.)

#include "flash_ceiling.glsl"

// Cells along each side of a group.
const int SIDE = 4;
// Margin of the rectangles, in cells. It may be generous: limit_flashes.frag decides where a cell ends.
const float MARGIN = 0.01;

void main() {
    int vertex = int(gl_VertexID);
    int corner = vertex % 6;
    int across = COLUMNS / SIDE;
    ivec2 first = SIDE * ivec2(vertex / 6 % across, vertex / 6 / across);
    bool limited = false;
    // Include the neighbouring cells, because ceilings are interpolated.
    for (int i = 0; i < (SIDE + 2) * (SIDE + 2); i++) {
        ivec2 cell = first + ivec2(i % (SIDE + 2), i / (SIDE + 2)) - 1;
        limited = limited || limits(ceiling_of(cell));
    }
    bvec2 far = bvec2(corner == 1 || corner == 2 || corner == 4, corner == 2 || corner == 4 || corner == 5);
    vec2 place = vec2(first) + mix(vec2(-MARGIN), vec2(float(SIDE) + MARGIN), far);
    gl_Position = vec4(limited ? place / vec2(float(COLUMNS), float(ROWS)) * 2.0 - 1.0 : vec2(-2.0), 0.0, 1.0);
}
