// Lights: the light that arrives at a surface, and the part that it reflects.

const float PI = 3.14159265;
// LIGHT_LAMP, LIGHT_SUN and LIGHT_PANEL number the kinds of lights.
#if LIGHT_KINDS != 3
#error "`light_at` handles only lamps, suns and panels: add the new kind of light there"
#endif

#if defined(TRANSLUCENT) || defined(BOUNCE)
#define LIGHT_THROUGH
#endif

struct Incoming {
    vec3 direction;     // towards the middle of the light
    vec3 mirrored;      // towards the part of the light nearest to the mirrored line of sight
    float t;            // distance of the light
    float widening;     // tangent of half the angle that the light fills
    vec3 light;         // on a surface perpendicular to the direction; for a panel, on the lit surface
    float shadow;       // fraction that shadows remove
#ifdef LIGHT_THROUGH
    vec3 through;       // on a surface perpendicular to the direction, also behind the surface
#endif
};

// Light ends smoothly at its range (Karis, "Real shading in Unreal Engine 4", 2013).
float faded(float t, float range) {
    float fraction = range > 0.0 ? t / range : 0.0;
    float left = clamp(1.0 - fraction * fraction * fraction * fraction, 0.0, 1.0);
    return left * left;
}

#ifdef PANELS
// Returns an edge's term of Lambert's formula for the light of a polygon (1760): the edge's normal, multiplied by the
// angle between the directions to the edge's ends.
vec3 edge_of_panel(vec3 a, vec3 b) {
    vec3 across = cross(a, b);
    float sine = length(across);
    float angle = atan(sine, dot(a, b));
    // At a point on the edge's line, the edge has no normal. There, and for short edges, use the sine as the angle.
    return sine > 1e-5 ? across * (angle / sine) : across;
}

Incoming light_of_panel(vec4 place, vec4 color, vec4 right, vec4 up, vec3 p, vec3 normal, vec3 direction) {
    vec3 middle = place.xyz - p;
    vec3 facing = cross(right.xyz, up.xyz);
    float area = length(facing);
    facing /= max(area, 1e-9);
    float before = -dot(middle, facing);
    vec3 a = normalize(middle - right.xyz - up.xyz);
    vec3 b = normalize(middle + right.xyz - up.xyz);
    vec3 c = normalize(middle + right.xyz + up.xyz);
    vec3 d = normalize(middle - right.xyz + up.xyz);
    vec3 flux = edge_of_panel(a, b) + edge_of_panel(b, c) + edge_of_panel(c, d) + edge_of_panel(d, a);
    // Panels that are partly below the horizon are slightly too dark, because that part is not cut off.
    float arriving = before > 0.0 ? max(-0.5 * dot(flux, normal), 0.0) : 0.0;
    float t = length(middle);
    // The intersection of the mirrored line of sight with the panel's plane, clamped to the panel.
    vec3 mirrored = reflect(direction, normal);
    float slope = -dot(mirrored, facing);
    vec3 met = slope > 1e-4 ? mirrored * (before / slope) - middle : mirrored * t - middle;
    vec2 inside = vec2(dot(met, right.xyz) / max(dot(right.xyz, right.xyz), 1e-9),
                       dot(met, up.xyz) / max(dot(up.xyz, up.xyz), 1e-9));
    inside = clamp(inside, -1.0, 1.0);
    Incoming incoming;
    incoming.direction = middle / max(t, 1e-6);
    incoming.mirrored = normalize(middle + inside.x * right.xyz + inside.y * up.xyz);
    incoming.t = t;
    incoming.widening = sqrt(area / PI) / max(t, 1e-3);
    incoming.light = color.rgb * (arriving * faded(t, right.w));
    incoming.shadow = up.w;
#ifdef LIGHT_THROUGH
    incoming.through = color.rgb * (before > 0.0 ? max(-0.5 * dot(flux, incoming.direction), 0.0) * faded(t, right.w) : 0.0);
#endif
    return incoming;
}
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
#ifdef LIGHT_THROUGH
    incoming.through = color.rgb * falloff;
#endif
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

