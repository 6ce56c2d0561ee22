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
#include "glass.glsl"
#include "occlusion.glsl"
#include "regions.glsl"
#include "scene_functions.glsl"
#include "sphere_tracing.glsl"
#include "shadow.glsl"
#include "light.glsl"
#include "sample_light.glsl"
#include "pixel_key.glsl"
#include "eye_path.glsl"
#include "media_path.glsl"
#include "swarm_path.glsl"
#include "rough_mirror.glsl"
#include "glass_path.glsl"
#include "sample_outputs.glsl"
#ifdef VIEWS
#include "view.glsl"
#endif

void add_to_key(int object, bool flat_surface, vec3 normal) {
    vec3 cell = floor(normal * 1.49 + 1.5);
    float facing = flat_surface ? 0.0 : cell.x + 3.0 * cell.y + 9.0 * cell.z;
    surface_key = mod(surface_key * 29.0 + 27.0 * float(object + 1) + facing, KEYS);
}

// A path ends if less than this fraction of its light would reach the eye; at the lowest quality, FRACTION_MIN_LEAST.
const float FRACTION_MIN = 0.004;
const float FRACTION_MIN_LEAST = 0.06;

// The width of a pixel at the end of a ray: offsets to the rays of the pixels to the right and above, not yet projected
// onto the surface.
struct Footprint {
    vec3 dx;
    vec3 dy;
};

// Shades the surface that ends the ray, and turns the path into its mirrored or bent ray. Returns the fraction of the
// sky's light that is seen through the surface.
vec3 meet_surface(inout EyePath path, Hit hit, SwarmMet met, Footprint footprint, float fraction_min) {
    float cone = cone_of(path);
    vec3 p = path.origin + shaded_distance(hit, met) * path.direction;
    // Move the point exactly onto the plane, so that no ray from there hits it again.
    vec4 plane = plane_of(hit.plane);
    if (hit.plane != NOTHING) p -= plane.xyz * (dot(plane.xyz, p) + plane.w);
    bool leaves = leaves_glass(hit, met.is_ball);
    Surface s;
#ifdef DRAWS_SWARM
    if (met.is_ball) {
        s = swarm_surface(met.seen.ball, p, path.direction);
    } else
#endif
    s = scene_surface(p, hit.plane, path.direction, cone, footprint.dx, footprint.dy);
    s.material = within_ranges(s.material);
    NOTE_SURFACE(s, hit.t, p);
    see_through_glass(path, s, hit, leaves);
    Material m = s.material;
    if (hit.met) {
        add_to_key(s.object, hit.plane != NOTHING, s.normal);
    } else {
        m.haze = 1.0;
    }
    vec3 sky_fraction = path.throughput * m.haze;
#ifdef COVERAGE
    path.color = vec3(1.0 - m.haze);
#else
    vec3 kept = path.throughput * (1.0 - m.haze);
    float reflectance = mirrored_part(m, s.normal, path.direction);
    bool is_lit = !is_medium_pass() && most_of(kept) > fraction_min && !leaves;
    add_light(path, opaque_part(s), p, met, kept * (1.0 - reflectance), is_lit);

    vec3 came = path.direction;
    vec3 tint = mirror_color(m, s.normal, came);
    path.throughput = kept * reflectance * tint;
    mirror_swarm_tiles(path, s, hit);
    float off = hit.plane != NOTHING ? 0.0 : max(0.002, cone);
    path.origin = p + s.normal * off;
    vec3 facet = facet_of(s, path);
    // Keep the mirrored ray from entering the surface.
    vec3 mirrored = reflect(came, facet);
    path.direction = normalize(mirrored + s.normal * max(0.02 - dot(mirrored, s.normal), 0.0));
    bool is_bent = bend(path, Mirror(s, p, facet, off, kept, reflectance, tint), came, leaves, fraction_min);
    // Behind the last surface is the sky.
    if (is_bent && path.surface == SURFACES_MAX - 1) sky_fraction += path.throughput;
#endif
    return sky_fraction;
}

// Returns the light along a ray from the eye. There is a single loop over the path's surfaces, so that a driver
// compiles tracing and shading once.
vec3 scene_color(vec3 origin, vec3 direction) {
    float spread = camera_position.w;
    float fraction_min = mix(FRACTION_MIN_LEAST, FRACTION_MIN, frame_quality);
    EyePath path = EyePath(origin, direction, vec3(1.0), vec3(0.0), 0.0, 0.0, 0);
    for (path.surface = 0; path.surface < SURFACES_MAX; path.surface++) {
        bool is_first = path.surface == 0;
        Hit hit = trace(path.origin, path.direction, first_distance(path.surface), cone_of(path), spread, !is_first);
        meet_medium(path, hit.met ? hit.t : FAR);
        SwarmMet met = meet_swarm(path, hit, fraction_min);
        vec3 ray = path.direction;
        float reached = path.travelled + (hit.met ? hit.t : 1.0);
        float wide = reached * (1.0 + path.blurred / spread);
        Footprint footprint = Footprint(ray_dx(wide), ray_dy(wide));
        vec3 sky_fraction = path.throughput;
        if (is_shaded(hit, met)) {
            path.travelled = reached;
            if (is_first && hit.met) seen_nearness = 1.0 / max(axial(hit.t, ray), 1e-6);
            sky_fraction = meet_surface(path, hit, met, footprint, fraction_min);
        }
#ifdef NO_SKY
        // Only the background is transparent: mirrors still show the sky.
        if (is_first) sky_fraction = vec3(0.0);
#endif
        if (!is_medium_pass() && most_of(sky_fraction) > 0.0) {
            // `reached` is 0 if the camera is inside an object.
            float scale = 1.0 / max(reached, 1e-6);
            path.color += sky_fraction * light_of(sky_color(ray, footprint.dx * scale, footprint.dy * scale));
        }
        if (medium_is_known()) break;
        bool ends = !hit.met || most_of(path.throughput) < fraction_min;
        resume_waiting(path, ends);
        if (ends) break;
    }
    return seen_through_medium(path.color);
}

void main() {
    load_frame();
    scene_load();
    vec3 direction = eye_ray();
    begin_beam();
    bool is_seen = IS_SEEN(direction);
    vec3 color = vec3(0.0);
    if (is_seen) color = scene_color(ray_origin, direction);
#ifdef VIEWS
    sample_color = vec4(is_seen ? light_of(view_color(direction)) : vec3(0.0), 1.0);
#else
    if (is_medium_pass()) {
        sample_color = vec4(storable(color), MEDIUM_LEFT);
        WRITE_BEAM(is_seen ? MEDIUM_RAY : 0.0)
    } else {
        sample_color = stored_sample(color, marked_key(surface_key + seen_rough, color), pass_sample.z > 0.5);
        WRITE_BEAM(packed_beam())
    }
    write_extras(seen_nearness);
#endif
}
