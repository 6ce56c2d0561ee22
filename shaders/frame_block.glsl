// The block that the program gives to every pass; written by src/frame/block.rs, in this order.

layout(std140) uniform FrameBlock {
    vec4 viewport;          // width, height, 1 / width, 1 / height, in pixels
    vec4 camera_position;   // xyz the eye; w half a pixel's width at distance 1
    vec4 camera_right;      // xyz to the right edge of the picture
    vec4 camera_up;         // xyz to the upper edge
    vec4 camera_forward;    // xyz into the picture, unit length
    vec4 frame_clock;       // x time in seconds; y lights; z the row of the history at age 0, w the rows from it to age 1
    vec4 block_bounds_low;        // xyz lower corner of what is traced; w 1 if there is anything but planes
    vec4 block_bounds_high;       // xyz upper corner; w 1 if the corners are known
    vec4 plane_objects;     // the object of each plane
    vec4 block_region_low;        // xyz lower corner of the tree of regions; w 1 if it has cells
    vec4 block_region_scale;      // xyz root cells per unit; w the texel of the tape that holds everywhere
    vec4 frame_reach;       // x the distance within which things take ambient light and give theirs; y quality; z 0;
                            // w how much the shortest step of a shadow ray grows with each step
    vec4 block_planes[PLANES_MAX];       // unit normal, and the distance of the origin; normal 0: no plane
    vec4 lights[4 * LIGHTS_MAX];        // place, w its kind (a sun's xyz are where its rays go); colour, w radius; half the right
                                        // side, w range or 0; half the upper side, w share that shadows take away
    vec4 frame_heard[HEARD_QUADS];      // numbers of the sound, four to a vector, in the order of their table
                                        // (crates/field/src/graph/sound_input.rs; volumes: Abt 2022, section 5, eq. 1)
    vec4 frame_bands[BAND_COUNT];       // x a logarithmic band, 0..1: an index reads one number, not one of four
    vec4 frame_params[PARAM_QUADS];     // the scene's parameters, four to a vector
    vec4 frame_hoisted[HOISTED_QUADS];  // values that the program computed once for the frame
};

layout(std140) uniform PassBlock {
    vec4 pass_sample;       // z 0 for each pixel's first sample, at its centre; 1 for a further one, xy from the centre, w
                            // its number from 0; 2 for those of the pixels in edge_pixels, side by side
    vec4 pass_list;         // xy size of a block in texels: one texel for each sample of a pixel; z radius of the beam
                            // around each sample's ray, in half widths of a pixel
    vec4 pass_places[8];    // xy and zw: places of samples from their pixel's centre
};

#define frame_time frame_clock.x

// How much a picture may cost besides its number of pixels, 0..1: 1 for the best, as in stills, videos and
// measurements. Whatever is costly and hardly missed may be reduced smoothly by it: the window changes it in small
// steps.
#define frame_quality frame_reach.y
#define shadow_step_growth frame_reach.w

#ifndef PLANES
#define PLANES PLANES_MAX   // compiled scenes know how many they have
#endif

// On llvmpipe, what rays read again and again is copied once for each sample, because it fetches every number of a block
// separately for each pixel: thirty instructions where a copy takes none. `scene_load` does the same for a compiled
// scene's inputs. A GPU reads blocks for nothing, and there copies take away registers.
#ifdef SOFTWARE
vec4 bounds_low;
vec4 bounds_high;
vec4 region_low;
vec4 region_scale;
vec4 planes[PLANES_MAX];

void load_frame() {
    bounds_low = block_bounds_low;
    bounds_high = block_bounds_high;
    region_low = block_region_low;
    region_scale = block_region_scale;
    for (int i = 0; i < PLANES; i++) planes[i] = block_planes[i];
}
#else
#define bounds_low block_bounds_low
#define bounds_high block_bounds_high
#define region_low block_region_low
#define region_scale block_region_scale
#define planes block_planes

void load_frame() {}
#endif

// The plane of that number. (A variable index would keep the copies in memory.)
vec4 plane_of(int number) {
    vec4 plane = planes[0];
    for (int i = 1; i < PLANES; i++) plane = number == i ? planes[i] : plane;
    return plane;
}
