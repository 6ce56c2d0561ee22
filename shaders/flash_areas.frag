// Computes the cells of each row that crowded fields cover.

#include "flash_rows.glsl"

uniform sampler2D covered_rows;     // output of flash_fields.frag

layout(location = 0) out vec4 crowded;  // xy for light, zw for red

void main() {
    int own = int(gl_FragCoord.y);
    // A field that begins in a row also covers the following rows.
    uvec2 light = uvec2(0u);
    uvec2 red = uvec2(0u);
    for (int row = max(own - FIELD_ROWS + 1, 0); row <= own; row++) {
        vec4 covered = texelFetch(covered_rows, ivec2(0, row), 0);
        light |= row_of(covered.xy);
        red |= row_of(covered.zw);
    }
    crowded = vec4(light, red);
}
