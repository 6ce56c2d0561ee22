// Sphere tracing (Hart 1996; Abt 2022, section 2.2) inside the scene's bounds. Planes are solved exactly.

// The CPU uses the same STEPS_MAX, HIT_FRACTION and other constants: crates/field/src/rays.rs.

// Maximum length of the last step, as a multiple of the distance.
const float SLANT_MAX = 4.0;
// A ray that has used up its steps is a hit if the distance is below this multiple of the cone's radius.
const float CAPPED_FRACTION = 8.0;

struct Hit {
    float t;        // along the ray
    int plane;      // number of the plane, or NOTHING
    bool met;       // true if the ray hits a surface
};

// Returns the distances at which the ray passes the near and the far face of the box along each axis.
void pass_faces(vec3 origin, vec3 direction, vec3 low, vec3 high, out vec3 near, out vec3 far) {
    // A component of exactly 0 would make 0 * inf = NaN.
    vec3 inverse = 1.0 / (direction + mix(vec3(-1e-9), vec3(1e-9), greaterThanEqual(direction, vec3(0.0))));
    vec3 a = (low - origin) * inverse;
    vec3 b = (high - origin) * inverse;
    near = min(a, b);
    far = max(a, b);
}

// Returns the distances at which the ray enters and leaves the box; the ray misses the box if entry > exit.
vec2 box_span(vec3 origin, vec3 direction, vec3 low, vec3 high) {
    vec3 near;
    vec3 far;
    pass_faces(origin, direction, low, high, near, far);
    return vec2(max(near.x, max(near.y, near.z)), min(far.x, min(far.y, far.z)));
}

// Returns the part of the ray in the traced scene's bounds, which are enlarged by a margin; empty if entry > exit.
vec2 traced_span(vec3 origin, vec3 direction, float margin) {
    if (bounds_low.w < 0.5) return vec2(1.0, 0.0);
    if (bounds_high.w < 0.5) return vec2(0.0, FAR);
    return box_span(origin, direction, bounds_low.xyz - margin, bounds_high.xyz + margin);
}

// Returns the first plane that the ray hits from its upper side, at least `start` along the ray. With GLASS, `start` is
// the least height of the ray's origin above the plane, because rays that leave glass on a plane may start below it.
Hit trace_planes(vec3 origin, vec3 direction, float start) {
    Hit hit = Hit(1e9, NOTHING, false);
    for (int i = 0; i < PLANES; i++) {
        float approach = -dot(planes[i].xyz, direction);
        float height = dot(planes[i].xyz, origin) + planes[i].w;
#ifdef GLASS
        float t = max(height, 0.0) / max(approach, 1e-9);
        if (approach > 1e-5 && height >= start && t < hit.t) hit = Hit(t, i, true);
#else
        float t = height / max(approach, 1e-9);
        if (approach > 1e-5 && height >= 0.0 && t >= start && t < hit.t) hit = Hit(t, i, true);
#endif
    }
    return hit;
}

// Beams: on llvmpipe, further samples of a pixel do not start at the eye. A beam contains all rays of the pixel: at a
// distance t they are within the beam's radius of the first ray. The first ray finds the free distance of the beam. If
// all surfaces are farther away than twice the radius, the free ball around a step contains the beam and meets the
// previous ball. On llvmpipe, beams and NO_CELLS make compiled scenes without a tree 23 % faster (median), and
// interpreted scenes 2 %. On GPUs a beam would occupy one more register during shading, which costs waves, and beams
// would save less, because fewer pixels are at edges.
#ifdef SOFTWARE
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
#endif

