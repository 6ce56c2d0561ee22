// Fog, smoke, clouds and other media: the light that they scatter and emit along a ray, and the fraction of the light
// behind them that is left.
//
// A pass of its own, with half of the frame's width and height, computes both for each ray of the eye and for the ray
// that its first mirror reflects. Stills and videos draw several layers of it, one above the other. Nine neighbouring rays
// and all layers take their steps at different places, and media_filter.frag computes their mean. Every sample of the picture then mixes the neighbouring rays that end at about the same distance.
//
// `crates/field/src/world/media.rs` sums the media of a scene, `crates/field/src/region/medium.rs` bounds their density.

#ifndef PATHS
#include "media_texels.glsl"
#endif

#ifdef COVERAGE
#define SCATTERS 0
#else
#define SCATTERS 1
#endif

// Number of steps along a ray.
const int MEDIUM_STEPS = 8;
// Rays leave an endless medium at this distance.
const float MEDIUM_FAR = 400.0;
// Beyond this length, steps become longer and longer.
const float EVEN_LENGTH = 8.0;
// Light travels at most this far through an endless medium.
const float MEDIUM_SHADE_FAR = 24.0;
// Shadows of the medium on itself that remove less than this fraction of the light are left out.
const float MEDIUM_SHADE_MIN = 0.03;
// Scattered light that is fainter than this needs no shadow ray.
const float SCATTERED_MIN = 2e-4;
// A ray that has less than this fraction of its light left ends.
const float LEFT_MIN = 0.004;
const int GRID_WALK_MAX = 3 * MEDIUM_SIDE;

Medium sound_medium(Medium m) {
    float density = m.density > 0.0 ? min(m.density, DENSEST) : 0.0;
    // The light keeps its proportion to the density.
    float thinned = m.density > DENSEST ? DENSEST / m.density : 1.0;
    float phase = abs(m.phase) < 0.96 ? m.phase : 0.0;
    return Medium(density, min(light_of(m.scattered * thinned), vec3(density)), light_of(m.emitted * thinned), phase);
}

// Returns an upper bound of the density at a place, from the grid's cells.
float densest_at(vec3 p) {
    vec3 q = (p - medium_grid_low.xyz) * medium_grid_scale.xyz;
    // Outside of the grid an endless medium goes on.
    if (any(lessThan(q, vec3(0.0))) || any(greaterThanEqual(q, vec3(float(MEDIUM_SIDE))))) return medium_grid_scale.w;
    ivec3 cell = ivec3(q);
    int number = cell.x + MEDIUM_SIDE * (cell.y + MEDIUM_SIDE * cell.z);
    return TEXEL(sound_tables, int(medium_grid_low.w) + (number >> 2))[number & 3];
}

// A ray through the cells of the grid.
struct GridWalk {
    vec3 origin;
    vec3 direction;
    vec3 inverse;   // 1 / direction, in cells
    float nudge;    // a short distance that leads into the next cell
};

GridWalk grid_walk_of(vec3 origin, vec3 direction) {
    vec3 pace = direction * medium_grid_scale.xyz;
    vec3 inverse = 1.0 / (pace + mix(vec3(-1e-9), vec3(1e-9), greaterThanEqual(pace, vec3(0.0))));
    float nudge = 1e-4 / max(max(abs(pace.x), abs(pace.y)), max(abs(pace.z), 1e-9));
    return GridWalk(origin, direction, inverse, nudge);
}

// Returns the point of the cell that the ray is in, or enters, at t.
vec3 point_of_cell(GridWalk walk, float t) {
    return walk.origin + (t + walk.nudge) * walk.direction;
}

// Returns the distance at which the ray leaves the cell of the point `p`.
float end_of_cell(GridWalk walk, float t, vec3 p) {
    vec3 q = (p - medium_grid_low.xyz) * medium_grid_scale.xyz;
    vec3 left = (floor(q) + step(vec3(0.0), walk.direction) - q) * walk.inverse;
    return t + (walk.nudge + max(min(left.x, min(left.y, left.z)), 0.0));
}

// Returns the distance from which a ray meets a medium; `end` if it meets none before.
float first_medium(vec3 origin, vec3 direction, float t, float end) {
    GridWalk walk = grid_walk_of(origin, direction);
    for (int i = 0; i < GRID_WALK_MAX; i++) {
        vec3 p = point_of_cell(walk, t);
        if (t >= end || densest_at(p) > 0.0) break;
        t = end_of_cell(walk, t, p);
    }
    return min(t, end);
}

// Returns the fraction of scattered light that goes on at an angle with this cosine, per steradian (Henyey and
// Greenstein 1941).
float scattering(float phase, float cosine) {
    float square = phase * phase;
    float base = max(1.0 + square - 2.0 * phase * cosine, 1e-4);
    return (1.0 - square) / (4.0 * PI * base * sqrt(base));
}

