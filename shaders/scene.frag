// Computes one sample of the scene for each pixel: primary ray, light, and mirror images (LD?S*E, Abt 2022, section
// 3.3). Writes linear light and, in a pixel's first sample, a key of the surfaces on the path.

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
#include "sample_light.glsl"
#include "pixel_key.glsl"
#if defined(MEDIA) && !defined(VIEWS)
#define DRAWS_MEDIA
#include "media.glsl"
#endif
#if defined(SWARM) && !defined(VIEWS)
#define DRAWS_SWARM
#include "swarm.glsl"
#endif
#ifdef VIEWS
#include "view.glsl"
#endif

layout(location = 0) out vec4 sample_color;         // see sample_light.glsl; the key is a whole number below 2048
#if defined(COUNT_EVALUATIONS) && !defined(VIEWS)
layout(location = 1) out vec4 evaluations;          // primary, reflection, normal, shadow
layout(location = 2) out vec4 more_evaluations;     // occlusion, capped rays, clauses, lookups of cells
layout(location = 3) out vec4 more_clauses;         // of materials and light; evaluations of media, steps through media, 0
#endif

#if defined(LENS) && !defined(COUNT_EVALUATIONS)
layout(location = 1) out float sample_spread;       // radius of the point's disc in pixels

// Returns the blur of a thin lens: a point at distance z becomes a disc of radius * |1/sharp - 1/z| at distance 1; the
// result is negative in front of the sharp distance.
float spread_at(float nearness) {
    float limit = picture_lens.z * viewport.y;
    return clamp(picture_lens.x * (picture_lens.y - nearness) / (2.0 * camera_position.w), -limit, limit);
}
#endif
#if (defined(BEAMS) || defined(MEDIA)) && !defined(VIEWS)
// The free distance of the pixel's beam or, in the pass of media, the distance at which the ray ends. It must be the last output (crates/render/src/gpu/renderer.rs).
#if defined(COUNT_EVALUATIONS)
layout(location = 4) out float sample_beam;
#elif defined(LENS)
layout(location = 2) out float sample_beam;
#else
layout(location = 1) out float sample_beam;
#endif
#endif
// 1 / distance of the first surface, measured along the camera's axis.
float seen_nearness = 0.0;

#ifdef DRAWS_SWARM
// Light of thin balls that is weaker than this has no shadows.
const float THIN_SHADOWED_MIN = 0.001;

// Thin balls in front of the end of a ray.
struct ThinBalls {
    vec3 color;     // 0 if they need no light
    vec3 fraction;  // of their light that reaches the eye
    float before;   // their distance from the end of the ray
};
#endif

// All lights together whose shadows are left out are weaker than this part of a surface's other light, plus this light as
// shown. In 27 scenes at most 0.006 % of the pixels changed by more than 4 of 255.
const float SHADOWED_PART = 0.02;
const float SHADOWED_SHOWN = 0.002;

