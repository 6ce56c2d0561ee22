// One sample of the scene for each pixel: primary ray, light, and the mirror's reflection (LD?S*E, thesis 3.3).
// Writes colour tone-mapped to 0..1, still linear.

#include "frame_block.glsl"
#include "speakers.glsl"
#include "sky.glsl"
#include "sphere_tracing.glsl"
#include "light.glsl"
#include "materials.glsl"
#include "tone_map.glsl"

layout(location = 0) out vec4 sample_color;
#ifdef COUNT_EVALUATIONS
layout(location = 1) out vec4 evaluations;          // primary, reflection, normal, shadow
layout(location = 2) out vec4 more_evaluations;     // occlusion, capped rays, 0, 0
#endif

const float HORIZON_DISTANCE = 38.0;

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
    vec3 ambient = mix(vec3(0.045, 0.115, 0.120), vec3(0.155, 0.165, 0.185), 0.5 + 0.5 * normal.y);
    ambient += vec3(0.10, 0.07, 0.05) * max(-normal.z, 0.0);
    light += m.albedo * ambient * open;
    return light;
}

Material material_of(int object, vec3 p, vec3 normal, Footprint print) {
    if (object == BAR) return bar_material(p);
    return speaker_material(p, normal, print);
}

// Colour of what the ray meets, other than the floor.
vec3 object_color(Hit hit, vec3 origin, vec3 direction, float cone, float travelled) {
    vec3 p = origin + hit.t * direction;
    vec3 normal = surface_normal(p, cone);
    Footprint print = pixel_footprint(direction, normal, travelled);
    return shade(material_of(hit.object, p, normal, print), p, normal, direction, cone);
}

vec3 scene_color(vec3 origin, vec3 direction) {
    float spread = camera_position.w;
    Hit hit = trace(origin, direction, 0.0, 0.0, spread, false);
    if (hit.object == SKY) return sky_color(direction);
    if (hit.object != FLOOR) return object_color(hit, origin, direction, spread * hit.t, hit.t);

    vec3 p = origin + hit.t * direction;
    p.y = FLOOR_HEIGHT;
    vec3 normal = vec3(0.0, 1.0, 0.0);
    Material m = floor_material();
    float haze = 1.0 - exp(-pow(length(p.xz - vec2(0.0, 10.0)) / HORIZON_DISTANCE, 2.0));
    vec3 bounced = vec3(direction.x, -direction.y, direction.z);
    vec3 far = sky_color(vec3(direction.x, 0.0, direction.z));
    if (haze > 0.995) return far;

    float cone = spread * hit.t;
    vec3 color = shade(m, p, normal, direction, cone);
    // Schlick's approximation of Fresnel's reflectance.
    float reflectance = m.mirror + (1.0 - m.mirror) * pow(1.0 - max(-direction.y, 0.0), 5.0);
    Hit mirrored = trace(p, bounced, 0.01, cone, spread, true);
    vec3 seen = mirrored.object == SKY || mirrored.object == FLOOR
        ? sky_color(bounced)
        : object_color(mirrored, p, bounced, cone + spread * mirrored.t, hit.t + mirrored.t);
    return mix(mix(color, seen, reflectance), far, haze);
}

void main() {
    vec2 pixel = gl_FragCoord.xy + sample_offset.xy;
    vec2 place = 2.0 * pixel * viewport.zw - 1.0;
    vec3 direction = normalize(camera_forward.xyz + place.x * camera_right.xyz + place.y * camera_up.xyz);
    vec3 color = scene_color(camera_position.xyz, direction);
    sample_color = vec4(tone_map(color), 1.0);
#ifdef COUNT_EVALUATIONS
    evaluations = vec4(count_primary, count_reflection, count_normal, count_shadow);
    more_evaluations = vec4(count_occlusion, count_capped, 0.0, 0.0);
#endif
}
