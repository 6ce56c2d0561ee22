// One sample of the scene for each pixel: primary ray, light, and the mirror's reflection (LD?S*E, thesis 3.3).
// Writes colour tone-mapped to 0..1, still linear, and in alpha a key of the surfaces seen.

#include "frame_block.glsl"
#include "speakers.glsl"
#include "sky.glsl"
#include "sphere_tracing.glsl"
#include "light.glsl"
#include "materials.glsl"
#include "tone_map.glsl"

layout(location = 0) out vec4 sample_color;         // alpha: a whole number below 2048
#ifdef COUNT_EVALUATIONS
layout(location = 1) out vec4 evaluations;          // primary, reflection, normal, shadow
layout(location = 2) out vec4 more_evaluations;     // occlusion, capped rays, 0, 0
#endif

const float HORIZON_DISTANCE = 55.0;

Footprint pixel_footprint(vec3 direction, vec3 normal, float distance) {
    float along = dot(direction, normal);
    along = abs(along) < 0.05 ? (along < 0.0 ? -0.05 : 0.05) : along;
    vec3 dx = camera_right.xyz * (2.0 * viewport.z * distance);
    vec3 dy = camera_up.xyz * (2.0 * viewport.w * distance);
    return Footprint(dx - direction * (dot(dx, normal) / along), dy - direction * (dot(dy, normal) / along));
}

// Light from the surface at p towards the eye, without what it mirrors.
vec3 shade(Material m, vec3 p, vec3 normal, vec3 direction, float cone) {
    vec3 to_lamp = LAMP_POSITION - p;
    float lamp_distance2 = dot(to_lamp, to_lamp);
    vec3 lamp = to_lamp * inversesqrt(lamp_distance2);
    float facing = dot(normal, lamp);
    vec3 light = m.emission;
    if (facing > 0.0) {
        float visible = lamp_visibility(p, normal, cone);
        if (visible > 0.0) {
            vec3 incoming = LAMP_COLOR * (visible * facing / lamp_distance2);
            vec3 halfway = normalize(lamp - direction);
            float highlight = m.gloss * (m.shine + 8.0) / 25.0 * pow(max(dot(normal, halfway), 0.0), m.shine);
            light += incoming * (m.albedo * 0.3183 + highlight * 0.04);
        }
    }
    float open = ambient_occlusion(p, normal);
    // From above the sky, from below what the teal floor throws back.
    vec3 ambient = mix(vec3(0.012, 0.050, 0.056), vec3(0.060, 0.075, 0.110), 0.5 + 0.5 * normal.y);
    ambient += vec3(0.045, 0.036, 0.034) * max(-normal.z, 0.0);
    light += m.albedo * ambient * open;
    return light;
}

// A number for the surfaces of a path: where neighbours differ in it, an edge of the geometry lies between them.
float surface_key = 0.0;

void add_to_key(int object, vec3 normal) {
    vec3 cell = floor(normal * 1.49 + 1.5);
    float facing = object == FLOOR ? 0.0 : cell.x + 3.0 * cell.y + 9.0 * cell.z;
    surface_key = surface_key * 4.0 + float(object) + 16.0 * facing;
}

// The most surfaces that a path meets: the mirror and what it shows.
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
        if (hit.object == SKY) return color + throughput * sky_color(direction);
        travelled += hit.t;
        cone = spread * travelled;
        vec3 p = origin + hit.t * direction;

        float reflectance = 0.0;
        vec3 normal = vec3(0.0, 1.0, 0.0);
        if (hit.object == FLOOR) {
            p.y = FLOOR_HEIGHT;
            // The floor fades into the horizon, far from the speakers and from the eye.
            vec2 from_speakers = p.xz - vec2(0.0, SPEAKER_CENTRE.z);
            vec2 from_eye = p.xz - camera_position.xz;
            float away = min(dot(from_speakers, from_speakers), dot(from_eye, from_eye));
            float haze = 1.0 - exp(-away / (HORIZON_DISTANCE * HORIZON_DISTANCE));
            color += throughput * haze * sky_color(vec3(direction.x, 0.0, direction.z));
            throughput *= 1.0 - haze;
            if (throughput < 0.004) return color;
            // Schlick's approximation of Fresnel's reflectance.
            reflectance = FLOOR_MIRROR + (1.0 - FLOOR_MIRROR) * pow(1.0 - max(-direction.y, 0.0), 5.0);
        } else {
            normal = surface_normal(p, cone);
        }
        add_to_key(hit.object, normal);
        Material m = material_at(hit.object, p, normal, pixel_footprint(direction, normal, travelled));
        color += throughput * (1.0 - reflectance) * shade(m, p, normal, direction, cone);
        throughput *= reflectance;
        if (throughput < 0.004) return color;
        origin = p;
        direction = vec3(direction.x, -direction.y, direction.z);
    }
    return color;
}

void main() {
    vec2 pixel = gl_FragCoord.xy + sample_offset.xy;
    float pass_kind = sample_offset.z;
    vec2 place = 2.0 * pixel * viewport.zw - 1.0;
    vec3 direction = normalize(camera_forward.xyz + place.x * camera_right.xyz + place.y * camera_up.xyz);
    vec3 color = scene_color(camera_position.xyz, direction);
    sample_color = vec4(tone_map(color), pass_kind > 0.5 ? 1.0 : surface_key);
#ifdef COUNT_EVALUATIONS
    evaluations = vec4(count_primary, count_reflection, count_normal, count_shadow);
    more_evaluations = vec4(count_occlusion, count_capped, 0.0, 0.0);
#endif
}
