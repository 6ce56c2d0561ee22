// Swarms of points: balls, which hide what is behind them, and glow, which adds light. A ray walks through the trees of
// the points (crates/field/src/world/swarm.rs), which follow the texts and pictures in the sound tables. A ray of the eye
// in a flat picture looks through the list of its tile instead (swarm_tiles.rs).
//
// A point that is thinner than a pixel is drawn as wide as a pixel and fainter, so that its light does not flicker.

#define swarm_first int(frame_mouse.w)

// Bound of the fraction by which the light of a glow changes within its width.
const float SWARM_SLOPE = 9.0;
// Nodes of a tree that a ray visits, at most.
const int SWARM_NODES_MAX = 2048;
// The least fraction of light that media leave, if swarms are in them.
const float MEDIUM_LEFT_MIN = 1e-3;
// The number of the object in keys of surfaces.
const int SWARM_OBJECT = 300;
// Thin balls that reflect less of the light than this are not lit.
const float SWARM_LIT_MIN = 0.002;
// Nodes that all rays of a pixel visit together, at most: llvmpipe ends all loops after 65,535 rounds (rounds.glsl).
const int SWARM_ROUNDS = 10000;
int swarm_rounds = 0;

#if !defined(PROJECTED) && !defined(PATHS)
#define SWARM_TILES
#endif
// Other rays: mirrored ones, and all rays of other pictures.
#if !defined(SWARM_TILES) || defined(MIRRORS) || defined(GLASS)
#define SWARM_TREES
#endif

