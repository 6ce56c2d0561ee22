// Ambient occlusion from four probes along the normal, which shadow.glsl runs as a ray. It compares the distance at each
// probe with the probe's height (Quilez 2008; Abt 2022, section 3.5), and affects only ambient light. Nearby shining
// objects add glow instead.

// PROBE_FRACTIONS and PROBE_WEIGHTS are in crates/field/src/rays.rs.
#define probes (frame_reach.x * PROBE_FRACTIONS)
const int PROBES = 4;
// The openness of a point before its probes have run.
const float UNKNOWN_OPEN = -1.0;

// Returns the height of a probe.
float probe_height(int probe) {
    return dot(probes, vec4(equal(ivec4(0, 1, 2, 3), ivec4(probe))));
}

// True if surfaces other than planes can affect a probe. A probe at height h is affected only by distances below h.
bool occluder_near(vec3 p) {
    if (bounds_low.w < 0.5) return false;
    vec3 outside = max(max(bounds_low.xyz - p, p - bounds_high.xyz), 0.0);
    return bounds_high.w < 0.5 || dot(outside, outside) < probes.w * probes.w;
}

// Returns the part of the ambient light at p that a probe at the height t finds blocked. The scene's distance there is d.
float blocked_at(int probe, float t, vec3 p, vec3 normal, float d) {
    for (int i = 0; i < PLANES; i++) {
        float above = dot(planes[i].xyz, p + t * normal) + planes[i].w;
        if (dot(planes[i].xyz, planes[i].xyz) > 0.5) d = min(d, max(above, 0.0));
    }
    vec4 weights = PROBE_WEIGHTS / dot(PROBE_WEIGHTS, vec4(1.0));
    return dot(weights, vec4(equal(ivec4(0, 1, 2, 3), ivec4(probe)))) * clamp((t - d) / t, 0.0, 1.0);
}

// Position of the probe for glow, as a fraction of the reach along the normal. At that position, objects in front of
// the surface are nearer and objects behind the surface are farther away.
const float GLOW_PROBE = 0.25;

// Returns the received light, computed from the emission and the distance at the probe. It is the whole emission on
// contact, and 0 beyond the reach.
vec3 glow_from(vec4 found) {
    float near = clamp(1.0 - max(AS_DISTANCE(found.a), 0.0) / frame_reach.x, 0.0, 1.0);
    return light_of(found.rgb) * (near * near * near);
}