#ifdef NON_LIPSCHITZ
#include "non_lipschitz.glsl"
#else
// Returns the first surface along the ray. The pixel's cone has the radius `cone` at t = 0 and grows by `spread`.
Hit trace(vec3 origin, vec3 direction, float start, float cone, float spread, bool reflected) {
    Hit behind = trace_planes(origin, direction, PLANES_FROM(start, cone));
#ifdef GLASS
    // The surface of glass may be the bounds, and glass that stands on a plane touches it.
    float touching = ray_side < 0.0 ? 0.01 : 0.0;
    vec2 span = traced_span(origin, direction, touching);
    float end = min(span.y, behind.t - touching);
#else
    vec2 span = traced_span(origin, direction, 0.0);
    float end = min(span.y, behind.t);
#endif
#ifdef BEAMS
    // Other rays of the beam may enter the bounds earlier than this one.
    if (!reflected) span.x = traced_span(origin, direction, beam_spread * max(span.x, 0.0)).x;
    start = reflected ? start : ray_start;
    float free = reflected ? -1.0 : 1e-6;
    int first = reflected ? 0 : ray_steps;
#else
    const int first = 0;
#endif
    float t = max(span.x, start);
    if (t >= end) return behind;
#ifndef NO_CELLS
    Walk walk = walk_of(origin, direction);
#endif
    float d = FAR;
    float before = 0.0;     // distance at the previous step; 0 after skipped cells
#ifdef GLASS
    // In glass, the ray also ends at opaque surfaces. Their distance is evaluated only where it is needed: this part of
    // the ray is free of them.
    float free_in_glass = ray_side < 0.0 ? t : FAR;
    met_in_glass = false;
#endif
    for (int i = first; i < STEPS_MAX; i++) {
        if (steps_left(1, trace_rounds(reflected)) <= 0) break;
        float reach = HIT_FRACTION + HIT_FRACTION_GROWTH * float(max(i - STEPS_MANY, 0));
#ifdef NO_CELLS
        Cell cell = NO_CELL;
#else
        Cell cell;
        // Skip cells without a surface, up to the point at which the distance must be evaluated.
        for (int skip = 0; skip < SKIPS_MAX; skip++) {
            vec3 q = place_on(walk, t);
            cell = cell_at(q);
            COUNT(count_lookups);
            float least = reach * (cone + spread * t);
#ifdef BEAMS
            if (free > 0.0) least = max(least, BEAM_BOUND * beam_spread * t);
#endif
            if (!(cell.bound > least)) break;
            before = 0.0;
            t = max(max(t + cell.bound, past(t)), exit_of(cell, walk, q, t));
#ifdef BEAMS
            free = free_after(free, cell.bound, t);
#endif
            if (t >= end) break;
        }
        if (t >= end) break;
#endif
#ifdef GLASS
        met_in_glass = ray_side < 0.0 && t >= free_in_glass;
        vec2 nearest = scene_distance(cell, origin + t * direction, met_in_glass ? WITHOUT_GLASS : 0.0);
        if (!met_in_glass) nearest *= ray_side;
#else
        vec2 nearest = scene_distance(cell, origin + t * direction, 0.0);
#endif
        d = nearest.y;
#ifdef COUNT_EVALUATIONS
        if (reflected) { COUNT(count_reflection); } else { COUNT(count_primary); }
        if (i == STEPS_MAX - 1) COUNT(count_capped);
#endif
        // Not d < reach, so that NaN also ends the ray.
        float radius = reach * (cone + spread * t);
        if (!(d >= radius)) break;
        // Where a bound is small, another cell of a repetition begins, but there need be no surface.
        float stride = min(d, max(nearest.x, radius));
        // Tried: longer steps that the last two distances predict, undone where the empty spheres do not meet (Keinert
        // et al. 2014). Seven scenes need 2 to 10 % fewer evaluations; lattice, whose bound is not smooth, needs 2 %
        // more.
#ifdef GLASS
        if (met_in_glass) {
            free_in_glass = t + stride;
            continue;
        }
        if (ray_side < 0.0 && t + stride > free_in_glass) {
            t = free_in_glass;
            before = 0.0;
            continue;
        }
#endif
        t += stride;
#ifdef BEAMS
        free = free_after(free, min(d, nearest.x), t);
        if (free > 0.0) beam_steps = i + 1;
#endif
        before = stride < d ? 0.0 : d;
        if (t >= end) break;
    }
#ifdef BEAMS
    if (!reflected) beam_free = abs(free);
#endif
    // A ray that used up its steps far from any surface has missed. (A single exit of the loop needs fewer
    // registers.)
    if (t >= end || d > CAPPED_FRACTION * (cone + spread * t)) return behind;
    // The last step ends on the surface, so that the hit hardly depends on earlier steps. It is longer than the
    // distance if the last two distances show that the ray meets the surface at an angle.
#ifdef GLASS
    if (met_in_glass) before = 0.0;
#endif
    float slant = before > d ? min(before / (before - d), SLANT_MAX) : 1.0;
    // NaN ends the ray at its last point.
    return Hit(d > 0.0 ? t + d * slant : t, NOTHING, true);
}
#endif
