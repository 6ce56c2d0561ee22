// Glass on paths (variant GLASS): rays inside of it, mirrored and bent light, and the light that the glass absorbs.

#ifdef GLASS
// Reads from a path whether its ray is inside of glass.
bool begin_inside(inout Path path) {
    bool is_inside = path.density < INSIDE_BELOW;
    if (is_inside) path.density = INSIDE - path.density;
    ray_side = is_inside ? -1.0 : 1.0;
    return is_inside;
}

// True if a ray leaves the glass that it is in. Rays towards lights start outside.
bool leaves_glass(Hit hit, bool is_inside, bool is_ball) {
    ray_side = 1.0;
    return is_inside && hit.met && !met_in_glass && hit.plane == NOTHING && !is_ball;
}

// Returns the surface at the end of a ray. Dims the light by the glass in front of it.
Surface surface_at_end(inout Path path, RayEnd end, vec3 p, float cone) {
    Surface s;
    bool is_kept = end.is_inside && !end.leaves;
    // Around an opaque surface in glass, first the glass.
    for (int i = is_kept ? 0 : 1; i < 2; i++) {
        surface_penumbra = is_kept && i > 0 ? WITHOUT_GLASS : 0.0;
        s = scene_surface(p, i > 0 ? end.hit.plane : NOTHING, path.direction, cone, end.dx, end.dy);
        if (end.is_inside && (i == 0 || end.leaves)) path.throughput *= exp(-within_ranges(s.material).absorb * end.t);
    }
    return s;
}

// A surface that is left counts as glass from inside.
void turn_inside(inout Surface s, RayEnd end) {
    if (end.hit.plane != NOTHING) s.material.glass = 0.0;
    if (end.leaves) {
        s.normal = -s.normal;
        s.material.glass = 1.0;
        s.material.haze = 0.0;
    }
}

// Returns the part of a material that is no glass.
Material opaque_part(Material m) {
    m.color *= 1.0 - m.glass;
    return m;
}

// Divides the light at a surface of glass. The surface itself mirrors `reflectance` of the light in the colour `tint`.
void part_at_glass(inout Parting parting, inout Vertex at, vec3 tint, float reflectance, bool leaves) {
    Material m = at.lobes.material;
    parting.ratio = leaves ? m.ior : 1.0 / m.ior;
    float of_glass = glass_reflectance(parting.ratio, clamp(-dot(at.lobes.direction, parting.facing), 0.0, 1.0));
    if (m.glass > 0.0) {
        parting.mirrored = leaves ? vec3(of_glass) : max(reflectance, m.glass * of_glass) * tint;
        parting.bent = m.glass * (1.0 - of_glass);
    }
    if (leaves) parting.scattered = 0.0;
    // The mirror image of glass replaces the rays of its highlight, but not the highlights of lights.
    at.lobed = 1.0 - m.glass * (at.lobes.shares.y + at.lobes.shares.z);
}

// Returns the direction of a ray that goes through the surface of glass.
vec3 bent_direction(Parting parting, vec3 direction) {
    vec3 to = refract(direction, parting.facing, parting.ratio);
    return normalize(to - parting.normal * max(0.02 + dot(to, parting.normal), 0.0));
}

// Returns the number of rays that look for a light of which the part `met` can be met by chance. Glass stops or bends the
// rays that meet lights by chance, so a second ray looks for glass. The rays towards lights find the rest.
int shadow_rays(float met, float light) {
    return met > 0.01 * light ? 2 : 1;
}
#else
bool begin_inside(inout Path path) {
    return false;
}

bool leaves_glass(Hit hit, bool is_inside, bool is_ball) {
    return false;
}

Surface surface_at_end(inout Path path, RayEnd end, vec3 p, float cone) {
    return scene_surface(p, end.hit.plane, path.direction, cone, end.dx, end.dy);
}

void turn_inside(inout Surface s, RayEnd end) {}

Material opaque_part(Material m) {
    return m;
}

void part_at_glass(inout Parting parting, inout Vertex at, vec3 tint, float reflectance, bool leaves) {}

vec3 bent_direction(Parting parting, vec3 direction) {
    return direction;
}

int shadow_rays(float met, float light) {
    return 1;
}
#endif
