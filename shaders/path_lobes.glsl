// Directions in which a surface scatters light. `thrown_back` (light.glsl) is the only definition of the material, for
// paths and for the raster. These functions only draw directions with densities that are similar to it: diffuse, GGX and
// the clear coat.

struct Lobes {
    vec3 normal;
    vec3 direction;     // of the ray that met the surface
    Material material;
    vec3 shares;        // fractions of the directions that are drawn for the diffuse part, for GGX and for the coat
    float bright;       // about the reflectance of all three
};

float lobe_alpha(Material m) {
    return clamp(m.roughness * m.roughness, ALPHA_MIN, 1.0);
}

Lobes lobes_of(Material m, vec3 normal, vec3 direction) {
    float grazing = pow(1.0 - clamp(-dot(direction, normal), 0.0, 1.0), 5.0);
    float shine = mix(0.04, brightness_of(m.color), m.metalness);
    vec3 shares = vec3(0.96 * brightness_of(m.color) * (1.0 - m.metalness), shine + (1.0 - shine) * grazing,
                       m.coat * (0.04 + 0.96 * grazing));
    float sum = shares.x + shares.y + shares.z;
    return Lobes(normal, direction, m, sum > 1e-6 ? shares / sum : vec3(1.0, 0.0, 0.0), min(sum, 1.0));
}

// The density of a direction among the reflections at visible facets (Heitz 2018).
float facet_density(float alpha, float seen, float nh) {
    float a2 = alpha * alpha;
    float k = nh * nh * (a2 - 1.0) + 1.0;
    float masking = 2.0 / (seen + sqrt(a2 + (1.0 - a2) * seen * seen));
    return a2 / (PI * k * k) * masking * 0.25;
}

// The density with which `lobe_direction` draws a direction.
float lobe_density(Lobes lobes, vec3 to) {
    float facing = dot(lobes.normal, to);
    float seen = max(-dot(lobes.normal, lobes.direction), 1e-3);
    float nh = clamp(dot(lobes.normal, normalize(to - lobes.direction)), 0.0, 1.0);
    vec3 densities = vec3(max(facing, 0.0) / PI, facet_density(lobe_alpha(lobes.material), seen, nh),
                          facet_density(ALPHA_MIN, seen, nh));
    return facing > 0.0 ? dot(lobes.shares, densities) : 0.0;
}

// The fraction of the light from a direction that the surface sends to the eye, per steradian.
vec3 lobe_reflectance(Lobes lobes, vec3 to) {
    Incoming incoming;
    incoming.mirrored = to;
    incoming.direction = to;
    incoming.widening = 0.0;
    float facing = dot(lobes.normal, to);
    return facing > 0.0 ? thrown_back(lobes.material, lobes.normal, incoming, lobes.direction) * facing : vec3(0.0);
}

// Returns the normal of a facet that is visible from `seen_from` (Heitz 2018, "Sampling the GGX distribution of visible
// normals").
vec3 visible_facet(vec3 normal, vec3 seen_from, float alpha, vec2 random) {
    vec3 side;
    vec3 other;
    basis_of(normal, side, other);
    vec3 view = vec3(dot(seen_from, side), dot(seen_from, other), max(dot(seen_from, normal), 1e-3));
    vec3 stretched = normalize(vec3(alpha * view.xy, view.z));
    vec3 right;
    vec3 above;
    // `right` is horizontal, so that the lower half of the disc is the hidden one.
    float flat_length2 = dot(stretched.xy, stretched.xy);
    right = flat_length2 > 1e-9 ? vec3(-stretched.y, stretched.x, 0.0) * inversesqrt(flat_length2) : vec3(1.0, 0.0, 0.0);
    above = cross(stretched, right);
    float radius = sqrt(random.x);
    float x = radius * cos(2.0 * PI * random.y);
    float y = radius * sin(2.0 * PI * random.y);
    float fraction = 0.5 * (1.0 + stretched.z);
    y = (1.0 - fraction) * sqrt(max(1.0 - x * x, 0.0)) + fraction * y;
    vec3 found = x * right + y * above + sqrt(max(1.0 - x * x - y * y, 0.0)) * stretched;
    vec3 local = normalize(vec3(alpha * found.xy, max(found.z, 1e-6)));
    return side * local.x + other * local.y + normal * local.z;
}

// Draws a direction. `choice` selects the lobe.
vec3 lobe_direction(Lobes lobes, float choice, vec2 random) {
    bool is_diffuse = choice < lobes.shares.x;
    float alpha = choice < lobes.shares.x + lobes.shares.y ? lobe_alpha(lobes.material) : ALPHA_MIN;
    vec3 facet = visible_facet(lobes.normal, -lobes.direction, alpha, random);
    vec3 diffuse = around(lobes.normal, 1.0 - sqrt(1.0 - random.x), random.y);
    return is_diffuse ? diffuse : reflect(lobes.direction, facet);
}
