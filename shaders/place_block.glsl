// The uniform block for the last copy of a frame; written by crates/render/src/gpu/renderer/placing.rs.

layout(std140) uniform PlaceBlock {
    vec4 place_rows[3];     // xyz rows of a matrix from positions in the window, 0..1, to positions in the frame
    vec4 place_part;        // left, lower, right and upper edge of the visible part of the frame
};
