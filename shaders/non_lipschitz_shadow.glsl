// Sharp shadows in the variant NON_LIPSCHITZ: there is no penumbra, because a value that is not a distance does not
// show how closely a ray passes a surface. When the penumbra of shadow.glsl and the gradient's bounds were in one loop,
// clockwork took 116 registers and terrain 128 on Vega (ACO), which left two waves. Now both take 84 registers, which
// leaves three waves.

const int SHADOW_STEPS_MAX = 512;
// Growth of the shortest step with each step, so that rays that graze a surface end.
const float SHADOW_STEP_GROWTH = 0.002;

// Returns the fraction of a light that is visible from p: 0 or 1.
float light_visibility(vec3 p, vec3 normal, vec3 to_light, float light_t, float sharpness, float cone) {
    vec3 origin = shadow_origin(p, normal, cone);
    if (trace_planes(origin, to_light, 0.0).t < light_t) return 0.0;
    vec2 span = non_lipschitz_span(origin, to_light);
    float end = min(span.y, light_t);
    float t = max(span.x, SHADOW_START);
    if (t >= end) return 1.0;
#ifdef TRANSLUCENT
    // The fraction that a body leaves, which the ray crosses in equal steps.
    float passed = 1.0;
    const float EVEN_STEP = 0.05;
#endif
    Walk walk = walk_of(origin, to_light);
    for (int i = 0; i < SHADOW_STEPS_MAX; i++) {
        int left = steps_left(SHADOW_STEPS_MAX - i, SHADOW_ROUNDS);
        if (left <= 0) break;
        Cell cell;
        vec3 q;
        for (int skip = 0; skip < SKIPS_MAX; skip++) {
            q = place_on(walk, t);
            cell = cell_at(q);
            COUNT(count_lookups);
            if (!(cell.bound > 0.0)) break;
            t = max(past(t), exit_of(cell, walk, q, t));
            if (t >= end) break;
        }
        if (t >= end) break;
        vec2 values = scene_distance(cell, origin + t * to_light, PENUMBRA(t, sharpness));
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
        float towards = slope_towards(unpack_slopes(cell.slopes), to_light);
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
