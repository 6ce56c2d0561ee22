// Computes the light of a pixel by paths: rays that scatter at surfaces and media until they leave the scene (Kajiya
// 1986). The mean of a pixel's paths converges to the light itself, without the raster's approximations of indirect
// light, soft shadows, ambient occlusion and glow. The scene's functions, lights and materials are the raster's.
//
// A pass continues the path of each pixel by one ray and one ray towards a light, and a finished path is followed by the
// pixel's next one. Draws are therefore short, and the interpreter on llvmpipe keeps within its limit of rounds
// (rounds.glsl), however long the paths are.
//
// - Lights are sampled at each surface, and are also met by chance; both are weighted by their densities (Veach and
//   Guibas 1995, power heuristic). The eye and mirrors do not see lights, as in the raster.
// - The sky that the eye and mirrors see has the sky's colour. All other rays meet its ambient light, because a sky may
//   show a sun that is also a light.
// - Surfaces that emit light are met by chance, and swarms and their glow.
// - Mirror images (`reflect`) and glass have the raster's reflectance and facets. Rays towards lights
//   pass glass straight, so there are no caustics of lights. Light through translucent bodies is the raster's.
// - Media scatter light many times, endless media only twice (path_media.glsl).

#include "frame_block.glsl"

#include "sample_place.glsl"
#include "camera_ray.glsl"
#include "counters.glsl"
#include "rounds.glsl"
#include "material.glsl"
#include "view_notes.glsl"
#include "scene_inputs.glsl"
#include "footprint.glsl"
#include "normal.glsl"
#include "occlusion.glsl"
#include "regions.glsl"
#include "glass.glsl"
#include "scene_functions.glsl"
#include "sphere_tracing.glsl"
#include "shadow.glsl"
#include "light.glsl"
#include "picture_block.glsl"
#include "path_state.glsl"
#include "path_random.glsl"
#include "path_lights.glsl"
#include "path_lobes.glsl"
#ifdef SWARM
#include "swarm.glsl"
#endif
#ifdef MEDIA
#include "media.glsl"
#include "path_media.glsl"
#endif

layout(location = 0) out vec4 state_origin;
layout(location = 1) out vec4 state_direction;
layout(location = 2) out vec4 state_throughput;
layout(location = 3) out vec4 state_sum;

// The numbers of a pass; written by crates/render/src/gpu/renderer/paths.rs.
#define path_corner pass_sample.xy                  // the place of the first pixel of the state in the frame
#define path_first uint(pass_sample.z)              // number of the pixel's first path in the sequence
#define path_sampling int(pass_sample.w)            // SAMPLE_...
#define paths_most int(pass_list.x)                 // largest number of paths of a pixel
#define path_noise pass_list.y                      // a pixel is finished if its relative standard error is below this
#define is_beginning (pass_list.z > 0.5)            // true in the first pass, in which there is no state
#define is_guiding (pass_list.z > 1.5)              // true in the passes that write what pixels show, for the filter
#define guides_before int(pass_list.z - 1.5)        // number of such passes before

// How light is found: the first one in pictures, the others in tests of it.
const int SAMPLE_BOTH = 0;
const int SAMPLE_LIGHTS = 1;
const int SAMPLE_LOBES = 2;

// The end of a ray that leaves the scene, beyond every light.
const float NEVER = 1e9;

// Pairs of numbers for a path, and for each of its rays.
const int PLACE_PAIR = 0;
const int LENS_PAIR = 1;
const int RAY_PAIRS = 2;
const int LIGHT_PAIR = 0;       // the direction to a light
const int LOBE_PAIR = 1;        // the direction of the next ray
const int CHOICE_PAIR = 2;      // which light, which lobe
const int SURVIVAL_PAIR = 3;    // mirror or lobe, and the end of a path
#ifdef SWARM
const int SWARM_PAIR = 4;       // whether a ray meets thin balls
const int PAIRS = 5;
#else
const int PAIRS = 4;
#endif

// From this ray on, a path may end by chance.
const int CERTAIN_RAYS = 3;
// Paths are not stopped before this number of them, so that the estimate of the noise is not only luck.
const int PATHS_MIN = 16;
// Noise in darker light than this fraction of white is not visible.
const float DARKEST = 0.02;
// Shadows of paths have no penumbra: a path samples the light's width.
const float SHARPEST = 1e5;