#ifdef SHEEN
// Returns the colour of a thin film on a mirror: light of the wavelengths whose waves from both faces of the film meet in
// step is up to twice as bright, the others are dark (Newton's rings; Born and Wolf, "Principles of Optics", section 7.6).
// `nanometres` is the film's thickness. Thick films mix all colours. A film of 0 is none.
vec3 film_color(float nanometres, float cosine) {
    const float INDEX = 1.4;
    const vec3 WAVELENGTHS = vec3(620.0, 540.0, 455.0);
    if (nanometres <= 0.0) return vec3(1.0);
    float behind = sqrt(1.0 - (1.0 - cosine * cosine) / (INDEX * INDEX));
    vec3 turns = (2.0 * INDEX * behind * nanometres) / WAVELENGTHS;
    vec3 spread = 0.09 * turns;
    return 1.0 - cos(2.0 * PI * turns) * exp(-spread * spread);
}

vec3 velvet_color(Material m) {
    return m.velvet * mix(vec3(1.0), m.color, 0.5);
}

// The shine of velvet: fibres across the surface, by Charlie's distribution (Estevez and Kulla, "Production friendly
// microfacet sheen BRDF", 2017) with Neubelt's visibility (Neubelt and Pettineo 2013).
vec3 velvet(Material m, float facing, float seen, float nh) {
    float inverse = 1.0 / max(m.roughness, 0.1);
    float sine2 = max(1.0 - nh * nh, 1e-4);
    float spread = (2.0 + inverse) * pow(sine2, 0.5 * inverse) / (2.0 * PI);
    return velvet_color(m) * (spread / (4.0 * max(facing + seen - facing * seen, 1e-3)));
}
#endif

// Returns the colour of a surface for light from all directions.
vec3 diffuse_color(Material m, vec3 normal, vec3 direction) {
#ifdef SHEEN
    float edge = 1.0 - clamp(-dot(direction, normal), 0.0, 1.0);
    vec3 coloured = m.color * mix(vec3(1.0), film_color(m.film, 1.0 - edge), m.metalness);
    return coloured + velvet_color(m) * (edge * edge * edge);
#else
    return m.color;
#endif
}

// Returns the colour of mirror images: metals tint them.
vec3 mirror_color(Material m, vec3 normal, vec3 direction) {
    vec3 tint = mix(vec3(1.0), m.color, m.metalness);
#ifdef SHEEN
    tint *= film_color(m.film, -dot(direction, normal));
#endif
    return tint;
}

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
    vec3 f0 = mix(vec3(0.04), m.color, m.metalness);
#ifdef SHEEN
    f0 = min(f0 * film_color(m.film, dot(halfway, incoming.mirrored)), vec3(1.0));
#endif
#ifdef PATHS
    float below = 1.0 - highlight_part(alpha, seen);
#else
    float below = 0.96 - 0.96 * grazing;
#endif
    vec3 diffuse = m.color * ((1.0 - m.metalness) * below / PI);
#ifdef TRANSLUCENT
    diffuse *= 1.0 - m.translucent;
#endif
    vec3 light = diffuse + highlight(alpha, incoming.widening, f0, facing, seen, nh, grazing);
#ifdef SHEEN
    light += velvet(m, facing, seen, nh);
#endif
    if (m.coat > 0.0) {
        float fraction = m.coat * (0.04 + 0.96 * grazing);
        light = light * (1.0 - fraction)
              + m.coat * highlight(ALPHA_MIN, incoming.widening, vec3(0.04), facing, seen, nh, grazing);
    }
    return light;
}

#ifdef BLUR
// Returns the normal of a rough mirror's facet, by GGX (Walter et al. 2007).
vec3 facet(vec3 normal, float alpha, vec2 random) {
    float cosine = sqrt((1.0 - random.x) / (1.0 + (alpha * alpha - 1.0) * random.x));
    float sine = sqrt(max(1.0 - cosine * cosine, 0.0));
    vec3 side = normalize(abs(normal.y) < 0.9 ? vec3(normal.z, 0.0, -normal.x) : vec3(0.0, -normal.z, normal.y));
    float turn = 2.0 * PI * random.y;
    return normalize(normal * cosine + (side * cos(turn) + cross(normal, side) * sin(turn)) * sine);
}
#endif

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
