// What the surfaces are made of: the thesis' functions from position and normal to colour (section 3.2).

uniform sampler2D wood;
uniform sampler2D mallard;

struct Material {
    vec3 albedo;        // diffuse reflectance, linear
    vec3 emission;      // light of its own
    float gloss;        // strength of the lamp's highlight
    float shine;        // its Blinn-Phong exponent
};

// The pixel's footprint on the surface: how the hit point moves per pixel to the right and up.
struct Footprint {
    vec3 dx;
    vec3 dy;
};

const float WOOD_SCALE = 0.16;

// The texture read along each axis and mixed by the normal (thesis 3.2).
vec3 wood_color(vec3 p, vec3 normal, Footprint print) {
    vec3 weight = pow(abs(normal), vec3(6.0));
    weight /= weight.x + weight.y + weight.z;
    vec3 color = vec3(0.0);
    vec3 q = p * WOOD_SCALE;
    vec3 dx = print.dx * WOOD_SCALE;
    vec3 dy = print.dy * WOOD_SCALE;
    if (weight.x > 0.01) color += weight.x * textureGrad(wood, q.zy, dx.zy, dy.zy).rgb;
    if (weight.y > 0.01) color += weight.y * textureGrad(wood, q.xz, dx.xz, dy.xz).rgb;
    if (weight.z > 0.01) color += weight.z * textureGrad(wood, q.xy, dx.xy, dy.xy).rgb;
    return color;
}

const float MALLARD_SIZE = 2.5;
const float MALLARD_Y = 1.55;

Material speaker_material(vec3 p, vec3 normal, Footprint print) {
    float side = p.x < 0.0 ? -1.0 : 1.0;
    vec3 q = p - vec3(side, 1.0, 1.0) * SPEAKER_CENTRE;
    vec3 grain = wood_color(p + vec3(side * 3.1, 0.0, 0.0), normal, print);
    Material m = Material(grain * grain * vec3(0.80, 1.02, 1.25) + 0.24 * grain, vec3(0.0), 0.45, 50.0);

    // The mallard on the front, each looking at the other speaker. Its picture looks to the left.
    vec2 scale = vec2(side, -1.0) / MALLARD_SIZE;
    vec2 uv = scale * vec2(q.x, q.y - MALLARD_Y) + 0.5;
    if (normal.z < -0.8 && q.z < -1.9 && all(lessThan(abs(uv - 0.5), vec2(0.5)))) {
        vec4 picture = textureGrad(mallard, uv, print.dx.xy * scale, print.dy.xy * scale);
        m.albedo = mix(m.albedo, picture.rgb, picture.a);
        m.gloss = mix(m.gloss, 0.15, picture.a);
    }

    // The woofer: a dark membrane with rings, in a rubber rim.
    float r = woofer_radius(side);
    float rim = sqrt(r * r - WOOFER_LEAD * WOOFER_LEAD);
    float from_axis = length(q.xy - vec2(0.0, WOOFER_Y));
    if (from_axis < rim + 0.22 && q.z < -0.2 && abs(p.x) > 2.9) {
        float pixel = length(print.dx) + length(print.dy);
        float inside = 1.0 - smoothstep(rim - 0.02 - pixel, rim - 0.02 + pixel, from_axis);
        float rubber = 1.0 - smoothstep(rim + 0.17 - pixel, rim + 0.17 + pixel, from_axis);
        float rings = 0.5 + 0.5 * cos(from_axis * 34.0) * clamp(1.0 - 12.0 * pixel, 0.0, 1.0);
        vec3 membrane = mix(vec3(0.028, 0.030, 0.034), vec3(0.060, 0.062, 0.066), rings);
        float cap = 1.0 - smoothstep(0.34 - pixel, 0.34 + pixel, from_axis);
        membrane = mix(membrane, vec3(0.30, 0.19, 0.08), cap);
        m.albedo = mix(m.albedo, vec3(0.016), rubber);
        m.albedo = mix(m.albedo, membrane, inside);
        m.gloss = mix(m.gloss, 0.55, max(rubber, inside));
        m.shine = mix(m.shine, 24.0, rubber);
    }
    return m;
}

// From amber in the bass to cyan in the treble.
vec3 bar_hue(float u) {
    vec3 low = vec3(1.0, 0.30, 0.05);
    vec3 middle = vec3(0.95, 0.10, 0.42);
    vec3 high = vec3(0.06, 0.55, 1.0);
    return u < 0.5 ? mix(low, middle, 2.0 * u) : mix(middle, high, 2.0 * u - 1.0);
}

Material bar_material(vec3 p) {
    int index = bar_index(p.x);
    vec3 hue = bar_hue((float(index) + 0.5) / 32.0);
    float glow = 0.25 + 1.3 * band(index) * smoothstep(-0.6, 1.0, p.y / (0.04 + BAR_HEIGHT * band(index)));
    return Material(0.5 * hue, hue * glow, 0.3, 60.0);
}

// Reflectance of the floor's mirror at normal incidence.
const float FLOOR_MIRROR = 0.38;

Material material_at(int object, vec3 p, vec3 normal, Footprint print) {
    if (object == FLOOR) return Material(vec3(0.0, 0.12, 0.128), vec3(0.0), 0.0, 1.0);
    if (object == BAR) return bar_material(p);
    return speaker_material(p, normal, print);
}
