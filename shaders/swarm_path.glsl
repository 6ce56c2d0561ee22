// What a path meets of swarms before the end of its ray.

#if defined(SWARM) && !defined(VIEWS)
#define DRAWS_SWARM
#include "swarm.glsl"
#endif
#include "shade.glsl"

#ifdef DRAWS_SWARM
struct SwarmMet {
    SwarmSeen seen;
    ThinBalls thin;
    bool is_ball;
    bool is_thin;       // true if thin balls need light
    float ball_left;    // fraction of the ball's light that media leave, as a multiple of that for the whole ray
};

// A pixel is marked if thin balls and glow change its light by more than this part. The limit is lower on rough mirrors:
// there edges.frag takes a low contrast for noise.
const float FAINT_PART = 0.3;
const float ROUGH_FAINT_PART = 0.08;
// The light of faint points of swarms that changes from pixel to pixel, and what these points leave of other light.
float seen_sharp = 0.0;
float seen_left = 1.0;

#ifdef SWARM_TILES
int swarm_tiles = SWARM_TILES_OF_EYE;
#define FORGET_SWARM_TILES swarm_tiles = 0;

// The plane mirrors the whole picture, but a rough mirror or a ray close to the plane changes the direction.
void mirror_swarm_tiles(EyePath path, Surface s, Hit hit) {
    bool is_flat = path.surface == 0 && dot(path.direction, s.normal) < -0.02;
    swarm_tiles = is_flat ? swarm_tiles_of(hit.plane) : 0;
}
#else
const int swarm_tiles = 0;
#endif

// Adds the light of the swarms before the end of the ray. A ball becomes the end.
SwarmMet meet_swarm(inout EyePath path, inout Hit hit, float fraction_min) {
    float end = hit.met ? hit.t : FAR;
    SwarmMet met;
    met.seen = swarm_along(path.origin, path.direction, end, path.travelled, swarm_tiles);
    met.is_ball = met.seen.ball > 0;
    met.thin = ThinBalls(met.seen.thin_color, path.throughput * (1.0 - met.seen.left), 0.0);
    met.ball_left = 1.0;
    float light_left = 1.0;
#ifdef DRAWS_MEDIA
    // The medium counts as uniform. All light is multiplied in the end by what the medium leaves on the whole ray.
    if (path.surface == 0 && !is_medium_pass()) {
        path_medium.left = max(path_medium.left, MEDIUM_LEFT_MIN);
        vec3 places = min(vec3(met.seen.light_t, met.seen.t, met.seen.thin_t) / min(end, MEDIUM_FAR), 1.0);
        vec3 left = pow(vec3(path_medium.left), places - 1.0);
        light_left = left.x;
        if (met.is_ball) met.ball_left = left.y;
        // Balls hide the light of the medium behind them.
        float hidden = met.seen.left * (met.ball_left - 1.0);
        if (met.thin.color != vec3(0.0)) {
            hidden += (1.0 - met.seen.left) * (left.z - 1.0);
            met.thin.fraction *= left.z;
        }
        path.color -= path.throughput * path_medium.light * (hidden / max(1.0 - path_medium.left, 1e-4));
    }
#endif
#ifdef COVERAGE
    path.color = vec3(1.0 - met.seen.left);
    met.thin.color = vec3(0.0);
#else
    path.color += path.throughput * light_left * met.seen.light;
    if (path.blurred == 0.0) {
        seen_sharp += most_of(path.throughput) * light_left * met.seen.sharp;
        seen_left = min(seen_left, met.seen.left);
    }
#endif
    if (most_of(met.thin.fraction) < fraction_min) met.thin.color = vec3(0.0);
    path.throughput *= met.seen.left;
    if (met.is_ball) hit = Hit(met.seen.t, NOTHING, true);
    met.is_thin = met.thin.color != vec3(0.0);
    met.thin.before = hit.met ? hit.t - met.seen.thin_t : 0.0;
    return met;
}

// True if there is a surface to shade: behind thin balls may be the sky.
bool is_shaded(Hit hit, SwarmMet met) {
    return hit.met || met.is_thin;
}

float shaded_distance(Hit hit, SwarmMet met) {
    return hit.met ? hit.t : met.seen.thin_t;
}

// Adds the light of a surface and of the thin balls before it. `fraction` of the surface's light reaches the eye.
void add_light(inout EyePath path, Surface s, vec3 p, SwarmMet met, vec3 fraction, bool is_lit) {
    if (!is_lit && !met.is_thin) return;
    path.color += shade(s, p, path.direction, cone_of(path), is_lit ? fraction * met.ball_left : vec3(0.0), met.thin);
}

// Marks the key of a pixel whose light is mostly of thin balls and glow.
float marked_key(float key, vec3 color) {
    float faint_part = max(1.0 - seen_left, seen_sharp / max(most_of(color), 1e-6));
    return faint_part > (seen_rough > 0.0 ? ROUGH_FAINT_PART : FAINT_PART) ? faint_key(key) : key;
}
#else
struct SwarmMet {
    bool is_ball;
};

SwarmMet meet_swarm(inout EyePath path, inout Hit hit, float fraction_min) {
    return SwarmMet(false);
}

bool is_shaded(Hit hit, SwarmMet met) {
    return hit.met;
}

float shaded_distance(Hit hit, SwarmMet met) {
    return hit.t;
}

void add_light(inout EyePath path, Surface s, vec3 p, SwarmMet met, vec3 fraction, bool is_lit) {
    if (is_lit) path.color += shade(s, p, path.direction, cone_of(path), fraction, ThinBalls(vec3(0.0), vec3(0.0), 0.0));
}

float marked_key(float key, vec3 color) {
    return key;
}
#endif

#if !defined(DRAWS_SWARM) || !defined(SWARM_TILES)
#define FORGET_SWARM_TILES

void mirror_swarm_tiles(EyePath path, Surface s, Hit hit) {}
#endif
