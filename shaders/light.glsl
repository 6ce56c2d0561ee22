// Lights: the light that arrives at a surface, and the part that it reflects.

const float PI = 3.14159265;
// LIGHT_LAMP, LIGHT_SUN and LIGHT_PANEL number the kinds of lights.
#if LIGHT_KINDS != 3
#error "`light_at` handles only lamps, suns and panels: add the new kind of light there"
#endif

struct Incoming {
    vec3 direction;     // towards the middle of the light
    vec3 mirrored;      // towards the part of the light nearest to the mirrored line of sight
    float t;            // distance of the light
    float widening;     // tangent of half the angle that the light fills
    vec3 light;         // on a surface perpendicular to the direction; for a panel, on the lit surface
    float shadow;       // fraction that shadows remove
    vec3 through;       // on a surface perpendicular to the direction, also behind the surface
};

// Light ends smoothly at its range (Karis, "Real shading in Unreal Engine 4", 2013).
float faded(float t, float range) {
    float fraction = range > 0.0 ? t / range : 0.0;
    float left = clamp(1.0 - fraction * fraction * fraction * fraction, 0.0, 1.0);
    return left * left;
}

#ifdef PANELS
#include "light_panel.glsl"
#endif

// Returns the light with the given number at p. `direction` is the ray's direction.
Incoming light_at(int number, vec3 p, vec3 normal, vec3 direction) {
    vec4 place = lights[4 * number];
    vec4 color = lights[4 * number + 1];
    float range = lights[4 * number + 2].w;
    float shadow = lights[4 * number + 3].w;
#ifdef PANELS
    if (place.w == LIGHT_PANEL) {
        return light_of_panel(place, color, lights[4 * number + 2], lights[4 * number + 3], p, normal, direction);
    }
#endif
    bool sun = place.w == LIGHT_SUN;
    vec3 way = sun ? -place.xyz : place.xyz - p;
    float distance2 = dot(way, way);
    Incoming incoming;
    incoming.direction = way * inversesqrt(max(distance2, 1e-12));
    incoming.t = sun ? SUN_DISTANCE : sqrt(distance2);
    incoming.widening = sun ? color.w : color.w / max(incoming.t, 1e-3);
    // Inside the ball the light is no brighter than at its surface.
    float falloff = sun ? 1.0 : faded(incoming.t, range) / max(distance2, max(color.w * color.w, 1e-4));
    incoming.light = color.rgb * (falloff * max(dot(normal, incoming.direction), 0.0));
    incoming.through = color.rgb * falloff;
    // The part of the ball that is nearest to the mirrored line of sight (Karis 2013).
    vec3 mirrored = reflect(direction, normal);
    vec3 off = dot(incoming.direction, mirrored) * mirrored - incoming.direction;
    float reach = clamp(incoming.widening * inversesqrt(max(dot(off, off), 1e-12)), 0.0, 1.0);
    incoming.mirrored = normalize(incoming.direction + off * reach);
    incoming.shadow = shadow;
    return incoming;
}

// GGX (Walter et al. 2007) with Smith's height-correlated masking (Heitz 2014, Hammon's approximation 2017) and
// Schlick's Fresnel term. `alpha` is the roughness squared, `f0` the reflectance at normal incidence. A light's width
// blurs its highlight (Karis 2013).
vec3 highlight(float alpha, float widening, vec3 f0, float facing, float seen, float nh, float grazing) {
    float wide = clamp(alpha + 0.5 * widening, alpha, 1.0);
    float fraction = alpha / wide;
    float a2 = alpha * alpha;
    float k = nh * nh * (a2 - 1.0) + 1.0;
    float spread = fraction * fraction * a2 / (PI * k * k);
    float masking = 0.5 / max(mix(2.0 * facing * seen, facing + seen, alpha), 1e-4);
    return (f0 + (1.0 - f0) * grazing) * (spread * masking);
}

#include "sheen.glsl"

// Minimum of alpha. A sharper highlight would be smaller than a pixel.
const float ALPHA_MIN = 0.02;

