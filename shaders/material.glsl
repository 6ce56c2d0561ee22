// What a scene says of a surface: the thesis' functions from position and normal (section 3.2).

struct Material {
    vec3 color;         // diffuse reflectance, or the metal's colour, linear
    float roughness;    // 0 polished .. 1 matt
    float metalness;    // 0 insulator .. 1 metal
    vec3 emission;      // light of its own
    float reflect;      // share of light that is mirrored when looked at straight on
    float coat;         // strength of a clear coat
    float haze;         // share that the sky covers
    float blur;         // how rough the mirror is, 0 sharp .. 1 matt
};

// Brings what a formula gave into its ranges; what is no number becomes 0.
float share_of(float value) {
    return value > 0.0 ? min(value, 1.0) : 0.0;
}
vec3 light_of(vec3 value) {
    return vec3(value.r > 0.0 ? min(value.r, 1e6) : 0.0, value.g > 0.0 ? min(value.g, 1e6) : 0.0,
                value.b > 0.0 ? min(value.b, 1e6) : 0.0);
}

Material within_ranges(Material m) {
    return Material(min(light_of(m.color), vec3(1.0)), share_of(m.roughness), share_of(m.metalness), light_of(m.emission),
                    share_of(m.reflect), share_of(m.coat), share_of(m.haze), share_of(m.blur));
}

// Everything about a point of a surface but the light that falls on it from lamps.
struct Surface {
    int object;
    vec3 normal;
    Material material;
    vec3 ambient;       // light from everywhere
    float open;         // how much of it arrives
    vec3 glow;          // light of what hides the rest of it
};
