// Swarms on paths (variant SWARM).

#ifdef SWARM
#include "swarm.glsl"

// Balls of swarms on a ray.
struct BallsMet {
    SwarmSeen seen;
    bool is_ball;
    bool is_thin;
};

// Adds the light of the swarms before the end of the ray. A ball becomes the end.
BallsMet meet_balls(inout Path path, inout Hit hit, int pairs) {
    BallsMet met;
    met.seen = swarm_along(path.origin, path.direction, hit.met ? hit.t : FAR, path.travelled, 0);
    add(path, path.throughput * met.seen.light);
    guide_color += path.throughput * finite_light(met.seen.light);
    // A ray meets thin balls with the probability of the light that they hide.
    met.is_thin = random_pair(pairs + SWARM_PAIR).x >= met.seen.left;
    met.is_ball = met.is_thin || met.seen.ball > 0;
    if (met.is_ball) hit = Hit(met.is_thin ? met.seen.thin_t : met.seen.t, NOTHING, true);
    return met;
}

Surface ball_surface(BallsMet met, vec3 p, vec3 direction) {
    if (met.is_thin) return thin_surface(met.seen.thin_color, p, direction);
    return swarm_surface(met.seen.ball, p, direction);
}
#else
struct BallsMet {
    bool is_ball;
};

BallsMet meet_balls(inout Path path, inout Hit hit, int pairs) {
    return BallsMet(false);
}
#endif
