// What the program tells every pass; written by src/frame/block.rs, in this order.

layout(std140) uniform FrameBlock {
    vec4 viewport;          // width, height, 1 / width, 1 / height, in pixels
    vec4 camera_position;   // xyz the eye; w half a pixel's width at distance 1
    vec4 camera_right;      // xyz to the right edge of the picture
    vec4 camera_up;         // xyz to the upper edge
    vec4 camera_forward;    // xyz into the picture, unit length
    vec4 frame_clock;       // time in seconds, tempo, phase
    vec4 frame_levels;      // x left volume, y right volume: mean |sample|, 0..1 (thesis section 5, eq. 1); z lights
    vec4 frame_sound;       // bass, mid, treble, beat
    vec4 bounds_low;        // xyz lower corner of what is traced; w 1 if there is anything but planes
    vec4 bounds_high;       // xyz upper corner; w 1 if the corners are known
    vec4 plane_objects;     // the object of each plane
    vec4 region_low;        // xyz lower corner of the tree of regions; w 1 if it has cells
    vec4 region_scale;      // xyz root cells per unit; w the texel of the tape that holds everywhere
    vec4 planes[PLANES_MAX];            // unit normal, and the origin's distance; normal 0 for none
    vec4 lights[2 * LIGHTS_MAX];        // xyz place, w 1, or towards xyz, w 2; then colour, w radius
    vec4 frame_bands[BAND_QUADS];       // 32 logarithmic bands, 0..1, four to a vector
    vec4 frame_params[PARAM_QUADS];     // the scene's parameters, four to a vector
    vec4 frame_hoisted[HOISTED_QUADS];  // what the program computed once for the frame
};

layout(std140) uniform PassBlock {
    vec4 sample_offset;     // xy from the pixel's centre, in pixels; z 1 for the further samples of an edge
};

// The names of the scene language's inputs in generated code.
#define frame_time frame_clock.x
#define frame_tempo frame_clock.y
#define frame_phase frame_clock.z
#define frame_volume frame_levels