// The place from which a path goes on.
struct Vertex {
    vec3 origin;
    Lobes lobes;        // of a surface
    float lobed;        // fraction of the lobes' light that rays may meet by chance
    bool is_medium;
    vec3 kept;          // of a medium
    float phase;
};

float vertex_density(Vertex at, vec3 to) {
#ifdef MEDIA
    if (at.is_medium) return scattering(at.phase, dot(at.lobes.direction, to));
#endif
    return lobe_density(at.lobes, to);
}

vec3 vertex_reflectance(Vertex at, vec3 to) {
#ifdef MEDIA
    if (at.is_medium) return at.kept * scattering(at.phase, dot(at.lobes.direction, to));
#endif
    return lobe_reflectance(at.lobes, to);
}

// The weight of a direction that was drawn with the density `own` and could have been drawn with `other`.
float weight_of(float own, float other) {
    float ratio = other / max(own, 1e-30);
    return 1.0 / (1.0 + ratio * ratio);
}

vec3 finite_light(vec3 light) {
    float bright = brightness_of(light);
    return bright >= 0.0 && bright < 1e12 ? max(light, vec3(0.0)) : vec3(0.0);
}

int last_light() {
    return min(int(frame_clock.y), LIGHTS_MAX) - 1;
}

float all_shares(vec3 origin) {
    float sum = 0.0;
    for (int i = 0; i <= last_light(); i++) sum += light_share(i, origin);
    return sum;
}

// Returns the light of all lights that a ray meets by chance before `end`, or behind surfaces that do not stop all of it.
vec3 lights_met(Path path, float end, bool is_scattered) {
    vec3 sum = vec3(0.0);
    float shares = all_shares(path.origin);
    for (int i = 0; i <= last_light(); i++) {
        LightPoint met = light_on_ray(i, path.origin, path.direction, false);
        float share = light_share(i, path.origin);
        if (!(met.t >= 0.0) || !(share > 0.0)) continue;
        float passing = met.t < end ? 1.0 : is_scattered ? 0.0 : 1.0 - met.shadow;
        float weight = path_sampling == SAMPLE_LOBES ? 1.0 : weight_of(path.density, met.density * share / shares);
        sum += met.radiance * (passing * weight);
    }
    return path_sampling == SAMPLE_LIGHTS ? vec3(0.0) : sum;
}

// Returns the light of one light at a place, whose choice `random` is.
vec3 light_sampled(Vertex at, float cone, float random, vec2 direction_random) {
    float shares = all_shares(at.origin);
    if (!(shares > 0.0) || path_sampling == SAMPLE_LOBES) return vec3(0.0);
    float before = 0.0;
    int chosen = 0;
    float chosen_share = 0.0;
    for (int i = 0; i <= last_light(); i++) {
        float share = light_share(i, at.origin);
        if (share > 0.0 && before <= random * shares) {
            chosen = i;
            chosen_share = share;
        }
        before += share;
    }
    vec3 to = towards_light(chosen, at.origin, direction_random);
    LightPoint point = light_on_ray(chosen, at.origin, to, true);
    float density = point.density * chosen_share / shares;
    if (!(density > 0.0) || point.t < 0.0) return vec3(0.0);
    float weight = path_sampling == SAMPLE_LIGHTS ? 1.0 : mix(1.0, weight_of(density, vertex_density(at, to)), at.lobed);
    vec3 thrown = vertex_reflectance(at, to);
    // The part that rays find by chance.
    vec3 met = thrown * (1.0 - weight);
    vec3 normal = at.is_medium ? vec3(0.0) : at.lobes.normal;
#ifdef TRANSLUCENT
    // Light through the body, as in the raster. No ray meets it by chance.
    Material m = at.lobes.material;
    if (!at.is_medium) thrown += m.color * (0.5 * m.translucent / PI);
    shadow_dims = !at.is_medium && m.translucent > 0.0 ? 1.0 / max(m.depth, 1e-3) : 0.0;
    normal *= dot(normal, to) < 0.0 ? -1.0 : 1.0;
#endif
    vec3 light = finite_light(thrown * point.radiance / density);
    if (brightness_of(light) <= 0.0) return vec3(0.0);
    vec3 light_met = finite_light(met * point.radiance / density);
    float t = point.shadow > 0.0 ? point.t : 0.0;
    int rays = 1;
#ifdef GLASS
    // Glass stops or bends the rays that meet lights by chance, so a second ray looks for glass. The rays towards lights
    // find the rest.
    if (t > 0.0 && brightness_of(light_met) > 0.01 * brightness_of(light)) rays = 2;
#endif
    float visible = 0.0;
    float visible_met = 0.0;
    for (int i = 0; i < rays; i++) {
        penumbra_growth = i == 0 ? 1.0 / SHARPNESS_MAX : 0.0;
        visible_met = mix(1.0, light_visibility(at.origin, normal, to, t, SHARPEST, cone), point.shadow);
        if (i == 0) visible = visible_met;
        if (visible <= 0.0) break;
    }
#ifdef TRANSLUCENT
    shadow_dims = 0.0;
#endif
    light = light * visible - light_met * visible_met;
#ifdef MEDIA
    if (brightness_of(light) > 0.0) light *= meet_media(at.origin, to, point.t, true, false).left;
#endif
    return light;
}

