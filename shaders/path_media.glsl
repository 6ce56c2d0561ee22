// Media on paths: a ray meets matter at random, more often where it is dense (Woodcock et al. 1965, "delta tracking"), and
// a ray towards a light gets the fraction that is left (Novák et al. 2014, "ratio tracking"). Both need an upper bound of
// the density, which the grid over the media has for each of its cells.
//
// No light from infinity arrives through an endless medium, so that it would be black. Only the eye and mirrors see an
// endless medium as far as in the raster. All other rays leave it after MEDIUM_SHADE_FAR, as rays towards lights do in the
// raster. If they meet matter before, the path ends there with the sky's ambient light, as in the raster. A white medium in a
// white sky then stays white.

// Matter on a ray through media.
struct Meeting {
    float t;            // where it met matter; the ray's end if it met none
    float left;         // fraction of light that is left; for rays towards lights
    vec3 emitted;       // light on the way; includes the light that `ambient` stands for
    vec3 ambient;       // scattered fraction of ambient light on the way
    vec3 kept;          // fraction of light that the matter scatters
    float phase;
    bool is_last;       // the path ends at matter
};

#ifdef MEDIA
#include "media.glsl"

// Most places at which a ray looks at a medium. More are needed only in media that no light leaves.
const int MEETINGS_MAX = 512;
// Rays look at least this often at a medium, per unit of length, because it may emit light without being dense.
const float MEETINGS_MIN = 0.25;

// Follows a ray up to `end`. With `counts_left`, it does not stop at matter. `is_seen` for rays of the eye and its mirrors.
Meeting follow_media(vec3 origin, vec3 direction, float end, bool counts_left, bool is_seen) {
    vec2 span = box_span(origin, direction, medium_low.xyz, medium_high.xyz);
    bool is_last = !is_seen && span.y > MEDIUM_FAR;
    float last = min(min(span.y, end), is_last ? MEDIUM_SHADE_FAR : MEDIUM_FAR);
    Meeting met = Meeting(end, 1.0, vec3(0.0), vec3(0.0), vec3(0.0), 0.0, is_last);
    float t = max(span.x, 0.0);
    GridWalk walk = grid_walk_of(origin, direction);
    for (int i = 0; i < MEETINGS_MAX; i++) {
        if (!(t < last) || steps_left(1, MEDIUM_ROUNDS) <= 0) break;
        vec3 ahead = point_of_cell(walk, t);
        float bound = densest_at(ahead);
        float cell_end = end_of_cell(walk, t, ahead);
        bound = bound > 0.0 ? max(bound, MEETINGS_MIN) : 0.0;
        float next = bound > 0.0 ? t - log(1.0 - next_random()) / bound : cell_end;
        // In an exponential distribution the rest of the way does not depend on the way so far, so that each cell may
        // begin anew.
        t = min(next, cell_end);
        if (next >= cell_end || t >= last) continue;
        Medium m = sound_medium(scene_medium(origin + t * direction));
        if (counts_left) {
            met.left *= 1.0 - min(m.density / bound, 1.0);
            if (met.left < 1e-3) break;
            continue;
        }
        met.emitted += m.emitted / bound;
        met.ambient += m.scattered / bound;
        if (next_random() * bound < m.density) {
            met.t = t;
            met.kept = m.scattered / m.density;
            met.phase = m.phase;
            break;
        }
    }
    return met;
}

// Returns 1 - cosine of the angle by which light is scattered (Henyey and Greenstein 1941).
float scattering_rise(float phase, float random) {
    if (abs(phase) < 1e-3) return 2.0 * random;
    float ratio = (1.0 - phase * phase) / (1.0 - phase + 2.0 * phase * random);
    return clamp(1.0 - (1.0 + phase * phase - ratio * ratio) / (2.0 * phase), 0.0, 2.0);
}

// Follows a path's ray through media up to `end`, and adds the light on the way.
Meeting meet_media(inout Path path, float end, bool is_inside) {
    // There is no medium in glass, and the filter is guided by surfaces.
    bool is_clear = is_inside || is_guiding;
    Meeting met = follow_media(path.origin, path.direction, is_clear ? 0.0 : end, false, path.density == BY_EYE);
    if (is_clear) met.t = end;
    add(path, path.throughput * met.emitted);
    if (met.is_last) met.ambient = vec3(0.0);
    return met;
}

float left_by_media(vec3 origin, vec3 direction, float end) {
    return follow_media(origin, direction, end, true, false).left;
}

vec3 scattered_direction(vec3 direction, float phase, vec2 random) {
    return around(direction, scattering_rise(phase, random.x), random.y);
}

// The filter smooths media before the sky.
void guide_sky(Path path) {
    if (path.ray == 0) guide.xyz = -path.direction;
}

// Starts the path's sequence of independent numbers.
void begin_stream(Path path) {
    path_stream = hashed(path_seed ^ hashed(path_index * uint(RAYS_MAX) + uint(path.ray)));
}
#else
Meeting meet_media(inout Path path, float end, bool is_inside) {
    return Meeting(end, 1.0, vec3(0.0), vec3(0.0), vec3(0.0), 0.0, false);
}

float left_by_media(vec3 origin, vec3 direction, float end) {
    return 1.0;
}

float scattering(float phase, float cosine) {
    return 0.0;
}

vec3 scattered_direction(vec3 direction, float phase, vec2 random) {
    return direction;
}

void guide_sky(Path path) {}

void begin_stream(Path path) {}
#endif