#ifdef PATHS
// Returns the fraction of light from all directions that the highlight of an insulator (`f0` 0.04) sends to an eye: a fit
// to the integral of `highlight` over the hemisphere, 0.0006 off on the average of a ball, and 0.03 at single angles.
// `seen` is the cosine between the normal and the way to the eye.
float highlight_part(float alpha, float seen) {
    float x2 = (1.0 - seen) * (1.0 - seen);
    float x4 = x2 * x2;
    return 0.0412 + 0.8001 * x4 + sqrt(alpha) * (alpha * (0.6999 * x4 - 0.0219) - 1.3908 * x4 - 0.007);
}

// Returns the part of the light that is not in the highlight.
float below_highlight(float alpha, float seen, float grazing) {
    return 1.0 - highlight_part(alpha, seen);
}
#else
float below_highlight(float alpha, float seen, float grazing) {
    return 0.96 - 0.96 * grazing;
}
#endif

// Returns the reflectance towards the eye, without mirror images. The diffuse part gets the light that is not in the
// highlight. Paths take exactly that, so that a white surface loses none; the raster takes what Fresnel's reflection leaves
// of this one light, which is within 3 % of it and needs fewer registers.
vec3 thrown_back(Material m, vec3 normal, Incoming incoming, vec3 direction) {
    float seen = max(dot(normal, -direction), 1e-3);
    float facing = max(dot(normal, incoming.mirrored), 1e-3);
    vec3 halfway = normalize(incoming.mirrored - direction);
    float nh = clamp(dot(normal, halfway), 0.0, 1.0);
    float grazing = pow(1.0 - clamp(dot(halfway, incoming.mirrored), 0.0, 1.0), 5.0);
    float alpha = clamp(m.roughness * m.roughness, ALPHA_MIN, 1.0);
    vec3 f0 = filmed(mix(vec3(0.04), m.color, m.metalness), m, dot(halfway, incoming.mirrored));
    vec3 diffuse = m.color * ((1.0 - m.metalness) * below_highlight(alpha, seen, grazing) / PI);
#ifdef TRANSLUCENT
    diffuse *= 1.0 - m.translucent;
#endif
    vec3 light = diffuse + highlight(alpha, incoming.widening, f0, facing, seen, nh, grazing);
    light += velvet(m, facing, seen, nh);
    if (m.coat > 0.0) {
        float fraction = m.coat * (0.04 + 0.96 * grazing);
        light = light * (1.0 - fraction)
              + m.coat * highlight(ALPHA_MIN, incoming.widening, vec3(0.04), facing, seen, nh, grazing);
    }
    return light;
}

// Returns the normal of a rough mirror's facet, by GGX (Walter et al. 2007).
vec3 facet(vec3 normal, float alpha, vec2 random) {
    float cosine = sqrt((1.0 - random.x) / (1.0 + (alpha * alpha - 1.0) * random.x));
    float sine = sqrt(max(1.0 - cosine * cosine, 0.0));
    vec3 side = normalize(abs(normal.y) < 0.9 ? vec3(normal.z, 0.0, -normal.x) : vec3(0.0, -normal.z, normal.y));
    float turn = 2.0 * PI * random.y;
    return normalize(normal * cosine + (side * cos(turn) + cross(normal, side) * sin(turn)) * sine);
}

// In a blend, mirrors with a lower reflectance at normal incidence also reflect less at grazing angles.
const float FAINT = 0.02;

// Returns the fraction of light that a surface mirrors: Schlick's approximation of Fresnel's reflectance. A rough mirror
// reflects less of it at grazing angles.
float mirrored_part(Material m, vec3 normal, vec3 direction) {
    float grazing = pow(1.0 - clamp(-dot(direction, normal), 0.0, 1.0), 5.0);
    float most = max(1.0 - m.blur, m.reflect);
#ifdef BLEND
    // Reduce grazing reflections of faint mirrors. Otherwise a fading mirror would leave bright rims.
    grazing *= min(m.reflect * (1.0 / FAINT), 1.0);
#endif
    return m.reflect > 0.0 ? m.reflect + (most - m.reflect) * grazing : 0.0;
}