// Returns a pixel's first ray.
void begin(inout Path path) {
    path.throughput = vec3(1.0);
    path.found = 0.0;
    path.travelled = 0.0;
    path.density = BY_EYE;
    path.direction = eye_ray();
    path.origin = ray_origin;
#ifdef LENS
    // A point of the lens, from which the ray goes to the point in focus.
    vec2 random = random_pair(LENS_PAIR);
    vec2 on_lens = picture_lens.x * sqrt(random.x) * vec2(cos(2.0 * PI * random.y), sin(2.0 * PI * random.y));
    float sharp = 1.0 / (max(picture_lens.y, 1e-7) * max(axial(1.0, path.direction), 1e-3));
    vec3 off = on_lens.x * normalize(ray_dx(1.0)) + on_lens.y * normalize(ray_dy(1.0));
    path.origin += off;
    path.direction = normalize(path.direction * sharp - off);
#endif
}

// True if the paths of a pixel and of its neighbours differ so little that their mean is known well enough.
bool is_known(Path path, ivec2 texel) {
    if (path.number < PATHS_MIN || path_noise <= 0.0) return false;
    ivec2 last = textureSize(path_state, 0).xy - 1;
    float errors = 0.0;
    float light = 0.0;
    float dark = DARKEST / max(picture_look.x, 1e-6);
    for (int i = 0; i < 9; i++) {
        ivec2 at = clamp(texel + ivec2(i % 3, i / 3) - 1, ivec2(0), last);
        int number = paths_of(texelFetch(path_state, ivec3(at, 0), 0).w);
        vec4 sum = texelFetch(path_state, ivec3(at, 3), 0);
        if (i == 4) {
            number = path.number;
            sum = vec4(path.sum, path.squares);
        }
        float count = float(max(number, 1));
        float mean = brightness_of(sum.rgb) / count;
        errors += number < 2 ? 1e12 : max(sum.a / count - mean * mean, 0.0) / (count - 1.0);
        light += (mean + dark) * (mean + dark);
    }
    return errors <= path_noise * path_noise * light;
}

void add(inout Path path, vec3 light) {
    vec3 sound = finite_light(path.throughput * light);
    path.sum += sound;
    path.found += brightness_of(sound);
}

// The guides of the filter: normal and distance of the first surface after mirrors and glass, and about the light of the path
// if a light of 1 lit everything.
vec4 guide = vec4(0.0, 0.0, 0.0, NEVER);
vec3 guide_color = vec3(0.0);
// Guides follow a path through this number of mirrors and walls of glass that are no rougher than this.
const int GUIDED_RAYS = 6;
const float GUIDED_ALPHA = 0.01;

