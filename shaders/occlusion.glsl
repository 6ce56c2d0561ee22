// Ambient occlusion: how much nearer the scene is than a probe along the normal is high (Quilez 2008; thesis
// section 3.5). Four probes; acts on ambient light only. What hides that light gives its own instead, if it shines.

// Heights of the probes, as shares of how far away things take light (`frame_reach`).
const vec4 PROBE_SHARES = vec4(0.0625, 0.25, 0.5625, 1.0);
const vec4 PROBE_WEIGHTS = vec4(1.0, 0.8, 0.64, 0.512) / (1.0 + 0.8 + 0.64 + 0.512);
vec4 probes;

// Called first.
void load_probes() {
    probes = frame_reach.x * PROBE_SHARES;
}

// Whether the scene, planes apart, can reach a probe: one of height h is unaffected by a distance above h.
bool occluder_near(vec3 p) {
    if (bounds_low.w < 0.5) return false;
    vec3 outside = max(max(bounds_low.xyz - p, p - bounds_high.xyz), 0.0);
    return bounds_high.w < 0.5 || dot(outside, outside) < probes.w * probes.w;
}

// What each probe says is hidden, weighted; `d` are the distances at the probes.
vec4 hidden_by(vec4 d) {
    return PROBE_WEIGHTS * clamp((probes - d) / probes, 0.0, 1.0);
}

// 1 is open, from the scene's distances at the probes.
float openness(vec3 p, vec3 normal, vec4 d) {
    for (int i = 0; i < PLANES; i++) {
        float height = dot(planes[i].xyz, p) + planes[i].w;
        vec4 above = height + probes * dot(planes[i].xyz, normal);
        if (dot(planes[i].xyz, planes[i].xyz) > 0.5) d = min(d, max(above, 0.0));
    }
    return clamp(1.0 - dot(vec4(1.0), hidden_by(d)), 0.0, 1.0);
}

#ifdef GLOW
// What hides most of the sky from a point: how much, the object's number, and where that is.
struct Occluder {
    float share;
    float object;
    vec3 place;
};

// Of the planes; a surface that lies on one does not count.
Occluder nearest_plane(vec3 p, vec3 normal, int own) {
    Occluder nearest = Occluder(0.0, 0.0, p);
    for (int i = 0; i < PLANES; i++) {
        vec3 up = planes[i].xyz;
        float height = dot(up, p) + planes[i].w;
        float share = dot(vec4(1.0), hidden_by(max(height + probes * dot(up, normal), 0.0)));
        if (i != own && dot(up, up) > 0.5 && share > nearest.share) {
            nearest = Occluder(share, plane_objects[i], p - height * up);
        }
    }
    return nearest;
}

// The probe that finds most hidden, and how much all of them find.
int fullest_probe(vec4 hidden) {
    int fullest = 0;
    for (int i = 1; i < 4; i++) fullest = hidden[i] > hidden[fullest] ? i : fullest;
    return fullest;
}
#endif
