// How much light arrives: soft shadows and ambient occlusion.

const vec3 LAMP_POSITION = vec3(-9.0, 12.5, -2.5);
const vec3 LAMP_COLOR = vec3(1.0, 0.90, 0.74) * 1500.0;

const int SHADOW_STEPS_MAX = 96;
// Longest step near the scene: longer ones draw the steps into the penumbra.
const float SHADOW_STEP_MAX = 0.6;
const float SHADOW_STEP_MIN = 0.03;
// Sharpness of the penumbra: distance over this is the radius of the lamp.
const float SHADOW_SHARPNESS = 16.0;
// Shadow rays also feel what they pass at this distance outside the scene's bounds.
const float SHADOW_MARGIN = 0.7;

// Share of the lamp that is seen from p, 0..1: Quilez, "soft shadows in raymarched SDFs" (2010), with the closest
// pass between two steps estimated by triangulation (Aaltonen 2018; thesis section 3.4, Abb. 11).
float lamp_visibility(vec3 p, vec3 normal, float cone) {
    vec3 origin = p + normal * max(0.012, 2.0 * cone);
    vec3 to_lamp = LAMP_POSITION - origin;
    float lamp_t = length(to_lamp);
    vec3 direction = to_lamp / lamp_t;
    vec2 span = box_span(origin, direction, BOUNDS_MIN - SHADOW_MARGIN, BOUNDS_MAX + SHADOW_MARGIN);
    float end = min(span.y, lamp_t);
    float t = max(span.x, 0.02);
    float visible = 1.0;
    float previous = 1e4;
    float stride = 1e4;
    for (int i = 0; i < SHADOW_STEPS_MAX; i++) {
        if (t >= end) break;
        Nearest nearest = scene_nearest(origin + t * direction, t / SHADOW_SHARPNESS);
        float d = nearest.estimate;
        COUNT(shadow);
#ifdef COUNT_EVALUATIONS
        if (i == SHADOW_STEPS_MAX - 1) COUNT(capped);
#endif
        if (d < 0.002) return 0.0;
        // Where the unbounded spheres of the last two points meet: so far behind this point, so far off the ray.
        // A stride longer than its sphere, taken next to a surface, leaves nothing to triangulate.
        float behind = (d * d + stride * stride - previous * previous) / (2.0 * stride);
        behind = stride > previous ? 0.0 : clamp(behind, 0.0, min(d, stride));
        float closest = sqrt(max(d * d - behind * behind, 0.0));
        visible = min(visible, SHADOW_SHARPNESS * closest / max(t - behind, 1e-3));
        if (visible < 0.004) return 0.0;
        previous = d;
        stride = clamp(nearest.bound, SHADOW_STEP_MIN, SHADOW_STEP_MAX);
        t += stride;
    }
    return visible * visible * (3.0 - 2.0 * visible);
}

const int OCCLUSION_TAPS = 5;
const float OCCLUSION_REACH = 1.1;

// Ambient occlusion: how much nearer the scene is than a probe along the normal is high (Quilez 2008; thesis
// section 3.5), 1 is open. Acts on ambient light only.
float ambient_occlusion(vec3 p, vec3 normal) {
    // A probe of height h is unaffected by a distance above h: nothing to do far from the scene's bounds.
    vec3 outside = max(max(BOUNDS_MIN - p, p - BOUNDS_MAX), 0.0);
    float floor_reach = 2.0 * OCCLUSION_REACH;
    bool scene_near = dot(outside, outside) < OCCLUSION_REACH * OCCLUSION_REACH;
    if (!scene_near && p.y > floor_reach) return 1.0;
    float sum = 0.0;
    float weight = 1.0;
    float total = 0.0;
    for (int i = 1; i <= OCCLUSION_TAPS; i++) {
        float share = float(i) / float(OCCLUSION_TAPS);
        float height = OCCLUSION_REACH * share * share;
        vec3 probe = p + normal * height;
        float d = probe.y - FLOOR_HEIGHT;
        if (scene_near) {
            d = min(d, scene_nearest(probe, 0.0).estimate);
            COUNT(occlusion);
        }
        sum += weight * clamp((height - d) / height, 0.0, 1.0);
        total += weight;
        weight *= 0.8;
    }
    float open = 1.0 - sum / total;
    return clamp(open, 0.0, 1.0);
}