// Follows the ray of a path, and draws the next one. Returns false at the end of the path.
bool go_on(inout Path path) {
    int pairs = RAY_PAIRS + PAIRS * path.ray;
    float spread = camera_position.w;
    float cone = spread * path.travelled;
    float start = path.ray > 0 ? 0.01 : 0.0;
#ifdef GLASS
    bool is_inside = path.density < INSIDE_BELOW;
    if (is_inside) path.density = INSIDE - path.density;
    ray_side = is_inside ? -1.0 : 1.0;
    // Walls of glass are thin, so rays start close to the surface.
    if (is_inside) start = 0.0;
#else
    const bool is_inside = false;
#endif
    Hit hit = trace(path.origin, path.direction, start, cone, spread, true);
#ifdef SWARM
    // A ray meets the thin balls of a swarm with the probability of the light that they hide.
    SwarmSeen seen = swarm_along(path.origin, path.direction, hit.met ? hit.t : FAR, path.travelled, 0);
    add(path, seen.light);
    guide_color += path.throughput * finite_light(seen.light);
    bool is_thin = random_pair(pairs + SWARM_PAIR).x >= seen.left;
    bool is_ball = is_thin || seen.ball > 0;
    if (is_ball) hit = Hit(is_thin ? seen.thin_t : seen.t, NOTHING, true);
#else
    const bool is_ball = false;
#endif
#ifdef GLASS
    ray_side = 1.0;
    bool leaves = is_inside && hit.met && !met_in_glass && hit.plane == NOTHING && !is_ball;
#endif
    float end = hit.met ? hit.t : NEVER;
    bool is_scattered = false;
#ifdef MEDIA
    // There is no medium in glass, and the filter is guided by surfaces.
    bool is_clear = is_inside || is_guiding;
    Meeting met = meet_media(path.origin, path.direction, is_clear ? 0.0 : end, false, path.density == BY_EYE);
    if (is_clear) met.t = end;
    is_scattered = met.t < end;
    end = met.t;
    add(path, met.emitted);
    vec3 ambient_throughput = met.is_last ? vec3(0.0) : path.throughput * met.ambient;
#endif
    if (path.density > 0.0) add(path, lights_met(path, end, is_scattered));

    float reached = path.travelled + (hit.met || is_scattered ? end : 1.0);
    vec3 dx = ray_dx(reached);
    vec3 dy = ray_dy(reached);
    vec3 sky_fraction = is_scattered ? vec3(0.0) : path.throughput;
    vec3 seen_direction = path.direction;
    bool is_seen = path.density == BY_EYE;
    bool goes_on = hit.met || is_scattered;
#ifdef MEDIA
    // The filter smooths media before the sky.
    if (!goes_on && path.ray == 0) guide.xyz = -path.direction;
#endif
    if (goes_on) {
        path.travelled = reached;
        cone = spread * reached;
        vec3 p = path.origin + end * path.direction;
        vec2 survival = random_pair(pairs + SURVIVAL_PAIR);
        vec2 choice = random_pair(pairs + CHOICE_PAIR);
        Vertex at;
        at.is_medium = is_scattered;
        at.origin = p;
        at.lobed = 1.0;
        bool is_mirrored = false;
#ifdef GLASS
        bool goes_inside = is_inside && !leaves;
#endif
        vec3 to = path.direction;
#ifdef MEDIA
        at.kept = met.kept;
        at.phase = met.phase;
#endif
        vec4 plane = plane_of(hit.plane);
        if (hit.plane != NOTHING && !is_scattered) p -= plane.xyz * (dot(plane.xyz, p) + plane.w);
        Surface s;
#ifdef SWARM
        if (is_thin) {
            s = thin_surface(seen.thin_color, p, path.direction);
        } else if (is_ball) {
            s = swarm_surface(seen.ball, p, path.direction);
        } else
#endif
        {
#ifdef GLASS
            // The glass around an opaque surface.
            for (int i = goes_inside ? 0 : 1; i < 2; i++) {
                surface_penumbra = goes_inside && i > 0 ? WITHOUT_GLASS : 0.0;
                s = scene_surface(p, i > 0 ? hit.plane : NOTHING, path.direction, cone, dx, dy);
                if (is_inside && (i == 0 || leaves)) path.throughput *= exp(-within_ranges(s.material).absorb * end);
            }
#else
            s = scene_surface(p, hit.plane, path.direction, cone, dx, dy);
#endif
        }
        Material m = within_ranges(s.material);
#ifdef GLASS
        if (hit.plane != NOTHING) m.glass = 0.0;
        if (leaves) {
            s.normal = -s.normal;
            m.glass = 1.0;
            m.haze = 0.0;
        }
        vec3 colored = m.color;
        m.color *= 1.0 - m.glass;
#else
        vec3 colored = m.color;
#endif
        at.lobes = lobes_of(m, s.normal, path.direction);
        if (!is_scattered) {
            sky_fraction = path.throughput * m.haze;
            path.throughput *= 1.0 - m.haze;
            vec3 kept = path.throughput;
            float off = hit.plane != NOTHING ? 0.0 : max(0.002, cone);
            at.origin = p + s.normal * off;
            vec3 facing = s.normal;
#ifdef BLUR
            float alpha = m.blur * m.blur;
            if (alpha > 1e-4 && !is_guiding) facing = facet(s.normal, alpha, random_pair(pairs + LOBE_PAIR));
#endif
            // The fractions of light that the surface mirrors, scatters, and lets through.
            float reflectance = mirrored_part(m, s.normal, path.direction);
            vec3 tint = mix(vec3(1.0), colored, m.metalness);
#ifdef SHEEN
            tint *= film_color(m.film, clamp(-dot(path.direction, s.normal), 0.0, 1.0));
#endif
            vec3 mirrored = reflectance * tint;
            float scattered = 1.0 - reflectance;
            float bent = 0.0;
#ifdef GLASS
            float ratio = leaves ? m.ior : 1.0 / m.ior;
            float of_glass = glass_reflectance(ratio, clamp(-dot(path.direction, facing), 0.0, 1.0));
            if (m.glass > 0.0) {
                mirrored = leaves ? vec3(of_glass) : max(reflectance, m.glass * of_glass) * tint;
                bent = m.glass * (1.0 - of_glass);
            }
            if (leaves) scattered = 0.0;
            // The mirror image of glass replaces the rays of its highlight, but not the highlights of lights.
            at.lobed = 1.0 - m.glass * (at.lobes.shares.y + at.lobes.shares.z);
#endif
            path.throughput = kept * scattered;
            add(path, m.emission);
            if (!is_guiding) add(path, light_sampled(at, cone, choice.x, random_pair(pairs + LIGHT_PAIR)));
            // The ray goes one of these ways, with about the probability of the light that takes it.
            vec3 ways = vec3(brightness_of(mirrored), bent, scattered * at.lobed * max(at.lobes.bright, 0.05));
            ways /= max(ways.x + ways.y + ways.z, 1e-6);
            if (is_guiding) {
                guide = vec4(s.normal, path.travelled);
                guide_color += kept * (scattered * (mix(vec3(0.04), vec3(1.0), m.color) + finite_light(m.emission)));
                guide_color += kept * (mirrored + bent);
                bool is_rough = false;
#ifdef BLUR
                is_rough = alpha > GUIDED_ALPHA;
#endif
                bool is_image = !is_rough && ways.x + ways.y > ways.z;
                bool is_reflected = is_image && ways.x > ways.y;
                ways = vec3(is_reflected, is_image && !is_reflected, !is_image);
            }
            is_mirrored = survival.x < ways.x + ways.y;
            if (survival.x < ways.x) {
                to = reflect(path.direction, facing);
                to = normalize(to + s.normal * max(0.02 - dot(to, s.normal), 0.0));
                path.throughput = kept * mirrored / ways.x;
#ifdef GLASS
                goes_inside = goes_inside || leaves;
#endif
            } else if (is_mirrored) {
#ifdef GLASS
                to = refract(path.direction, facing, ratio);
                to = normalize(to - s.normal * max(0.02 + dot(to, s.normal), 0.0));
                path.throughput = kept * (bent / ways.y);
                at.origin = p - s.normal * off;
                goes_inside = !leaves;
#endif
            } else {
                path.throughput = kept * (scattered * at.lobed / max(ways.z, 1e-6));
            }
        } else {
            add(path, light_sampled(at, cone, choice.x, random_pair(pairs + LIGHT_PAIR)));
        }
        if (is_mirrored) {
            // The next surface's colour replaces the white of this image.
            guide_color -= path.throughput;
            path.density = path.density == BY_EYE ? BY_EYE : BY_MIRROR;
        } else {
            vec2 random = random_pair(pairs + LOBE_PAIR);
#ifdef MEDIA
            if (is_scattered) to = around(path.direction, scattering_rise(at.phase, random.x), random.y);
#endif
            if (!is_scattered) to = lobe_direction(at.lobes, choice.y, random);
            float density = vertex_density(at, to);
            path.throughput *= density > 0.0 ? vertex_reflectance(at, to) / density : vec3(0.0);
            path.density = density;
        }
#ifdef GLASS
        if (goes_inside) path.density = INSIDE - path.density;
#endif
        path.origin = at.origin;
        path.direction = to;
        float most = max(path.throughput.r, max(path.throughput.g, path.throughput.b));
        float survives = path.ray < CERTAIN_RAYS || is_guiding ? 1.0 : min(most, 0.95);
        goes_on = most > 0.0 && most < 1e12 && survival.y < survives && path.ray + 1 < FINISHED;
        goes_on = goes_on && (is_mirrored || !is_guiding);
        path.throughput /= max(survives, 1e-6);
#ifdef MEDIA
        goes_on = goes_on && !(is_scattered && met.is_last);
#endif
    }
    vec3 next_throughput = path.throughput;
    guide_color += sky_fraction;
#ifdef NO_SKY
    if (path.ray == 0) sky_fraction = vec3(0.0);
#endif
    // Ambient light is part of the light that media emit in the raster. Paths find it themselves, so it is subtracted.
#ifdef MEDIA
    vec3 mean_ambient = vec3(0.0);
    float any_scattered = brightness_of(ambient_throughput);
    int first = any_scattered > 0.0 ? 0 : 6;
#else
    const int first = 6;
#endif
    float scale = 1.0 / max(reached, 1e-6);
    for (int i = first; i < 7; i++) {
        bool is_sky = i == 6;
        if (is_sky && !(max(sky_fraction.r, max(sky_fraction.g, sky_fraction.b)) > 0.0)) break;
        vec3 axis = vec3(equal(ivec3(i >> 1), ivec3(0, 1, 2))) * ((i & 1) == 0 ? 1.0 : -1.0);
        vec3 light = light_of(sky_light(is_sky ? seen_direction : axis, dx * scale, dy * scale, is_sky && is_seen));
        path.throughput = sky_fraction;
        if (is_sky) add(path, light);
#ifdef MEDIA
        if (!is_sky) mean_ambient += light * (1.0 / 6.0);
#endif
    }
#ifdef MEDIA
    vec3 doubled = ambient_throughput * mean_ambient;
    path.sum -= doubled;
    path.found -= brightness_of(doubled);
#endif
    path.throughput = next_throughput;
    return goes_on;
}

