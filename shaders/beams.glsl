// Beams: on llvmpipe, further samples of a pixel do not start at the eye. A beam contains all rays of the pixel: at a
// distance t they are within the beam's radius of the first ray. The first ray finds the free distance of the beam. If
// all surfaces are farther away than twice the radius, the free ball around a step contains the beam and meets the
// previous ball. On llvmpipe, beams and NO_CELLS make compiled scenes without a tree 23 % faster (median), and
// interpreted scenes 2 %. On GPUs a beam would occupy one more register during shading, which costs waves, and beams
// would save less, because fewer pixels are at edges.

#if defined(SOFTWARE) && !defined(PATHS)
#define BEAMS
#endif

#ifdef BEAMS
// A ray that carries a beam skips a cell only if the bound is at least this many radii of the beam. In other cells the
// ray evaluates the distance, which may be larger than the bound.
const float BEAM_BOUND = 3.5;

// A single number holds the free distance and, in these bits, the number of steps.
const uint STEPS_BITS = 127u;

// The distance at which this sample's ray starts (no surface is nearer), and the number of steps up to that distance.
float ray_start = 0.0;
int ray_steps = 0;
// The radius of the beam at distance 1; 0 if no more samples follow.
float beam_spread = 0.0;
// The free distance of the beam, and the number of steps that this ray took up to that distance.
float beam_free = 0.0;
int beam_steps = 0;

// Returns the free distance of a beam after a step to t; negative once a surface was too near. `nearest` is a lower
// bound of the distance to all surfaces, from the start of the step or from the skipped cell.
float free_after(float free, float nearest, float t) {
    float radius = beam_spread * t;
    float stays = nearest >= 2.0 * radius ? t - radius : -free;
    return free > 0.0 ? stays : free;
}

// Other rays of the beam may enter the bounds earlier than this one.
float first_entry(vec3 origin, vec3 direction, float entry, bool reflected) {
    return reflected ? entry : traced_span(origin, direction, beam_spread * max(entry, 0.0)).x;
}

float first_start(float start, bool reflected) {
    return reflected ? start : ray_start;
}

int first_step(bool reflected) {
    return reflected ? 0 : ray_steps;
}

// Returns the smallest bound of a cell that a ray skips.
float least_bound(float least, float free, float t) {
    return free > 0.0 ? max(least, BEAM_BOUND * beam_spread * t) : least;
}

void store_beam_step(float free, int step) {
    if (free > 0.0) beam_steps = step + 1;
}

void store_beam(float free, bool reflected) {
    if (!reflected) beam_free = abs(free);
}

// Starts the ray where the pixel's first sample has found no surface before.
void begin_beam() {
    beam_spread = pass_list.z * camera_position.w;
    uint start = RAYS_START_TOGETHER ? sample_start() : 0u;
    ray_start = uintBitsToFloat(start & ~STEPS_BITS);
    ray_steps = int(start & STEPS_BITS);
}

// Returns the free distance of the beam; the last bits hold the number of steps.
float packed_beam() {
    uint steps = uint(min(beam_steps, int(STEPS_BITS)));
    return uintBitsToFloat((floatBitsToUint(beam_free) & ~STEPS_BITS) | steps);
}
#else
float free_after(float free, float nearest, float t) {
    return free;
}

float first_entry(vec3 origin, vec3 direction, float entry, bool reflected) {
    return entry;
}

float first_start(float start, bool reflected) {
    return start;
}

int first_step(bool reflected) {
    return 0;
}

float least_bound(float least, float free, float t) {
    return least;
}

void store_beam_step(float free, int step) {}

void store_beam(float free, bool reflected) {}

void begin_beam() {}

float packed_beam() {
    return 0.0;
}
#endif
