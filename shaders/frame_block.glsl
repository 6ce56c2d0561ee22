// The uniform block of every pass; written by crates/render/src/frame/block.rs, in this order.

layout(std140) uniform FrameBlock {
    vec4 viewport;          // width, height, 1 / width, 1 / height, in pixels
    vec4 camera_position;   // xyz the eye; w half a pixel's width at distance 1
    vec4 camera_right;      // xyz to the right edge of the frame; w the first texel of texts and pictures as shapes
    vec4 camera_up;         // xyz to the upper edge; w the rows of texts and pictures as shapes, 0 without any
    vec4 camera_forward;    // xyz along the viewing axis, unit length; w the light that nearby surfaces throw on
                            // each other, 0..1
    vec4 frame_clock;       // x time in seconds; y lights; z the row of the history at age 0, w the rows up to age 1
    vec4 block_bounds_low;        // xyz lower corner of the traced surfaces; w 1 if there are traced surfaces
    vec4 block_bounds_high;       // xyz upper corner; w 1 if the corners are known
    vec4 plane_objects;     // the object of each plane
    vec4 block_region_middle;     // xyz middle of the tree of regions; w half its side in cells of the first root, or 0
    vec4 block_region_scale;      // xyz cells of the first root per unit; w the texel of the whole tape
    vec4 frame_reach;       // x the reach of ambient occlusion and glow; y quality; z 0; w growth of a shadow ray's
                            // shortest step with each step
    vec4 frame_screen;      // xy width and height of the picture that the frame is shown as, in pixels; zw the picture's
                            // pixels per pixel of the frame
    vec4 frame_mouse;       // xy the pointer in the picture's pixels, from below; z 1 while its button is held; w the first texel
                            // of the swarms
    vec4 frame_projection;  // x a PROJECTION_..., y a STEREO_..., z half the distance of the eyes, w 1 / distance of the
                            // camera's target; only programs with PROJECTED read it
    vec4 medium_low;        // xyz lower corner of the media; w the scene's texture that is the last frame, or -1; only
                            // programs with PROJECTED read w
    vec4 medium_high;       // xyz upper corner of the media
    vec4 medium_grid_low;   // xyz lower corner of the grid over the media; w its first texel in the sound tables
    vec4 medium_grid_scale; // xyz cells of the grid per unit; w upper bound of the density
    vec4 block_planes[PLANES_MAX];       // unit normal, and the distance of the origin; normal 0: no plane
    vec4 lights[4 * LIGHTS_MAX];        // position, w its kind (for a sun xyz is the direction of its rays); colour, w
                                        // radius; half the right side, w range or 0; half the upper side, w fraction
                                        // that shadows remove
    vec4 frame_heard[HEARD_QUADS];      // numbers of the sound, four to a vector, in the order of their table
                                        // (crates/field/src/graph/sound_input.rs; volumes: Abt 2022, section 5, eq.
                                        // 1)
    vec4 frame_levels[LEVEL_COUNT];     // x a level that scenes read by number (crates/field/src/graph/levels.rs); one
                                        // per vector, so that an index reads one number
    vec4 frame_params[PARAM_QUADS];     // the scene's parameters, four to a vector
    vec4 frame_hoisted[HOISTED_QUADS];  // values that the CPU computes once per frame
};

layout(std140) uniform PassBlock {
    vec4 pass_sample;       // z 0 for each pixel's first sample, at its centre; 1 for a further one, xy from the
                            // centre, w its number from 0; 2 for packed samples of the pixels in edge_pixels;
                            // 3 for the media, in texels of 2 x 2 pixels, w the number of layers
    vec4 pass_list;         // xy size of a block in texels, one texel for each sample of a pixel; z radius of the beam
                            // around each sample's ray, in half widths of a pixel; w height of a layer of media in
                            // texels
    vec4 pass_places[8];    // xy and zw: positions of samples from their pixel's centre
};

#define frame_time frame_clock.x

// How much work a pixel may take, 0..1. It is 1 in stills, videos and measurements; a window changes it in small steps.
// Use it to reduce expensive work smoothly where the loss is hardly visible.
#define frame_quality frame_reach.y
#define shadow_step_growth frame_reach.w
#define nearby_bounce camera_forward.w

#ifndef PLANES
#define PLANES PLANES_MAX   // compiled scenes define their number
#endif

// For each pixel, llvmpipe takes thirty instructions to read a number from a uniform block, but none to read a copy. On
// llvmpipe, values that rays read often are therefore copied once per sample; `scene_load` does this for a compiled
// scene's inputs. On GPUs reading blocks is free, and copies would take registers.
#ifdef SOFTWARE
vec4 bounds_low;
vec4 bounds_high;
vec4 region_middle;
vec4 region_scale;
vec4 planes[PLANES_MAX];
int shape_first;
int shape_rows;

void load_frame() {
    bounds_low = block_bounds_low;
    bounds_high = block_bounds_high;
    region_middle = block_region_middle;
    region_scale = block_region_scale;
    shape_first = int(camera_right.w);
    shape_rows = int(camera_up.w);
    for (int i = 0; i < PLANES; i++) planes[i] = block_planes[i];
}
#else
#define bounds_low block_bounds_low
#define bounds_high block_bounds_high
#define region_middle block_region_middle
#define region_scale block_region_scale
#define planes block_planes
#define shape_first int(camera_right.w)
#define shape_rows int(camera_up.w)

void load_frame() {}
#endif

// Returns the plane with the given number. (With a variable index, the compiler would keep the copies in memory.)
vec4 plane_of(int number) {
    vec4 plane = planes[0];
    for (int i = 1; i < PLANES; i++) plane = number == i ? planes[i] : plane;
    return plane;
}
