// What the program tells every pass; written by src/frame/block.rs, in this order.

layout(std140) uniform FrameBlock {
    vec4 viewport;          // width, height, 1 / width, 1 / height, in pixels
    vec4 camera_position;   // xyz the eye; w half a pixel's width at distance 1
    vec4 camera_right;      // xyz to the right edge of the picture; w scene time in seconds
    vec4 camera_up;         // xyz to the upper edge
    vec4 camera_forward;    // xyz into the picture, unit length
    vec4 sound;             // x left volume, y right volume: mean |sample|, 0..1 (thesis section 5, eq. 1)
    vec4 band_quads[8];     // 32 logarithmic bands, 0..1, four to a vector
};

layout(std140) uniform PassBlock {
    vec4 sample_offset;     // xy from the pixel's centre, in pixels; z 1 for the further samples of an edge
};

float band(int index) {
    return band_quads[index >> 2][index & 3];
}
