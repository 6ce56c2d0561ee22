// Swarms of points: balls, which hide what is behind them, and glow, which adds light. A ray walks through the trees of
// the points (crates/field/src/world/swarm.rs), which follow the texts and pictures in the sound tables.
//
// A point that is thinner than a pixel is drawn as wide as a pixel and fainter, so that its light does not flicker.

#define swarm_first int(camera_forward.w)

// Nodes that a ray visits in a tree, at most.
const int SWARM_NODES_MAX = 2048;
const int SWARM_LEAF = 4;
// Balls that a path meets, at most, beside other surfaces.
const int SWARM_BALLS_MAX = 4;
// The least fraction of light that media leave, if swarms are in them.
const float MEDIUM_LEFT_MIN = 1e-3;
// A ball that covers less of a pixel than this is invisible.
const float SWARM_COVERAGE_MIN = 0.003;
#ifdef SOFTWARE
// Rounds of a pixel's walks together, as llvmpipe ends all loops after 65,535 rounds (rounds.glsl).
const int SWARM_ROUNDS = 12000;
int swarm_rounds = 0;
#endif

// What a ray sees of the swarms: glow, and the nearest ball.
struct SwarmSeen {
    vec3 glow;
    float glow_t;       // mean distance of the glow
    float coverage;     // fraction of the ray's pixel that the ball covers; 0 if the ray meets no ball
    float t;            // distance of the ball
    vec3 normal;
    vec3 color;
    vec3 emission;
};

// The place where a ray is nearest to a point, or to the streak of a point that is stretched.
struct SwarmApproach {
    vec3 across;        // from the point to the ray
    float distance2;    // square of the length of `across`
    float t;            // along the ray
    float streak;       // length of the streak, as the ray sees it
};

SwarmApproach swarm_approach(vec3 origin, vec3 direction, vec3 place, vec3 way) {
    vec3 off = place - origin;
    vec3 off_across = off - dot(off, direction) * direction;
    vec3 way_across = way - dot(way, direction) * direction;
    float length2 = dot(way_across, way_across);
    float along = clamp(-dot(off_across, way_across) / max(length2, 1e-12), 0.0, 1.0);
    vec3 across = -off_across - along * way_across;
    return SwarmApproach(across, dot(across, across), dot(off + along * way, direction), sqrt(length2));
}

// Returns the part of its light that a streak keeps if it is drawn with another radius.
float swarm_dimming(float radius, float drawn, float streak) {
    return radius * (PI * radius + 2.0 * streak) / (drawn * (PI * drawn + 2.0 * streak));
}