// What a ray sees of the swarms: the nearest ball, and in front of it faint light and thin balls.
struct SwarmSeen {
    vec3 light;         // of glow and thin balls
    float light_t;      // its mean distance
    float weight;       // its brightness
    float sharp;        // the part of its brightness that may change from pixel to pixel
    float covered;      // sum of the parts of the pixel that thin balls cover
    float left;         // fraction of the light behind the thin balls
    float thin_t;       // their mean distance
    vec3 thin_color;    // their mean colour; 0 if they need no light
    int ball;           // texel of the nearest ball; 0 if there is none
    float t;            // its distance, or the end of the ray
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

vec3 swarm_color(float bytes) {
    int color = int(bytes);
    return vec3(ivec3(color, color >> 8, color >> 16) & 255) / 255.0;
}

// Adds a point that a ray may meet: a ball, or if `is_faint` what is drawn faint. `cone` is the radius of the ray's pixel at
// its origin.
void swarm_add(inout SwarmSeen seen, int point, bool is_faint, vec3 origin, vec3 direction, float cone) {
    vec4 place = TEXEL(sound_tables, point);
    vec4 way = TEXEL(sound_tables, point + 1);
    SwarmApproach at = swarm_approach(origin, direction, place.xyz, way.xyz);
    float radius = place.w;
    if (!is_faint) {
        float t = at.t - sqrt(max(radius * radius - at.distance2, 0.0));
        bool is_nearer = at.distance2 < radius * radius && t > 0.0 && t < seen.t;
        seen.t = is_nearer ? t : seen.t;
        seen.ball = is_nearer ? point : seen.ball;
        return;
    }
    float spread = camera_position.w;
    float pixel = cone + spread * at.t;
    pixel = clamp(pixel, 1e-9, SWARM_WIDEST * spread * distance(place.xyz, camera_position.xyz) + 2e-9);
    vec4 light = TEXEL(sound_tables, point + 2);
    bool is_thin = light.w > 0.5;
    // The edge of a thin ball is as wide as a pixel.
    float middle = max(sqrt(max(radius * radius - pixel * pixel / 3.0, 0.0)), pixel);
    float wide = is_thin ? middle + pixel : sqrt(radius * radius + 16.0 * pixel * pixel);
    float drawn = is_thin ? sqrt(middle * middle + pixel * pixel / 3.0) : wide;
    float part = 1.0 - at.distance2 / (wide * wide);
    if (part <= 0.0) return;
    // The part of the glow that is between both distances.
    float half_chord = wide * sqrt(part);
    float between = smoothstep(-half_chord, half_chord, seen.t - at.t)
                  - smoothstep(-half_chord, half_chord, -at.t);
    // A glow that is drawn wider has a softer middle, with the same light in all.
    float sharp = radius * radius / (wide * wide);
    float shape = part * part * part * mix(0.313, 1.0, sharp) / (1.0 + 20.0 * sharp * (1.0 - part));
    if (is_thin) {
        between = at.t > 0.0 && at.t < seen.t ? 1.0 : 0.0;
        shape = clamp(0.5 * (wide - sqrt(at.distance2)) / pixel, 0.0, 1.0);
    }
    float strength = shape * between * min(swarm_dimming(radius, drawn, at.streak), 1.0);
    float brightness = strength * max(light.r, max(light.g, light.b));
    seen.weight += brightness;
    seen.sharp += brightness * min(SWARM_SLOPE * pixel / wide, 1.0);
    seen.light_t += brightness * at.t;
    seen.light += strength * light.rgb;
    if (is_thin) {
        seen.covered += strength;
        seen.left *= 1.0 - strength;
        seen.thin_t += strength * at.t;
        seen.thin_color += strength * swarm_color(way.w);
    }
}

// Counts tests of nodes and points.
void swarm_pass(int tests) {
    swarm_rounds += tests;
#ifdef LIMITED_ROUNDS
    rounds_run += 2 * tests;
#endif
#ifdef COUNT_EVALUATIONS
    count_swarm += float(tests);
#endif
}

// In the following functions, the walk to the next point is a loop of its own, because renderers that never skip a branch
// would compute a point for each test.

#ifdef SWARM_TILES
// The texel of the tiles of rays of the eye. The tiles of rays that a plane mirrors follow.
const int SWARM_TILES_OF_EYE = 7;

// Returns the texel of the tiles of rays that a plane mirrors, or 0.
int swarm_tiles_of(int plane) {
    bool has_tiles = plane != NOTHING && int(TEXEL(sound_tables, swarm_first + SWARM_TILES_OF_EYE + 1).w) == plane + 1;
    return has_tiles ? SWARM_TILES_OF_EYE + 1 : 0;
}

// Looks through the list of the tile that a ray belongs to: the balls, then everything faint in front of the nearest ball.
// `head` is the texel of the tiles. `travelled` is the way from the eye to `origin`, and `cone` the radius of the ray's
// pixel there.
void swarm_look_up(inout SwarmSeen seen, int head, vec3 origin, vec3 direction, float travelled, float cone) {
    vec4 tiles = TEXEL(sound_tables, swarm_first + head);
    vec2 in_tile = sample_place() / tiles.y;
    vec2 tile = floor(in_tile);
    // In the unit of the boxes.
    in_tile = SWARM_TILE_PARTS * (in_tile - tile);
    vec4 list = TEXEL(sound_tables, swarm_first + int(tiles.x + tile.y * tiles.z + tile.x));
    for (int kind = 0; kind < 2; kind++) {
        int entry = swarm_first + int(kind == 0 ? list.x : list.y);
        int end = swarm_first + int(kind == 0 ? list.y : list.z);
        int most = min(SWARM_NODES_MAX, SWARM_ROUNDS - swarm_rounds);
        int left = most;
        for (int i = 0; i < SWARM_NODES_MAX; i++) {
            int point = 0;
            for (; left > 0; left--) {
                if (entry >= end || point > 0) break;
                vec4 box = TEXEL(sound_tables, entry);
                vec2 low = floor(box.xy);
                vec2 high = SWARM_TILE_PARTS * (box.xy - low) + 1.0;
                bool is_in = all(greaterThanEqual(in_tile, low)) && all(lessThanEqual(in_tile, high));
                point = is_in && box.z < travelled + seen.t ? int(box.w) : 0;
                entry++;
            }
            if (point == 0) break;
            swarm_add(seen, swarm_first + point, kind > 0, origin, direction, cone);
        }
        swarm_pass(most - left);
    }
}
#endif

#ifdef SWARM_TREES
// Walks through the trees: the balls, then everything faint in front of the nearest ball.
void swarm_walk(inout SwarmSeen seen, vec3 origin, vec3 direction, float cone) {
    vec4 head = TEXEL(sound_tables, swarm_first);
    vec3 inverse = 1.0 / (direction + mix(vec3(-1e-9), vec3(1e-9), greaterThanEqual(direction, vec3(0.0))));
    for (int kind = 0; kind < 2; kind++) {
        int first = swarm_first + int(kind == 0 ? head.x : head.z);
        int count = int(kind == 0 ? head.y : head.w);
        int node = 0;
        int most = min(SWARM_NODES_MAX, SWARM_ROUNDS - swarm_rounds);
        int left = most;
        for (int i = 0; i < SWARM_NODES_MAX; i++) {
            int point = 0;
            for (; left > 0; left--) {
                if (node >= count || point > 0) break;
                vec4 low = TEXEL(sound_tables, first + 2 * node);
                vec4 high = TEXEL(sound_tables, first + 2 * node + 1);
                vec3 a = (low.xyz - origin) * inverse;
                vec3 b = (high.xyz - origin) * inverse;
                vec3 near = min(a, b);
                vec3 far = max(a, b);
                float enters = max(max(near.x, near.y), max(near.z, 0.0));
                float leaves = min(min(far.x, far.y), min(far.z, seen.t));
                point = enters <= leaves ? int(high.w) : 0;
                node = enters <= leaves ? node + 1 : int(low.w);
            }
            if (point == 0) break;
            swarm_add(seen, swarm_first + point, kind > 0, origin, direction, cone);
        }
        swarm_pass(most - left);
    }
}
#endif

// Returns what a ray sees of the swarms up to a distance. `travelled` is the way from the eye to the ray's origin. `head` is
// the texel of the tiles of such rays, or 0. The pass of media shows no swarm.
SwarmSeen swarm_along(vec3 origin, vec3 direction, float end, float travelled, int head) {
    SwarmSeen seen = SwarmSeen(vec3(0.0), 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, vec3(0.0), 0, end);
    float cone = camera_position.w * travelled;
#ifdef SWARM_TILES
    if (head > 0 && !is_medium_pass()) swarm_look_up(seen, head, origin, direction, travelled, cone);
#else
    head = 0;
#endif
#ifdef SWARM_TREES
    if (head == 0 && !is_medium_pass()) swarm_walk(seen, origin, direction, cone);
#endif
    seen.light_t /= max(seen.weight, 1e-9);
    seen.thin_t /= max(seen.covered, 1e-9);
    bool is_lit = max(seen.thin_color.r, max(seen.thin_color.g, seen.thin_color.b)) > SWARM_LIT_MIN;
    seen.thin_color = is_lit ? seen.thin_color / seen.covered : vec3(0.0);
    return seen;
}

// Returns a surface of a swarm. Its ambient light is known along the axes.
Surface surface_of_swarm(vec3 normal, vec3 color, vec3 emission) {
    Surface s;
    s.object = SWARM_OBJECT;
    s.normal = normal * inversesqrt(max(dot(normal, normal), 1e-12));
    Material m = default_material();
    m.color = color;
    m.roughness = 0.6;
    m.emission = emission;
    s.material = m;
    s.ambient = vec3(0.0);
    for (int axis = 0; axis < 3; axis++) {
        int facing = s.normal[axis] < 0.0 ? 1 : 0;
        s.ambient += s.normal[axis] * s.normal[axis] * TEXEL(sound_tables, swarm_first + 1 + 2 * axis + facing).rgb;
    }
    s.open = 1.0;
    s.glow = vec3(0.0);
    return s;
}

// Returns the surface of a ball at `p`.
Surface swarm_surface(int ball, vec3 p, vec3 direction) {
    vec4 place = TEXEL(sound_tables, ball);
    vec4 way = TEXEL(sound_tables, ball + 1);
    // The normal points away from the streak's nearest point to the ray.
    SwarmApproach at = swarm_approach(p - direction, direction, place.xyz, way.xyz);
    vec3 normal = at.across + (1.0 - at.t) * direction;
    return surface_of_swarm(normal, swarm_color(way.w), TEXEL(sound_tables, ball + 2).rgb);
}

// Returns the surface of thin balls at `p`.
Surface thin_surface(vec3 color, vec3 p, vec3 direction) {
    // Half of a thin ball that is lit from the side is dark, which this normal accounts for.
    vec3 to_light = lights[0].w == LIGHT_SUN ? -lights[0].xyz : lights[0].xyz - p;
    return surface_of_swarm(to_light * inversesqrt(max(dot(to_light, to_light), 1e-12)) - direction, color, vec3(0.0));
}
