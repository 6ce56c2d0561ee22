// Sphere tracing (Hart 1996, thesis section 2.2) inside the scene's bounds. The floor is solved exactly.

#include "counters.glsl"

const int STEPS_MAX = 128;
// Share of a pixel's cone that counts as the surface, and its growth per step: a ray that creeps along a surface
// ends there.
const float HIT_SHARE = 0.7;
const float HIT_SHARE_GROWTH = 0.015;

struct Hit {
    float t;        // along the ray
    int object;     // SKY, FLOOR, SPEAKER or BAR
};

// Entry and exit of the ray into the box; empty where entry > exit.
vec2 box_span(vec3 origin, vec3 direction, vec3 low, vec3 high) {
    // A component of exactly 0 would make 0 * inf = NaN.
    vec3 inverse = 1.0 / (direction + mix(vec3(-1e-9), vec3(1e-9), greaterThanEqual(direction, vec3(0.0))));
    vec3 a = (low - origin) * inverse;
    vec3 b = (high - origin) * inverse;
    vec3 near = min(a, b);
    vec3 far = max(a, b);
    return vec2(max(near.x, max(near.y, near.z)), min(far.x, min(far.y, far.z)));
}

// Distance along the ray to the floor, or a large number.
float floor_span(vec3 origin, vec3 direction) {
    if (direction.y > -1e-5) return 1e9;
    return (FLOOR_HEIGHT - origin.y) / direction.y;
}

// First surface along the ray. `cone` is the radius of the pixel's cone at t = 0 and `spread` its growth.
Hit trace(vec3 origin, vec3 direction, float start, float cone, float spread, bool reflected) {
    float floor_t = floor_span(origin, direction);
    Hit miss = Hit(floor_t, floor_t < 1e8 ? FLOOR : SKY);
    vec2 span = box_span(origin, direction, BOUNDS_MIN, BOUNDS_MAX);
    float end = min(span.y, floor_t);
    float t = max(span.x, start);
    if (t >= end) return miss;
    int object = SKY;
    for (int i = 0; i < STEPS_MAX; i++) {
        Nearest nearest = scene_nearest(origin + t * direction, 0.0);
        float d = nearest.bound;
        object = nearest.object;
#ifdef COUNT_EVALUATIONS
        if (reflected) { COUNT(reflection); } else { COUNT(primary); }
        if (i == STEPS_MAX - 1) COUNT(capped);
#endif
        float reach = HIT_SHARE + HIT_SHARE_GROWTH * float(i);
        if (d < reach * (cone + spread * t)) return Hit(t, object);
        t += d;
        if (t >= end) return miss;
    }
    return Hit(t, object);
}

// Normal by central differences on a tetrahedron, four taps; the step follows the pixel's cone (thesis 3.1).
vec3 surface_normal(vec3 p, float cone) {
    float h = max(0.6 * cone, 4e-4);
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 4; i++) {
        vec3 e = 2.0 * vec3(float(((i + 3) >> 1) & 1), float((i >> 1) & 1), float(i & 1)) - 1.0;
        sum += e * scene_nearest(p + h * e, 0.0).estimate;
    }
    COUNT_N(normal, 4);
    float size = length(sum);
    return size > 1e-12 ? sum / size : vec3(0.0, 1.0, 0.0);
}
