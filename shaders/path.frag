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
#include "glass.glsl"
#include "occlusion.glsl"
#include "regions.glsl"
#include "scene_functions.glsl"
#include "sphere_tracing.glsl"
#include "shadow.glsl"
#include "light.glsl"
#include "picture_block.glsl"
#include "path_pass.glsl"
#include "path_state.glsl"
#include "path_random.glsl"
#include "path_lights.glsl"
#include "path_lobes.glsl"
#include "path_ray.glsl"
#include "path_guides.glsl"
#include "path_media.glsl"
#include "path_glass.glsl"
#include "path_swarm.glsl"
#include "path_direct.glsl"
#include "path_surface.glsl"

layout(location = 0) out vec4 state_origin;
layout(location = 1) out vec4 state_direction;
layout(location = 2) out vec4 state_throughput;
layout(location = 3) out vec4 state_sum;

// From this ray on, a path may end by chance.
const int CERTAIN_RAYS = 3;
// Paths are not stopped before this number of them, so that the estimate of the noise is not only luck.
const int PATHS_MIN = 16;
// Noise in darker light than this fraction of white is not visible.
const float DARKEST = 0.02;

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

// Adds the sky's light where a ray sees it. Ambient light is part of the light that media emit in the raster. Paths find it
// themselves, so the fraction `ambient` of it is subtracted.
void add_sky(inout Path path, vec3 fraction, vec3 ambient, vec3 direction, vec3 dx, vec3 dy, bool is_seen) {
    vec3 mean_ambient = vec3(0.0);
    for (int i = brightness_of(ambient) > 0.0 ? 0 : 6; i < 7; i++) {
        bool is_sky = i == 6;
        if (is_sky && !(max(fraction.r, max(fraction.g, fraction.b)) > 0.0)) break;
        vec3 axis = vec3(equal(ivec3(i >> 1), ivec3(0, 1, 2))) * ((i & 1) == 0 ? 1.0 : -1.0);
        vec3 light = light_of(sky_light(is_sky ? direction : axis, dx, dy, is_sky && is_seen));
        if (is_sky) {
            add(path, fraction * light);
        } else {
            mean_ambient += light * (1.0 / 6.0);
        }
    }
    vec3 doubled = ambient * mean_ambient;
    path.sum -= doubled;
    path.found -= brightness_of(doubled);
}

// Follows the ray of a path, and draws the next one. Returns false at the end of the path.
bool follow(inout Path path) {
    int pairs = RAY_PAIRS + PAIRS * path.ray;
    float spread = camera_position.w;
    bool is_inside = begin_inside(path);
    // Walls of glass are thin, so rays in it start close to the surface.
    float start = path.ray > 0 && !is_inside ? 0.01 : 0.0;
    Hit hit = trace(path.origin, path.direction, start, spread * path.travelled, spread, true);
    BallsMet balls = meet_balls(path, hit, pairs);
    bool leaves = leaves_glass(hit, is_inside, balls.is_ball);
    float at_surface = hit.met ? hit.t : NEVER;
    Meeting met = meet_media(path, at_surface, is_inside);
    bool is_scattered = met.t < at_surface;
    if (path.density > 0.0) add(path, path.throughput * lights_met(path, met.t, is_scattered));

    bool goes_on = hit.met || is_scattered;
    float reached = path.travelled + (goes_on ? met.t : 1.0);
    RayEnd end = RayEnd(hit, met.t, is_inside, leaves, ray_dx(reached), ray_dy(reached));
    vec3 ray = path.direction;
    bool is_seen = path.density == BY_EYE;
    vec3 ambient = path.throughput * met.ambient;
    vec3 sky_fraction = is_scattered ? vec3(0.0) : path.throughput;
    if (goes_on) {
        path.travelled = reached;
        vec3 p = path.origin + met.t * ray;
        vec2 survival = random_pair(pairs + SURVIVAL_PAIR);
        vec2 choice = random_pair(pairs + CHOICE_PAIR);
        vec2 random = random_pair(pairs + LOBE_PAIR);
        Vertex at;
        Parting parting;
        if (is_scattered) {
            at.origin = p;
            at.lobes.direction = ray;
            at.lobed = 1.0;
            at.is_medium = true;
            at.kept = met.kept;
            at.phase = met.phase;
        } else {
            vec4 plane = plane_of(hit.plane);
            if (hit.plane != NOTHING) p -= plane.xyz * (dot(plane.xyz, p) + plane.w);
            Surface s;
#ifdef SWARM
            if (balls.is_ball) {
                s = ball_surface(balls, p, ray);
            } else
#endif
            s = surface_at_end(path, end, p, spread * reached);
            s.material = within_ranges(s.material);
            turn_inside(s, end);
            sky_fraction = path.throughput * s.material.haze;
            at = vertex_on_surface(path, end, s, p, random, parting);
            add(path, path.throughput * s.material.emission);
        }
        if (!is_guiding) {
            vec2 towards = random_pair(pairs + LIGHT_PAIR);
            add(path, path.throughput * light_sampled(at, spread * reached, choice.x, towards));
        }
        bool is_image = false;
        bool goes_inside = is_inside && !leaves;
        if (!is_scattered) {
            vec3 ways = ways_of(parting, at);
            if (is_guiding) guide_at(parting, at.lobes.material, reached, ways);
            is_image = survival.x < ways.x + ways.y;
            if (is_image) {
                bool is_reflected = survival.x < ways.x;
                go_into_image(path, parting, ways, is_reflected);
                goes_inside = is_reflected ? is_inside : !leaves;
            } else {
                path.throughput = parting.kept * (parting.scattered * at.lobed / max(ways.z, 1e-6));
            }
        }
        if (!is_image) scatter(path, at, choice.y, random);
        if (goes_inside) path.density = INSIDE - path.density;
        float most = max(path.throughput.r, max(path.throughput.g, path.throughput.b));
        float survives = path.ray < CERTAIN_RAYS || is_guiding ? 1.0 : min(most, 0.95);
        goes_on = most > 0.0 && most < 1e12 && survival.y < survives && path.ray + 1 < FINISHED;
        goes_on = goes_on && (is_image || !is_guiding) && !(is_scattered && met.is_last);
        path.throughput /= max(survives, 1e-6);
    } else {
        guide_sky(path);
    }
    guide_color += sky_fraction;
#ifdef NO_SKY
    if (path.ray == 0) sky_fraction = vec3(0.0);
#endif
    float scale = 1.0 / max(reached, 1e-6);
    add_sky(path, sky_fraction, ambient, ray, end.dx * scale, end.dy * scale, is_seen);
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
    begin_stream(path);
    path_place = gl_FragCoord.xy + path_corner + random_pair(PLACE_PAIR) - 0.5;
    vec3 eye_direction = eye_ray();
    if (path.ray == 0) begin(path);
    if (path.ray == 0 && path.number >= paths_most) path.ray = FINISHED;
    if (path.ray != FINISHED) {
        bool goes_on = eye_direction != vec3(0.0);
        for (int i = 0; goes_on && i < (is_guiding ? GUIDED_RAYS : 1); i++) {
            goes_on = follow(path);
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