void main() {
    load_frame();
    scene_load();
    ivec2 texel = ivec2(gl_FragCoord.xy);
    Path path;
    if (is_beginning) {
        path = Path(vec3(0.0), 0, 0, vec3(0.0, 0.0, 1.0), BY_EYE, 0.0, vec3(1.0), 0.0, vec3(0.0), 0.0);
    } else {
        path = path_of(texel);
    }
    uvec2 pixel = uvec2(texel + ivec2(path_corner));
    path_seed = hashed(pixel.x ^ hashed(pixel.y ^ 0x9E3779B9u));
    path_index = path_first + uint(is_guiding ? guides_before : path.number);
#ifdef MEDIA
    path_stream = hashed(path_seed ^ hashed(path_index * uint(RAYS_MAX) + uint(path.ray)));
#endif
    path_place = gl_FragCoord.xy + path_corner + random_pair(PLACE_PAIR) - 0.5;
    vec3 eye_direction = eye_ray();
    if (path.ray == 0) begin(path);
    if (path.ray == 0 && path.number >= paths_most) path.ray = FINISHED;
    if (path.ray != FINISHED) {
        bool goes_on = eye_direction != vec3(0.0);
        for (int i = 0; goes_on && i < (is_guiding ? GUIDED_RAYS : 1); i++) {
            goes_on = go_on(path);
            path.ray++;
        }
        if (goes_on) guide_color += path.throughput;
        if (!goes_on) {
            path.number++;
            path.ray = 0;
            path.squares += path.found * path.found;
            path.found = 0.0;
            if (path.number >= paths_most || is_known(path, texel)) path.ray = FINISHED;
        }
    }
    if (is_guiding) {
        // The mean of all such passes, so that pixels at edges differ from both sides.
        state_origin = guide;
        state_direction = vec4(max(guide_color, 0.0), 1.0);
        if (guides_before > 0) {
            float before = 1.0 - 1.0 / float(guides_before + 1);
            state_origin = mix(state_origin, texelFetch(path_state, ivec3(texel, 0), 0), before);
            state_direction = mix(state_direction, texelFetch(path_state, ivec3(texel, 1), 0), before);
        }
        state_throughput = vec4(0.0);
        state_sum = vec4(0.0);
        return;
    }
    state_origin = vec4(path.origin, float(path.number * RAYS_MAX + path.ray));
    state_direction = vec4(octahedral(path.direction), path.density, path.travelled);
    state_throughput = vec4(path.throughput, path.found);
    state_sum = vec4(path.sum, path.squares);
}
