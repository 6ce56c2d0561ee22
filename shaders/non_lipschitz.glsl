// Replaces `trace` of sphere_tracing.glsl for formulas that are not distances (variant NON_LIPSCHITZ). Each cell
// (regions.glsl) has bounds of the gradient (region/gradient.rs): a step cannot pass a surface if its length is the
// value divided by the rate at which the value can fall along the ray. Steps end at the cell's face.

struct Slopes {
    vec3 low;
    vec3 high;
};

// Unpacks the words .z and .w of a cell: integers in units of scale / 128.
Slopes unpack_slopes(uvec2 words) {
    ivec2 signed_words = ivec2(words);
    float unit = uintBitsToFloat(words.y & 0xFFFF0000u) / 128.0;
    vec3 low = vec3((signed_words.x << 24) >> 24, (signed_words.x << 16) >> 24, (signed_words.x << 8) >> 24);
    vec3 high = vec3(signed_words.x >> 24, (signed_words.y << 24) >> 24, (signed_words.y << 16) >> 24);
    return Slopes(low * unit, high * unit);
}

// Returns the largest rate at which the value can fall along a direction.
float slope_towards(Slopes slopes, vec3 direction) {
    vec3 falls = max(-slopes.low * direction, -slopes.high * direction);
    return falls.x + falls.y + falls.z;
}

// Returns the part of the ray in cells that may contain a surface.
vec2 non_lipschitz_span(vec3 origin, vec3 direction) {
    vec2 span = traced_span(origin, direction, 0.0);
    vec3 half_side = 0.5 * ROOT_SIDE / region_scale.xyz;
    vec2 tree = box_span(origin, direction, region_middle.xyz - half_side, region_middle.xyz + half_side);
    return vec2(max(span.x, tree.x), min(span.y, tree.y));
}

// Returns the length of the step at t if a ray reaches `end` in `left` steps that grow with the distance.
float even_step(int left, float t, float end) {
    float from = max(t, NON_LIPSCHITZ_NEAR);
    return from * (pow(end / from, 1.0 / float(left)) - 1.0);
}

// Returns the first surface along the ray, where the value changes its sign. The pixel's cone has the radius `cone` at
// t = 0 and grows by `spread`.
Hit trace(vec3 origin, vec3 direction, float start, float cone, float spread, bool reflected) {
    Hit behind = trace_planes(origin, direction, PLANES_FROM(start, cone));
    vec2 span = non_lipschitz_span(origin, direction);
    float end = min(span.y, behind.t);
    float t = max(past(span.x), start);
    if (t >= end) return behind;
    Walk walk = walk_of(origin, direction);
    // The last point outside with its value (0 if it was not evaluated), and the first point inside.
    float outside = t;
    float above = 0.0;
    float inside = -1.0;
    float below = 0.0;
    int closings = 0;
    for (int i = 0; i < NON_LIPSCHITZ_STEPS_MAX; i++) {
        int left = steps_left(NON_LIPSCHITZ_STEPS_MAX - i, trace_rounds(reflected));
        if (left <= 0) break;
        Cell cell;
        vec3 q;
        for (int skip = 0; skip < SKIPS_MAX; skip++) {
            q = place_on(walk, t);
            cell = cell_at(q);
            COUNT(count_lookups);
            if (!(cell.bound > 0.0) || inside >= 0.0) break;
            outside = t;
            above = 0.0;
            t = max(past(t), exit_of(cell, walk, q, t));
            if (t >= end) break;
        }
        if (t >= end) return behind;
        float value = scene_distance(cell, origin + t * direction, 0.0).x;
#ifdef GLASS
        value *= ray_side;
#endif
#ifdef COUNT_EVALUATIONS
        if (reflected) { COUNT(count_reflection); } else { COUNT(count_primary); }
        if (i == NON_LIPSCHITZ_STEPS_MAX - 1) COUNT(count_capped);
#endif
        float radius = cone + spread * max(t, NON_LIPSCHITZ_NEAR);
        // Treat NaN as inside.
        if (value > 0.0) {
            outside = t;
            above = value;
        } else {
            inside = t;
            below = value;
        }
        if (inside >= 0.0) {
            bool close = inside - outside < CLOSE_ENOUGH * radius;
            if (!(above > 0.0) || close || closings == CLOSINGS_MAX) return Hit(inside, NOTHING, true);
            closings++;
            // Use the secant's zero, but keep away from both ends, so that both ends move inwards.
            t = mix(outside, inside, clamp(above / (above - below), 0.1, 0.9));
        } else {
            // Compute the step in the same way as `non_lipschitz_step` in crates/field/src/rays.rs.
#ifdef GLASS
            float slope = slope_towards(unpack_slopes(cell.slopes), ray_side * direction);
#else
            float slope = slope_towards(unpack_slopes(cell.slopes), direction);
#endif
            float safe = slope > 0.0 ? value / slope : FAR;
            float leaves = max(past(t), exit_of(cell, walk, q, t)) - t;
            float least = (NON_LIPSCHITZ_STEP_MIN + NON_LIPSCHITZ_STEP_GROWTH * float(i)) * radius;
            if (left <= NON_LIPSCHITZ_STEPS_MAX - NON_LIPSCHITZ_STEPS_MANY) least = max(least, even_step(left, t, end));
            // If rounding puts a point outside the tree, there is no cell to leave.
            t += cell.side > 0.0 ? max(min(safe, leaves), least) : past(least);
        }
    }
    // The ray used up its steps between the last point outside and a point inside.
    if (inside >= 0.0) return Hit(inside, NOTHING, true);
    return behind;
}
