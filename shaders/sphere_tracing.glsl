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

#include "beams.glsl"

#ifdef NON_LIPSCHITZ
#include "non_lipschitz.glsl"
#else
// Returns the first surface along the ray. The pixel's cone has the radius `cone` at t = 0 and grows by `spread`.
Hit trace(vec3 origin, vec3 direction, float start, float cone, float spread, bool reflected) {
    Hit behind = trace_planes(origin, direction, PLANES_FROM(start, cone));
    // The surface of glass may be the bounds, and glass that stands on a plane touches it.
    float touching = ray_side < 0.0 ? 0.01 : 0.0;
    vec2 span = traced_span(origin, direction, touching);
    float end = min(span.y, behind.t - touching);
    float free = reflected ? -1.0 : 1e-6;
    float t = max(first_entry(origin, direction, span.x, reflected), first_start(start, reflected));
    if (t >= end) return behind;
#ifndef NO_CELLS
    Walk walk = walk_of(origin, direction);
#endif
    float d = FAR;
    float before = 0.0;     // distance at the previous step; 0 after skipped cells
    begin_in_glass(t);
    for (int i = first_step(reflected); i < STEPS_MAX; i++) {
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
            if (!(cell.bound > least_bound(reach * (cone + spread * t), free, t))) break;
            before = 0.0;
            t = max(max(t + cell.bound, past(t)), exit_of(cell, walk, q, t));
            free = free_after(free, cell.bound, t);
            if (t >= end) break;
        }
        if (t >= end) break;
#endif
        look_in_glass(t);
        vec2 nearest = scene_distance(cell, origin + t * direction, met_in_glass ? WITHOUT_GLASS : 0.0);
        if (!met_in_glass) nearest *= ray_side;
        d = nearest.y;
        if (reflected) { COUNT(count_reflection); } else { COUNT(count_primary); }
        if (i == STEPS_MAX - 1) { COUNT(count_capped); }
        // Not d < reach, so that NaN also ends the ray.
        float radius = reach * (cone + spread * t);
        if (!(d >= radius)) break;
        // Where a bound is small, another cell of a repetition begins, but there need be no surface.
        float stride = min(d, max(nearest.x, radius));
        // Tried: longer steps that the last two distances predict, undone where the empty spheres do not meet (Keinert
        // et al. 2014). Seven scenes need 2 to 10 % fewer evaluations; lattice, whose bound is not smooth, needs 2 %
        // more.
        if (looks_again_in_glass(t, stride, before)) continue;
        t += stride;
        free = free_after(free, min(d, nearest.x), t);
        store_beam_step(free, i);
        before = stride < d ? 0.0 : d;
        if (t >= end) break;
    }
    store_beam(free, reflected);
    // A ray that used up its steps far from any surface has missed. (A single exit of the loop needs fewer
    // registers.)
    if (t >= end || d > CAPPED_FRACTION * (cone + spread * t)) return behind;
    // The last step ends on the surface, so that the hit hardly depends on earlier steps. It is longer than the
    // distance if the last two distances show that the ray meets the surface at an angle.
    if (met_in_glass) before = 0.0;
    float slant = before > d ? min(before / (before - d), SLANT_MAX) : 1.0;
    // NaN ends the ray at its last point.
    return Hit(d > 0.0 ? t + d * slant : t, NOTHING, true);
}
#endif
