// The block that the program gives to the last copy of a picture; written by src/gpu/renderer/placing.rs.

layout(std140) uniform PlaceBlock {
    vec4 place_rows[3];     // xyz rows of a matrix from places of the window, 0..1, to places of the picture
    vec4 place_part;        // left, lower, right and upper edge of the part of the picture that shows
};