#ifndef PATHS
// Returns the light that the medium sends along the ray up to `end`, and the fraction of the light behind it that is
// left. `pattern`, 0..1, moves the steps.
vec4 medium_along(vec3 origin, vec3 direction, float end, float cone, float pattern) {
    vec4 sum = vec4(0.0, 0.0, 0.0, 1.0);
    vec2 span = box_span(origin, direction, medium_low.xyz, medium_high.xyz);
    float last = min(min(span.y, end), MEDIUM_FAR);
    float start = first_medium(origin, direction, max(span.x, 0.0), last);
    if (!(start < last)) return sum;
    // Walk back from the end.
    last = last - first_medium(origin + last * direction, -direction, 0.0, last - start);
    float reach = max(last - start, 1e-6);
    float growth = clamp(1.0 - EVEN_LENGTH / reach, 0.0, 0.98);
    int light_count = clamp(int(frame_clock.y), 1, LIGHTS_MAX);
    int light = int(pattern * 9.0);
    float done = 0.0;
#ifdef LIMITED_ROUNDS
    int rounds_before = rounds_run;
#endif
    for (int i = 0; i < MEDIUM_STEPS; i++) {
        if (sum.a < LEFT_MIN || done > 0.99) break;
        float part = 1.0 / float(MEDIUM_STEPS);
#ifdef LIMITED_ROUNDS
        // Take longer steps if the rest of the ray would need too many rounds.
        int affordable = i * (MEDIUM_ROUNDS - rounds_run) / max(rounds_run - rounds_before, 1);
        if (i > 0) part = max(part, (1.0 - done) / float(max(affordable, 1)));
#endif
        float along = done + part * pattern;
        done += part;
        float t = start + reach * along * mix(1.0, along, growth);
        float step_length = reach * (1.0 - growth + 2.0 * growth * along) * part;
        vec3 p = origin + t * direction;
        COUNT(count_medium_steps);
        if (densest_at(p) <= 0.0) continue;
        // The way to the light through the medium, whose length counts as `shade_length` at one place. That place is
        // random; near places are more likely.
        vec3 at = p;
        float shade_length = 0.0;
#if SCATTERS
        light = light + 1 < light_count ? light + 1 : 0;
        vec4 place = lights[4 * light];
        vec3 way = place.w == LIGHT_SUN ? -place.xyz : place.xyz - p;
        Incoming incoming = light_at(light, p, way * inversesqrt(max(dot(way, way), 1e-12)), direction);
        float far = box_span(p, incoming.direction, medium_low.xyz, medium_high.xyz).y;
        far = min(min(far, incoming.t), MEDIUM_SHADE_FAR);
        float random = fract(0.5 * pattern + 0.618034 * float(i));
        at += far * random * random * incoming.direction;
        bool is_shaded = far * medium_grid_scale.w > MEDIUM_SHADE_MIN && densest_at(at) > 0.0;
        shade_length = is_shaded ? 2.0 * random * far : 0.0;
#endif
        // A single call in a loop, because each call is compiled separately: first at the place on the way to the light.
        Medium m;
        float shade = 1.0;
        for (int probe = shade_length > 0.0 ? 0 : 1; probe < 2; probe++) {
            COUNT(count_medium);
            m = sound_medium(scene_medium(probe == 0 ? at : p));
            if (probe == 0) shade = exp(-m.density * shade_length);
        }
        vec3 source = m.emitted;
#if SCATTERS
        vec3 thrown = m.scattered * incoming.light
                    * (shade * float(light_count) * scattering(m.phase, dot(direction, incoming.direction)));
        if (max(thrown.r, max(thrown.g, thrown.b)) * step_length * sum.a > SCATTERED_MIN) {
            float sharpness = clamp(1.0 / max(incoming.widening, 1e-4), SHARPNESS_MIN, SHARPNESS_MAX);
            float shadow = incoming.shadow > 0.0 ? incoming.t : 0.0;
            float visible = light_visibility(LightRay(p, incoming.direction, shadow, sharpness), false);
            source += mix(1.0, visible, incoming.shadow) * thrown;
        }
#endif
        // The light of a step, dimmed by the step's own medium (Hillaire 2015).
        float dimming = m.density * step_length;
        float left = exp(-dimming);
        sum.rgb += source * (sum.a * step_length * (dimming > 1e-3 ? (1.0 - left) / dimming : 1.0 - 0.5 * dimming));
        sum.a *= left;
    }
    return sum;
}

// Returns a number in a different part of 0..1 for each layer and each of 3 x 3 neighbouring texels. Its place in that
// part is random, because equal steps in all rays would show as stripes; it is the same in each frame.
float medium_pattern() {
    uvec2 texel = uvec2(gl_FragCoord.xy);
    float layer = floor(gl_FragCoord.y / pass_list.w);
    uint random = texel.x * 1664525u + texel.y * 22695477u + 1013904223u;
    random = (random ^ (random >> 15u)) * 2246822519u;
    random = (random ^ (random >> 13u)) * 3266489917u;
    ivec2 cell = ivec2(medium_texel_place()) % ivec2(3);
    // A magic square, so that rows and columns have the same mean.
    int number = (cell.x + 2 * cell.y + 1) % 3 * 3 + (cell.x + cell.y) % 3;
    return (layer + (float(number) + float(random >> 8u) / 16777216.0) / 9.0) / pass_sample.w;
}

// Returns the medium before the end of the ray through a place in the frame, in pixels.
SeenMedium medium_seen(vec2 place, float end) {
    vec2 at = 0.5 * place - 0.5;
    ivec2 first = ivec2(floor(at));
    vec2 part = at - floor(at);
    SeenMedium sum = SeenMedium(vec3(0.0), 0.0, 0.0, 0.0);
    // The neighbour whose end is nearest has about as much light left as this ray.
    SeenMedium own = SeenMedium(vec3(0.0), 1.0, 1.0, end);
    float least = 1e9;
    for (int i = 0; i < 4; i++) {
        SeenMedium other = medium_texel(first + ivec2(i & 1, i >> 1));
        float off = abs(other.end - end);
        if (off < least) own.left = other.left;
        least = min(least, off);
    }
    float weights = 0.0;
    for (int i = 0; i < 4; i++) {
        ivec2 offset = ivec2(i & 1, i >> 1);
        vec2 near = mix(1.0 - part, part, vec2(offset)) + 1e-3;
        weights += add_medium(sum, medium_texel(first + offset), own, near.x * near.y);
    }
    return mean_medium(sum, weights, end);
}
#endif
