// Sharp shadows in the variant NON_LIPSCHITZ: there is no penumbra, because a value that is not a distance does not
// show how closely a ray passes a surface. When the penumbra of shadow.glsl and the gradient's bounds were in one loop,
// clockwork took 116 registers and terrain 128 on Vega (ACO), which left two waves. Now both take 84 registers, which
// leaves three waves.

const int SHADOW_STEPS_MAX = 512;
// Growth of the shortest step with each step, so that rays that graze a surface end.
const float SHADOW_STEP_GROWTH = 0.002;

// Returns the fraction of a light that is visible along the ray: 0 or 1. When `probing`, returns the openness of
// the origin.
float light_visibility(LightRay ray, bool probing) {
    if (!probing && trace_planes(ray.origin, ray.direction, 0.0).t < ray.t) return 0.0;
    vec2 span = probing ? vec2(probes.x, FAR) : non_lipschitz_span(ray.origin, ray.direction);
    float end = min(span.y, ray.t);
    float t = max(span.x, probing ? 0.0 : SHADOW_START);
    bool is_near = !probing || occluder_near(ray.origin);
    float open = 1.0;
    if (t >= end) return 1.0;
#ifdef TRANSLUCENT
    // The fraction that a body leaves, which the ray crosses in equal steps.
    float passed = 1.0;
    const float EVEN_STEP = 0.05;
#endif
    Walk walk = walk_of(ray.origin, ray.direction);
    for (int i = 0; i < SHADOW_STEPS_MAX; i++) {
        int left = steps_left(SHADOW_STEPS_MAX - i, SHADOW_ROUNDS);
        if (!probing && left <= 0) break;
        bool is_free = !is_near;
        Cell cell;
        vec3 q;
        for (int skip = 0; skip < SKIPS_MAX; skip++) {
            q = place_on(walk, t);
            cell = cell_at(q);
            COUNT(count_lookups);
            if (probing) {
                is_free = is_free || AS_DISTANCE(cell.bound) >= t;
                break;
            }
            if (!(cell.bound > 0.0)) break;
            t = max(past(t), exit_of(cell, walk, q, t));
            if (t >= end) break;
        }
        if (t >= end) break;
        float penumbra = probing ? SURFACE_PENUMBRA : PENUMBRA(t, ray.sharpness);
        vec2 values = vec2(0.0);
        if (!is_free) values = scene_distance(cell, ray.origin + t * ray.direction, penumbra);
        if (probing) {
            if (!is_free) COUNT(count_occlusion);
            open -= blocked_at(i, t, ray.origin, ray.direction, is_free ? t : AS_DISTANCE(values.y));
            if (i == PROBES - 1) return clamp(open, 0.0, 1.0);
            t = probe_height(i + 1);
            continue;
        }
        COUNT(count_shadow);
#ifdef COUNT_EVALUATIONS
        if (i == SHADOW_STEPS_MAX - 1) COUNT(count_capped);
#endif
#ifdef TRANSLUCENT
        if (shadow_dims > 0.0 && values.y <= 0.0) {
            passed *= exp(-shadow_dims * EVEN_STEP);
            t += EVEN_STEP;
            if (passed < 0.004) return 0.0;
            if (t >= end) break;
            continue;
        }
#endif
        // Treat NaN as inside.
        if (!(values.y > 0.0)) return 0.0;
        float towards = slope_towards(unpack_slopes(cell.slopes), ray.direction);
        float stride = towards > 0.0 ? values.x / towards : FAR;
        if (cell.side > 0.0) stride = min(stride, max(past(t), exit_of(cell, walk, place_on(walk, t), t)) - t);
        stride = max(stride, SHADOW_STEP_MIN + SHADOW_GROWTH * float(i));
#ifdef LIMITED_ROUNDS
        stride = max(stride, left > SHADOW_STEPS_MAX / 2 ? 0.0 : even_step(left, t, end));
#endif
        t += stride;
        if (t >= end) break;
    }
#ifdef TRANSLUCENT
    return passed;
#else
    return 1.0;
#endif
}