// Returns what a ray sees of the swarms between two distances. `cone` is the radius of the ray's pixel at its origin.
SwarmSeen swarm_along(vec3 origin, vec3 direction, float start, float end, float cone) {
    SwarmSeen seen = SwarmSeen(vec3(0.0), 0.0, 0.0, end, -direction, vec3(0.0), vec3(0.0));
    // The pass of media shows no swarm.
    vec4 head = is_medium_pass() ? vec4(0.0) : TEXEL(sound_tables, swarm_first);
    vec3 inverse = 1.0 / (direction + mix(vec3(-1e-9), vec3(1e-9), greaterThanEqual(direction, vec3(0.0))));
    float spread = camera_position.w;
    float weight = 0.0;
    int nearest = 0;
    // The balls, then the glow in front of the nearest ball.
    for (int kind = 0; kind < 2; kind++) {
        int first = swarm_first + int(kind == 0 ? head.x : head.z);
        int count = int(kind == 0 ? head.y : head.w);
        int node = 0;
        for (int i = 0; i < SWARM_NODES_MAX; i++) {
            if (node >= count) break;
#ifdef SOFTWARE
            if (swarm_rounds >= SWARM_ROUNDS) break;
            swarm_rounds++;
#endif
            vec4 low = TEXEL(sound_tables, first + 2 * node);
            vec4 high = TEXEL(sound_tables, first + 2 * node + 1);
            vec3 a = (low.xyz - origin) * inverse;
            vec3 b = (high.xyz - origin) * inverse;
            vec3 near = min(a, b);
            vec3 far = max(a, b);
            float enters = max(max(near.x, near.y), max(near.z, start));
            float leaves = min(min(far.x, far.y), min(far.z, seen.t));
            int leaf = enters <= leaves ? int(high.w) : 0;
            node = enters <= leaves ? node + 1 : int(low.w);
            if (leaf == 0) continue;
            int point = swarm_first + (leaf >> 3);
            for (int k = 0; k < SWARM_LEAF; k++) {
                if (k >= (leaf & 7)) break;
#ifdef SOFTWARE
                swarm_rounds++;
#endif
                vec4 place = TEXEL(sound_tables, point + 3 * k);
                vec4 way = TEXEL(sound_tables, point + 3 * k + 1);
                SwarmApproach near_it = swarm_approach(origin, direction, place.xyz, way.xyz);
                float widest = SWARM_WIDEST * distance(place.xyz, camera_position.xyz);
                float pixel = max(min(cone + spread * near_it.t, spread * widest), 1e-9);
                float radius = place.w;
                if (kind == 0) {
                    // The edge is as wide as a pixel.
                    float middle = sqrt(max(radius * radius - pixel * pixel / 3.0, pixel * pixel));
                    float away = sqrt(near_it.distance2);
                    float edge = clamp(0.5 * (middle + pixel - away) / pixel, 0.0, 1.0);
                    float drawn = sqrt(middle * middle + pixel * pixel / 3.0);
                    float coverage = edge * min(swarm_dimming(radius, drawn, near_it.streak), 1.0);
                    float side = min(away / (middle + pixel), 1.0);
                    float t = near_it.t - radius * sqrt(1.0 - side * side);
                    if (coverage > SWARM_COVERAGE_MIN && t > start && t < seen.t) {
                        seen.coverage = coverage;
                        seen.t = t;
                        nearest = point + 3 * k;
                        seen.normal = near_it.across * (side / max(away, 1e-9)) - direction * sqrt(1.0 - side * side);
                    }
                } else {
                    float drawn = sqrt(radius * radius + 4.0 * pixel * pixel);
                    float part = near_it.distance2 / (drawn * drawn);
                    if (part < 1.0) {
                        // The part of the glow that is between both distances.
                        float half_chord = drawn * sqrt(1.0 - part);
                        float before = smoothstep(-half_chord, half_chord, seen.t - near_it.t)
                                     - smoothstep(-half_chord, half_chord, start - near_it.t);
                        float left = 1.0 - part;
                        float shape = left * left * left / (1.0 + 20.0 * part);
                        vec3 light = TEXEL(sound_tables, point + 3 * k + 2).rgb
                                   * (shape * before * swarm_dimming(radius, drawn, near_it.streak));
                        seen.glow += light;
                        seen.glow_t += light.g * near_it.t;
                        weight += light.g;
                    }
                }
            }
        }
        if (kind == 0 && nearest > 0) {
            int color = int(TEXEL(sound_tables, nearest + 1).w);
            seen.color = vec3(ivec3(color, color >> 8, color >> 16) & 255) / 255.0;
            seen.emission = TEXEL(sound_tables, nearest + 2).rgb;
        }
    }
    seen.glow_t /= max(weight, 1e-9);
    return seen;
}

// Returns the surface of the ball that a ray meets. Its ambient light is known along the axes.
Surface swarm_surface(SwarmSeen seen) {
    Surface s;
    s.object = 0;
    s.normal = normalize(seen.normal);
    s.material = Material(seen.color, 0.6, 0.0, seen.emission, 0.0, 0.0, 0.0, 0.0);
    s.ambient = vec3(0.0);
    for (int axis = 0; axis < 3; axis++) {
        int facing = s.normal[axis] < 0.0 ? 1 : 0;
        s.ambient += s.normal[axis] * s.normal[axis] * TEXEL(sound_tables, swarm_first + 1 + 2 * axis + facing).rgb;
    }
    s.open = 1.0;
    s.glow = vec3(0.0);
    return s;
}
