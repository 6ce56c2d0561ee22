// Thin films and velvet (variant SHEEN), and the colours of surfaces with them.

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

// Returns the colour of a surface for light from all directions.
vec3 diffuse_color(Material m, vec3 normal, vec3 direction) {
    float edge = 1.0 - clamp(-dot(direction, normal), 0.0, 1.0);
    vec3 coloured = m.color * mix(vec3(1.0), film_color(m.film, 1.0 - edge), m.metalness);
    return coloured + velvet_color(m) * (edge * edge * edge);
}

// Returns the colour of mirror images: metals tint them.
vec3 mirror_color(Material m, vec3 normal, vec3 direction) {
    return mix(vec3(1.0), m.color, m.metalness) * film_color(m.film, -dot(direction, normal));
}

// Returns a reflectance at normal incidence with the film on it.
vec3 filmed(vec3 f0, Material m, float cosine) {
    return min(f0 * film_color(m.film, cosine), vec3(1.0));
}
#else
vec3 velvet(Material m, float facing, float seen, float nh) {
    return vec3(0.0);
}

vec3 diffuse_color(Material m, vec3 normal, vec3 direction) {
    return m.color;
}

vec3 mirror_color(Material m, vec3 normal, vec3 direction) {
    return mix(vec3(1.0), m.color, m.metalness);
}

vec3 filmed(vec3 f0, Material m, float cosine) {
    return f0;
}
#endif
