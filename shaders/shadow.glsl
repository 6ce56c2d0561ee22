// Shadows: the fraction of a light that arrives at a point. Most constants are in crates/field/src/rays.rs.

// A ray to a light, or along the normal for the probes of occlusion.
struct LightRay {
    vec3 origin;
    vec3 direction;
    float t;            // distance of the light
    float sharpness;    // of the penumbra
};

vec3 shadow_origin(vec3 p, vec3 normal, float cone) {
    return p + normal * max(0.012, 2.0 * cone);
}

#ifdef PATHS
// Shadows of paths are sharp. Objects of glass and objects with a bound still get the least penumbra of the raster, because
// that lets light pass (crates/field/src/world/planes.rs); it is 0 for a ray that glass stops.
float penumbra_growth = 1.0 / SHARPNESS_MAX;
#define PENUMBRA(t, sharpness) ((t) * penumbra_growth)
#else
#define PENUMBRA(t, sharpness) ((t) / (sharpness))
#endif

#ifdef TRANSLUCENT
// Fraction of light per unit of length that a translucent body removes from rays that start at it; 0 if it is opaque.
float shadow_dims = 0.0;
#endif

#ifdef BLEND
#define SHADOW_GROWTH (SHADOW_STEP_GROWTH + shadow_step_growth)
#else
#define SHADOW_GROWTH SHADOW_STEP_GROWTH
#endif

#ifdef NON_LIPSCHITZ
#include "non_lipschitz_shadow.glsl"
#else
const int SHADOW_STEPS_MAX = 96;
const float SHADOW_STEP_GROWTH = 0.0;

// Returns the part of the ray in which surfaces may dim the light, because the bounds are within the penumbra's radius,
// t / sharpness.
vec2 shadow_span(vec3 origin, vec3 direction, float sharpness) {
    if (bounds_low.w < 0.5) return vec2(1.0, 0.0);
    if (bounds_high.w < 0.5) return vec2(0.0, FAR);
    vec3 near;
    vec3 far;
    pass_faces(origin, direction, bounds_low.xyz, bounds_high.xyz, near, far);
    // At t, the point is (t - far) * abs(direction) outside of a far face.
    vec3 k = sharpness * abs(direction);
    near *= k / (k + 1.0);
    far = mix(vec3(FAR), far * k / (k - 1.0), greaterThan(k, vec3(1.0)));
    return vec2(max(near.x, max(near.y, near.z)), min(far.x, min(far.y, far.z)));
}

// Returns the fraction of a light that is visible along the ray: Quilez, "soft shadows in raymarched SDFs" (2010), with the
// closest pass between two steps estimated by triangulation (Aaltonen 2018; Abt 2022, section 3.4, figure 11). When
// `probing` for occlusion, returns the openness of the ray's origin.
float light_visibility(LightRay ray, bool probing) {
    if (!probing && trace_planes(ray.origin, ray.direction, 0.0).t < ray.t) return 0.0;
    vec2 span = probing ? vec2(probes.x, FAR) : shadow_span(ray.origin, ray.direction, ray.sharpness);
    float end = min(span.y, ray.t);
    float t = max(span.x, probing ? 0.0 : SHADOW_START);
    bool is_near = !probing || occluder_near(ray.origin);
    float visible = 1.0;
    float previous = 1e4;
    float stride = 1e4;
#ifdef TRANSLUCENT
    // The fraction that the body leaves, and the last step in it.
    float passed = 1.0;
    float step_inside = 0.0;
#endif
    if (t >= end) return 1.0;
#ifndef NO_CELLS
    Walk walk = walk_of(ray.origin, ray.direction);
#endif
    for (int i = 0; i < SHADOW_STEPS_MAX; i++) {
        if (!probing && steps_left(1, SHADOW_ROUNDS) <= 0) break;
        bool is_free = !is_near;
#ifdef NO_CELLS
        Cell cell = NO_CELL;
#else
        Cell cell;
        // Skip cells whose surfaces are too far away to reduce the light further.
        for (int skip = 0; skip < SKIPS_MAX; skip++) {
            vec3 q = place_on(walk, t);
            cell = cell_at(q);
            COUNT(count_lookups);
            float leaves = max(past(t), exit_of(cell, walk, q, t));
            if (probing) {
                is_free = is_free || AS_DISTANCE(cell.bound) >= t;
                break;
            }
            if (!(cell.bound > 0.0 && ray.sharpness * cell.bound >= visible * leaves)) break;
            t = leaves;
            // After a skip there is no last sphere for the triangulation.
            stride = 1e4;
            previous = 1e4;
            if (t >= end) break;
        }
        if (t >= end) break;
#endif
        float penumbra = probing ? SURFACE_PENUMBRA : PENUMBRA(t, ray.sharpness);
        vec2 nearest = vec2(t);
        if (!is_free) nearest = scene_distance(cell, ray.origin + t * ray.direction, penumbra);
        float d = nearest.y;
        if (probing) {
            if (!is_free) COUNT(count_occlusion);
            visible -= blocked_at(i, t, ray.origin, ray.direction, AS_DISTANCE(d));
            if (i == PROBES - 1) return clamp(visible, 0.0, 1.0);
            t = probe_height(i + 1);
            continue;
        }
        COUNT(count_shadow);
#ifdef COUNT_EVALUATIONS
        if (i == SHADOW_STEPS_MAX - 1) COUNT(count_capped);
#endif
#ifdef TRANSLUCENT
        if (shadow_dims > 0.0) {
            // A body that lets light through has no penumbra.
            bool is_inside = d < 0.002;
            float part = max(abs(d), SHADOW_STEP_MIN * (1.0 + 0.1 * float(i)));
            // The part of the last step that was outside of the body after all, or inside.
            float crossed = is_inside ? part + (step_inside > 0.0 ? 0.0 : min(-d, stride)) : -min(d, step_inside);
            passed *= exp(-shadow_dims * crossed);
            step_inside = is_inside ? part : 0.0;
            stride = part;
            t += part;
            if (passed < 0.004 || t >= end) break;
            continue;
        }
#endif
        // Spheres around the last two points contain no surface. They meet in a circle around the ray: its radius is
        // `closest`, its centre is `behind` before this point. `behind` is 0 after a stride beyond the last sphere.
        float behind = (d * d + stride * stride - previous * previous) / (2.0 * stride);
        behind = stride > previous ? 0.0 : clamp(behind, 0.0, min(d, stride));
        float closest = sqrt(max(d * d - behind * behind, 0.0));
        visible = min(visible, ray.sharpness * closest / max(t - behind, 1e-3));
        // The condition is not d < 0.002, so that NaN also ends the ray.
        if (!(d >= 0.002) || visible < 0.004) {
            visible = 0.0;
            break;
        }
        previous = d;
        // The ball around the point is free of surfaces. Up to `unseen`, it is also wider than the part of the penumbra that
        // would reduce the light further.
        float narrow = visible / ray.sharpness;
        float unseen = (nearest.x - narrow * t) / (1.0 + narrow);
        float longest = max(SHADOW_STEP_MAX, max(0.5 * nearest.x, unseen));
        stride = max(min(nearest.x, longest), SHADOW_STEP_MIN + SHADOW_GROWTH * float(i));
        t += stride;
        if (t >= end) break;
    }
    visible *= visible * (3.0 - 2.0 * visible);
#ifdef TRANSLUCENT
    visible *= passed;
#endif
    return visible;
}
#endif
