// One sample of the scene for each pixel: primary ray, light, and what mirrors show (LD?S*E, thesis 3.3).
// Writes linear light and, in a pixel's first sample, a key of the surfaces seen.

#include "frame_block.glsl"
#include "sample_place.glsl"
#include "counters.glsl"
#include "material.glsl"
#include "scene_inputs.glsl"
#include "footprint.glsl"
#include "normal.glsl"
#include "occlusion.glsl"
#include "regions.glsl"
#include "scene_functions.glsl"
#include "sphere_tracing.glsl"
#include "light.glsl"
#include "sample_light.glsl"

layout(location = 0) out vec4 sample_color;         // see sample_light.glsl; the key is a whole number below 2048
#ifdef COUNT_EVALUATIONS
layout(location = 1) out vec4 evaluations;          // primary, reflection, normal, shadow
layout(location = 2) out vec4 more_evaluations;     // occlusion, capped rays, clauses, lookups of cells
layout(location = 3) out vec4 more_clauses;         // of materials and light, 0, 0, 0
#endif

// Light from the surface at p towards the eye, without what it mirrors.
vec3 shade(Surface s, vec3 p, vec3 direction, float cone) {
    Material m = s.material;
    vec3 normal = s.normal;
    vec3 light = m.emission;
    // Left at its end: a renderer that never skips a branch would run a last round in vain.
    int last = min(int(frame_levels.z), LIGHTS_MAX) - 1;
    int i = 0;
    do {
        vec4 place = lights[2 * i];
        vec4 color = lights[2 * i + 1];
        bool sun = place.w > 1.5;
        vec3 to_light = sun ? -place.xyz : place.xyz - p;
        float distance2 = dot(to_light, to_light);
        to_light *= inversesqrt(max(distance2, 1e-12));
        float light_t = sun ? SUN_DISTANCE : sqrt(distance2);
        float widening = sun ? color.w : color.w / max(light_t, 1e-3);
        float facing = dot(normal, to_light);
        if (facing > 0.0) {
            float sharpness = clamp(1.0 / max(widening, 1e-4), SHARPNESS_MIN, SHARPNESS_MAX);
            float visible = light_visibility(p, normal, to_light, light_t, sharpness, cone);
            if (visible > 0.0) {
                vec3 incoming = color.rgb * (sun ? visible : visible / max(distance2, 1e-4));
                light += incoming * thrown_back(m, normal, to_light, direction, facing, widening);
            }
        }
    } while (i++ < last);
    return light + m.color * light_of(s.ambient) * s.open;
}

// A number for the surfaces of a path: where neighbours differ in it, an edge of the geometry lies between them.
float surface_key = 0.0;
// A prime: keys stay whole and below 2048, which 16-bit floats hold exactly.
const float KEYS = 1021.0;

void add_to_key(int object, bool flat_surface, vec3 normal) {
    vec3 cell = floor(normal * 1.49 + 1.5);
    float facing = flat_surface ? 0.0 : cell.x + 3.0 * cell.y + 9.0 * cell.z;
    surface_key = mod(surface_key * 29.0 + 27.0 * float(object + 1) + facing, KEYS);
}

// The most surfaces that a path meets: a mirror and what it shows.
const int SURFACES_MAX = 2;

// Light along a ray from the eye. One loop over the surfaces of the path, so that a driver compiles tracing and
// shading once.
vec3 scene_color(vec3 origin, vec3 direction) {
    float spread = camera_position.w;
    float travelled = 0.0;
    float throughput = 1.0;
    vec3 color = vec3(0.0);
    for (int surface = 0; surface < SURFACES_MAX; surface++) {
        float cone = spread * travelled;
        Hit hit = trace(origin, direction, 0.01 * float(surface), cone, spread, surface > 0);
        // How the point moves for the pixel to the right and the one above, before the surface cuts the rays.
        float reached = travelled + (hit.met ? hit.t : 1.0);
        vec3 dx = camera_right.xyz * (2.0 * viewport.z * reached);
        vec3 dy = camera_up.xyz * (2.0 * viewport.w * reached);
        float sky_share = throughput;
        vec3 mirrored = direction;
        if (hit.met) {
            travelled = reached;
            cone = spread * travelled;
            vec3 p = origin + hit.t * direction;
            // Brought onto the plane exactly: no ray from there meets it again.
            vec4 plane = plane_of(hit.plane);
            if (hit.plane != NOTHING) p -= plane.xyz * (dot(plane.xyz, p) + plane.w);
            Surface s = scene_surface(p, hit.plane, direction, cone, dx, dy);
            s.material = within_ranges(s.material);
            Material m = s.material;
            add_to_key(s.object, hit.plane != NOTHING, s.normal);
            sky_share = throughput * m.haze;
            float kept = throughput * (1.0 - m.haze);
            // Schlick's approximation of Fresnel's reflectance.
            float grazing = pow(1.0 - clamp(-dot(direction, s.normal), 0.0, 1.0), 5.0);
            float reflectance = m.reflect > 0.0 ? m.reflect + (1.0 - m.reflect) * grazing : 0.0;
            if (kept > 0.004) color += kept * (1.0 - reflectance) * shade(s, p, direction, cone);
            throughput = kept * reflectance;
            origin = p + s.normal * (hit.plane != NOTHING ? 0.0 : max(0.002, cone));
            mirrored = direction - 2.0 * dot(direction, s.normal) * s.normal;
        }
        if (sky_share > 0.0) {
            // A camera inside an object has reached 0.
            float scale = 1.0 / max(reached, 1e-6);
            color += sky_share * light_of(sky_color(direction, dx * scale, dy * scale));
        }
        if (!hit.met || throughput < 0.004) return color;
        direction = mirrored;
    }
    return color;
}

void main() {
    load_frame();
    scene_load();
    vec2 place = 2.0 * sample_place() * viewport.zw - 1.0;
    vec3 direction = normalize(camera_forward.xyz + place.x * camera_right.xyz + place.y * camera_up.xyz);
    vec3 color = scene_color(camera_position.xyz, direction);
    sample_color = stored_sample(color, surface_key, pass_sample.z > 0.5);
#ifdef COUNT_EVALUATIONS
#ifndef CLAUSES_RUN
#define CLAUSES_RUN 0.0
#define SURFACE_CLAUSES_RUN 0.0
#endif
    evaluations = vec4(count_primary, count_reflection, count_normal, count_shadow);
    more_evaluations = vec4(count_occlusion, count_capped, CLAUSES_RUN, count_lookups);
    more_clauses = vec4(SURFACE_CLAUSES_RUN, 0.0, 0.0, 0.0);
#endif
}