// Light from the surface at p towards the eye, without mirror images.
#ifdef DRAWS_SWARM
// The light is multiplied by `fraction`. Adds the light of thin balls, for which further shadow rays run.
vec3 shade(Surface s, vec3 p, vec3 direction, float cone, vec3 fraction, ThinBalls thin) {
#else
vec3 shade(Surface s, vec3 p, vec3 direction, float cone) {
#endif
    Material m = s.material;
    // Add the light without shadows first: while a shadow ray runs, all values that are used later occupy registers.
#ifdef SHEEN
    float edge = 1.0 - clamp(-dot(direction, s.normal), 0.0, 1.0);
    vec3 coloured = m.color * mix(vec3(1.0), film_color(m.film, 1.0 - edge), m.metalness);
    vec3 around = light_of(s.ambient) * s.open + s.glow;
    vec3 light = m.emission + (coloured + velvet_color(m) * (edge * edge * edge)) * around;
#else
    vec3 light = m.emission + m.color * (light_of(s.ambient) * s.open + s.glow);
#endif
#ifdef BOUNCE
    // The blockers that the probes of occlusion meet count as surfaces of the same colour, half turned to the light.
    vec3 thrown_on = m.color * m.color * ((1.0 - m.metalness) * (1.0 - s.open) * nearby_bounce);
    light += thrown_on * light_of(s.ambient) * s.open;
#endif
    // The loop tests its condition at the end. With a test at the start, a renderer that never skips a branch would run
    // one more round in vain.
    int last = min(int(frame_clock.y), LIGHTS_MAX) - 1;
    int i = 0;
#ifdef DRAWS_SWARM
    light *= fraction;
    int count = last + 1;
    if (thin.color != vec3(0.0)) last += count;
    // A surface that sends no light needs no shadow rays.
    if (fraction == vec3(0.0)) i = count;
#endif
    do {
#ifdef DRAWS_SWARM
        if (i == count) {
            p -= thin.before * direction;
            s = thin_surface(thin.color, p, direction);
            m = s.material;
            fraction = thin.fraction;
            light += fraction * m.color * light_of(s.ambient);
#ifdef BOUNCE
            thrown_on = vec3(0.0);
#endif
        }
        int number = i < count ? i : i - count;
#else
        int number = i;
#endif
        // frame_reach.z is 0. Without this term, compilers move expressions that are the same for all lights before the
        // loop, and the results occupy registers during the shadow rays.
        vec3 view_direction = direction + frame_reach.z * float(i);
        Incoming incoming = light_at(number, p, s.normal, view_direction);
        // Light that comes through the body or from nearby surfaces, and the start of the ray to the light: at the surface,
        // or for lights behind it where their light arrives.
        vec3 through = vec3(0.0);
        vec3 from = p;
        vec3 side = s.normal;
#ifdef LIGHT_THROUGH
        bool is_behind = dot(s.normal, incoming.direction) < 0.0;
#endif
#ifdef BOUNCE
        through += incoming.through * thrown_on * (0.5 / PI);
        if (is_behind) from += (0.5 * frame_reach.x) * s.normal;
#endif
#ifdef TRANSLUCENT
        // Light that comes out of the body has no direction any more, so half of it comes out on this side.
        through += incoming.through * m.color * (0.5 * m.translucent / PI);
        shadow_dims = m.translucent > 0.0 ? 1.0 / max(m.depth, 1e-3) : 0.0;
        if (is_behind && m.translucent > 0.0) {
            from = p;
            side = -s.normal;
        }
#endif
        vec3 arriving = incoming.light + through;
        if (max(arriving.r, max(arriving.g, arriving.b)) > 1e-5) {
            float sharpness = clamp(1.0 / max(incoming.widening, 1e-4), SHARPNESS_MIN, SHARPNESS_MAX);
            vec3 thrown = incoming.light * thrown_back(m, s.normal, incoming, view_direction) + through;
            float least = (SHADOWED_PART * max(light.r, max(light.g, light.b)) + SHADOWED_SHOWN / picture_look.x) / float(last + 1);
#ifdef DRAWS_SWARM
            thrown *= fraction;
            if (i >= count) least = max(least, THIN_SHADOWED_MIN);
#endif
            // A light without shadows, or too weak for its shadow to be seen, needs no shadow ray.
            bool has_shadow = incoming.shadow > 0.0 && max(thrown.r, max(thrown.g, thrown.b)) >= least;
            float t = has_shadow ? incoming.t : 0.0;
            float visible = light_visibility(from, side, incoming.direction, t, sharpness, cone);
            visible = mix(1.0, visible, incoming.shadow);
            NOTE_LIGHT(incoming.light, visible);
            if (visible > 0.0) light += visible * thrown;
        }
    } while (i++ < last);
#ifdef TRANSLUCENT
    shadow_dims = 0.0;
#endif
    return light;
}

float surface_key = 0.0;
float seen_rough = 0.0;

#ifdef DRAWS_SWARM
// A pixel is marked if thin balls and glow change its light by more than this part. The limit is lower on rough mirrors:
// there edges.frag takes a low contrast for noise.
const float FAINT_PART = 0.3;
const float ROUGH_FAINT_PART = 0.08;
// The light of faint points of swarms that changes from pixel to pixel, and what these points leave of other light.
float seen_sharp = 0.0;
float seen_left = 1.0;
#endif

void add_to_key(int object, bool flat_surface, vec3 normal) {
    vec3 cell = floor(normal * 1.49 + 1.5);
    float facing = flat_surface ? 0.0 : cell.x + 3.0 * cell.y + 9.0 * cell.z;
    surface_key = mod(surface_key * 29.0 + 27.0 * float(object + 1) + facing, KEYS);
}

// Maximum number of surfaces on a path. Without glass: four mirrors, and the surface in the last mirror. With glass: two
// hollow bodies with two walls each, the surface behind them, and SURFACES_KEPT for the waiting ray.
#if defined(GLASS) && !defined(COVERAGE)
const int SURFACES_MAX = 12;
const int SURFACES_KEPT = 3;
#elif defined(MIRRORS) && !defined(COVERAGE)
const int SURFACES_MAX = 5;
#else
const int SURFACES_MAX = 1;
#endif
// A path ends if less than this fraction of its light would reach the eye; at the lowest quality, FRACTION_MIN_LEAST.
const float FRACTION_MIN = 0.004;
const float FRACTION_MIN_LEAST = 0.06;

#ifdef BLUR
// Two numbers in 0..1 for a surface of the path. A pixel's numbers come from a hash (pcg3d, Jarzynski and Olano 2020)
// and are the same in each frame. The pixel's further samples follow the R2 sequence (Roberts 2018).
vec2 scatter(int surface) {
    uvec3 v = uvec3(uvec2(sample_place()), uint(surface)) * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> 16u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    return fract(vec2(v.xy >> 8u) / 16777216.0 + sample_number() * vec2(0.7548777, 0.5698403));
}
#endif

#ifdef DRAWS_MEDIA
// Results of the pass of media: the distance at which the ray ends, with the fraction that is left of mirrored light in
// the last bits, and the fraction that is left of the light behind the medium.
float medium_ray = 0.0;
float medium_left = 1.0;
#endif

// Returns the light along a ray from the eye. There is a single loop over the path's surfaces, so that a driver
// compiles tracing and shading once.
vec3 scene_color(vec3 origin, vec3 direction) {
    float spread = camera_position.w;
    float fraction_min = mix(FRACTION_MIN_LEAST, FRACTION_MIN, frame_quality);
    float travelled = 0.0;
    // Growth of the ray's width per unit of length after a rough mirror.
    float blurred = 0.0;
    vec3 throughput = vec3(1.0);
    vec3 color = vec3(0.0);
#ifdef DRAWS_MEDIA
    SeenMedium medium = SeenMedium(vec3(0.0), 1.0, 1.0, FAR);
    // Media are drawn on the ray of the eye and, after mirrors and glass, on the next ray through air.
    const int SEGMENTS_MAX = 2;
#ifdef GLASS
    int air_segment = 0;
#endif
#endif
#ifdef DRAWS_SWARM
#ifdef SWARM_TILES
    int swarm_tiles = SWARM_TILES_OF_EYE;
#else
    const int swarm_tiles = 0;
#endif
#endif
    for (int surface = 0; surface < SURFACES_MAX; surface++) {
        float cone = spread * travelled;
#ifdef GLASS
        // Walls of glass are thin, so rays start close to the surface.
        float start = ray_side > 0.0 ? 0.01 * float(min(surface, 1)) : 0.0;
#else
        float start = 0.01 * float(surface);
#endif
        Hit hit = trace(origin, direction, start, cone, spread, surface > 0);
#ifdef DRAWS_MEDIA
        float end = hit.met ? hit.t : FAR;
#ifdef GLASS
        // There is no medium in glass.
        int segment = ray_side > 0.0 ? air_segment++ : SEGMENTS_MAX;
#else
        int segment = surface;
#endif
        if (segment >= SEGMENTS_MAX) {
        } else if (is_medium_pass()) {
            vec4 along = medium_along(origin, direction, end, cone, medium_pattern());
            color += throughput * along.rgb;
            throughput *= along.a;
            if (segment == 0) {
                medium.left = along.a;
                medium.end = end;
            } else {
                medium.left_of_mirrored = along.a;
            }
        } else if (segment == 0) {
            medium = medium_seen(sample_place(), end);
        } else {
            throughput *= medium.left_of_mirrored;
        }
#endif
#ifdef DRAWS_SWARM
        SwarmSeen seen = swarm_along(origin, direction, hit.met ? hit.t : FAR, travelled, swarm_tiles);
        bool is_ball = seen.ball > 0;
        ThinBalls thin = ThinBalls(seen.thin_color, throughput * (1.0 - seen.left), 0.0);
        // The fractions of light from the swarm that media leave, divided by the fraction for the whole ray, by which all
        // light is multiplied in the end. The medium counts as uniform.
        float light_left = 1.0;
        float ball_left = 1.0;
#ifdef DRAWS_MEDIA
        if (surface == 0 && !is_medium_pass()) {
            float way = min(end, MEDIUM_FAR);
            medium.left = max(medium.left, MEDIUM_LEFT_MIN);
            vec3 places = min(vec3(seen.light_t, seen.t, seen.thin_t) / way, 1.0);
            vec3 left = pow(vec3(medium.left), places - 1.0);
            light_left = left.x;
            if (is_ball) ball_left = left.y;
            // Balls hide the light of the medium behind them.
            float hidden = seen.left * (ball_left - 1.0);
            if (thin.color != vec3(0.0)) {
                hidden += (1.0 - seen.left) * (left.z - 1.0);
                thin.fraction *= left.z;
            }
            color -= throughput * medium.light * (hidden / max(1.0 - medium.left, 1e-4));
        }
#endif
#ifdef COVERAGE
        color = vec3(1.0 - seen.left);
        thin.color = vec3(0.0);
#else
        color += throughput * light_left * seen.light;
        if (blurred == 0.0) {
            seen_sharp += max(throughput.r, max(throughput.g, throughput.b)) * light_left * seen.sharp;
            seen_left = min(seen_left, seen.left);
        }
#endif
        if (max(thin.fraction.r, max(thin.fraction.g, thin.fraction.b)) < fraction_min) thin.color = vec3(0.0);
        throughput *= seen.left;
        if (is_ball) hit = Hit(seen.t, NOTHING, true);
        bool is_thin = thin.color != vec3(0.0);
        thin.before = hit.met ? hit.t - seen.thin_t : 0.0;
        // Behind thin balls may be the sky.
        bool is_shaded = hit.met || is_thin;
#else
        const bool is_ball = false;
        const float ball_left = 1.0;
        bool is_shaded = hit.met;
#endif
        // The offsets from the ray's end to the rays of the pixels to the right and above, not yet projected onto the
        // surface.
        float reached = travelled + (hit.met ? hit.t : 1.0);
        float wide = reached * (1.0 + blurred / spread);
        vec3 dx = ray_dx(wide);
        vec3 dy = ray_dy(wide);
        vec3 sky_fraction = throughput;
        vec3 mirrored = direction;
        if (is_shaded) {
            travelled = reached;
            if (surface == 0 && hit.met) seen_nearness = 1.0 / max(axial(hit.t, direction), 1e-6);
            cone = spread * reached;
#ifdef DRAWS_SWARM
            vec3 p = origin + (hit.met ? hit.t : seen.thin_t) * direction;
#else
            vec3 p = origin + hit.t * direction;
#endif
            // Move the point exactly onto the plane, so that no ray from there hits it again.
            vec4 plane = plane_of(hit.plane);
            if (hit.plane != NOTHING) p -= plane.xyz * (dot(plane.xyz, p) + plane.w);
#ifdef GLASS
            bool is_inside = ray_side < 0.0;
            bool leaves = is_inside && !met_in_glass && hit.plane == NOTHING && !is_ball;
            surface_penumbra = is_inside && !leaves ? WITHOUT_GLASS : 0.0;
#endif
            Surface s;
#ifdef DRAWS_SWARM
            if (is_ball) {
                s = swarm_surface(seen.ball, p, direction);
            } else
#endif
            s = scene_surface(p, hit.plane, direction, cone, dx, dy);
            s.material = within_ranges(s.material);
            NOTE_SURFACE(s, hit.t, p);
#ifdef GLASS
            if (is_inside) throughput *= exp(-glass_absorbs * hit.t);
            if (hit.plane != NOTHING) s.material.glass = 0.0;
            if (leaves) {
                s.normal = -s.normal;
                s.material.glass = 1.0;
                s.material.haze = 0.0;
                ray_side = 1.0;
            }
#endif
            Material m = s.material;
#ifdef DRAWS_SWARM
            if (!hit.met) m.haze = 1.0;
            if (hit.met)
#endif
            add_to_key(s.object, hit.plane != NOTHING, s.normal);
            sky_fraction = throughput * m.haze;
#ifdef COVERAGE
            color = vec3(1.0 - m.haze);
#else
            vec3 kept = throughput * (1.0 - m.haze);
            float reflectance = mirrored_part(m, s.normal, direction);
            bool is_lit = !is_medium_pass() && max(kept.r, max(kept.g, kept.b)) > fraction_min;
#ifdef GLASS
            s.material.color *= 1.0 - m.glass;
            is_lit = is_lit && !leaves;
#endif
#ifdef DRAWS_SWARM
            vec3 fraction = is_lit ? kept * ((1.0 - reflectance) * ball_left) : vec3(0.0);
            if (is_lit || is_thin) color += shade(s, p, direction, cone, fraction, thin);
#else
            if (is_lit) color += kept * (1.0 - reflectance) * ball_left * shade(s, p, direction, cone);
#endif
            // Metals tint their mirror images.
            vec3 tint = mix(vec3(1.0), m.color, m.metalness);
#ifdef SHEEN
            tint *= film_color(m.film, -dot(direction, s.normal));
#endif
            throughput = kept * reflectance * tint;
            float off = hit.plane != NOTHING ? 0.0 : max(0.002, cone);
#if defined(DRAWS_SWARM) && defined(SWARM_TILES)
            // The plane mirrors the whole picture, but a rough mirror or a ray close to the plane changes the direction.
            bool is_flat = surface == 0 && dot(direction, s.normal) < -0.02;
            swarm_tiles = is_flat ? swarm_tiles_of(hit.plane) : 0;
#endif
            origin = p + s.normal * off;
            vec3 mirror = s.normal;
#ifdef BLUR
            float alpha = m.blur * m.blur;
            if (alpha > 1e-4) {
#if defined(DRAWS_SWARM) && defined(SWARM_TILES)
                swarm_tiles = 0;
#endif
                mirror = facet(s.normal, alpha, scatter(surface));
                seen_rough = ROUGH_KEY;
                blurred += 0.5 * alpha;
            }
#endif
            mirrored = reflect(direction, mirror);
            // Keep the mirrored ray from entering the surface.
            mirrored = normalize(mirrored + s.normal * max(0.02 - dot(mirrored, s.normal), 0.0));
#ifdef GLASS
            if (m.glass > 0.0) {
                float ratio = leaves ? m.ior : 1.0 / m.ior;
                float of_glass = glass_reflectance(ratio, clamp(-dot(direction, mirror), 0.0, 1.0));
                vec3 mirrored_light = kept * max(reflectance, m.glass * of_glass) * tint;
                if (of_glass < 1.0) {
                    throughput = kept * m.glass;
                    // A path has one waiting ray. Later reflections follow the bent ray.
                    bool waits = !leaves && !is_medium_pass() && waiting.throughput == vec3(0.0);
                    if (waits && max(mirrored_light.r, max(mirrored_light.g, mirrored_light.b)) > fraction_min) {
                        waiting = WaitingRay(origin, mirrored, mirrored_light, travelled);
                        throughput *= 1.0 - of_glass;
                    }
                    origin = p - s.normal * off;
                    mirrored = refract(direction, mirror, ratio);
                    // Keep the ray from leaving the body's surface on the wrong side.
                    mirrored = normalize(mirrored - s.normal * max(0.02 + dot(mirrored, s.normal), 0.0));
                    if (!leaves) {
                        ray_side = -1.0;
                        glass_absorbs = m.absorb;
                    }
                } else {
                    throughput = leaves ? kept : mirrored_light;
                    ray_side = leaves ? -1.0 : 1.0;
                }
                // Behind the last surface is the sky.
                if (surface == SURFACES_MAX - 1) sky_fraction += throughput;
            }
#endif
#endif
        }
#ifdef NO_SKY
        // Only the background is transparent: mirrors still show the sky.
        if (surface == 0) sky_fraction = vec3(0.0);
#endif
        if (is_medium_pass()) sky_fraction = vec3(0.0);
        if (max(sky_fraction.r, max(sky_fraction.g, sky_fraction.b)) > 0.0) {
            // `reached` is 0 if the camera is inside an object.
            float scale = 1.0 / max(reached, 1e-6);
            color += sky_fraction * light_of(sky_color(direction, dx * scale, dy * scale));
        }
#ifdef DRAWS_MEDIA
        if (is_medium_pass() && segment == SEGMENTS_MAX - 1) break;
#endif
        bool ends = !hit.met || max(throughput.r, max(throughput.g, throughput.b)) < fraction_min;
#if defined(GLASS) && !defined(COVERAGE)
        // Keep some surfaces for the waiting ray.
        bool is_waiting = waiting.throughput != vec3(0.0);
        if (is_waiting && (ends || surface == SURFACES_MAX - SURFACES_KEPT)) {
            origin = waiting.origin;
            mirrored = waiting.direction;
            throughput = waiting.throughput;
            travelled = waiting.travelled;
            waiting.throughput = vec3(0.0);
            ray_side = 1.0;
            ends = false;
#ifdef DRAWS_MEDIA
            air_segment = SEGMENTS_MAX;
#endif
        }
#endif
        if (ends) break;
        direction = mirrored;
    }
#ifdef DRAWS_MEDIA
    if (is_medium_pass()) {
        medium_ray = packed_end(medium);
        medium_left = medium.left;
    } else {
#ifdef COVERAGE
        color = 1.0 - medium.left * (1.0 - color);
#else
        color = medium.left * color + medium.light;
#endif
    }
#endif
    return color;
}

void main() {
    load_frame();
    scene_load();
    vec3 direction = eye_ray();
#ifdef BEAMS
    beam_spread = pass_list.z * camera_position.w;
    uint start = sample_start();
#ifdef PROJECTED
    // The rays of an eye start at different points, so that a beam does not contain them.
    if (frame_projection.z > 0.0) start = 0u;
#endif
    ray_start = uintBitsToFloat(start & ~STEPS_BITS);
    ray_steps = int(start & STEPS_BITS);
#endif
#ifdef PROJECTED
    // Around a dome's circle is black.
    bool is_seen = direction != vec3(0.0);
    vec3 color = vec3(0.0);
    if (is_seen) color = scene_color(ray_origin, direction);
#else
    const bool is_seen = true;
    vec3 color = scene_color(ray_origin, direction);
#endif
#ifdef VIEWS
    sample_color = vec4(is_seen ? light_of(view_color(direction)) : vec3(0.0), 1.0);
#else
    float key = surface_key + seen_rough;
#ifdef DRAWS_SWARM
    float brightest = max(color.r, max(color.g, color.b));
    float faint_part = max(1.0 - seen_left, seen_sharp / max(brightest, 1e-6));
    bool is_faint = faint_part > (seen_rough > 0.0 ? ROUGH_FAINT_PART : FAINT_PART);
    key = is_faint ? faint_key(key) : key;
#endif
    sample_color = stored_sample(color, key, pass_sample.z > 0.5);
#ifdef DRAWS_MEDIA
    sample_beam = medium_ray;
    if (is_medium_pass()) sample_color = vec4(storable(color), medium_left);
#endif
#ifdef BEAMS
    // The last bits hold the number of steps.
    if (!is_medium_pass()) sample_beam = uintBitsToFloat((floatBitsToUint(beam_free) & ~STEPS_BITS) | uint(min(beam_steps, int(STEPS_BITS))));
#endif
#endif
#if defined(LENS) && !defined(COUNT_EVALUATIONS)
    sample_spread = spread_at(seen_nearness);
#endif
#if defined(COUNT_EVALUATIONS) && !defined(VIEWS)
#ifndef CLAUSES_RUN
#define CLAUSES_RUN 0.0
#define SURFACE_CLAUSES_RUN 0.0
#endif
    evaluations = vec4(count_primary, count_reflection, count_normal, count_shadow);
    more_evaluations = vec4(count_occlusion, count_capped, CLAUSES_RUN, count_lookups);
    more_clauses = vec4(SURFACE_CLAUSES_RUN, count_medium, count_medium_steps, count_swarm);
#endif
}
