// The surface at the end of a path's ray: it divides the light and chooses the next ray.

// Returns the vertex on a surface, and how its light parts.
Vertex vertex_on_surface(inout Path path, RayEnd end, Surface s, vec3 p, vec2 random, out Parting parting) {
    Material whole = s.material;
    Material m = opaque_part(whole);
    path.throughput *= 1.0 - m.haze;
    parting.p = p;
    parting.normal = s.normal;
    parting.off = end.hit.plane != NOTHING ? 0.0 : max(0.002, camera_position.w * path.travelled);
    parting.facing = s.normal;
#ifdef BLUR
    float alpha = m.blur * m.blur;
    if (alpha > 1e-4 && !is_guiding) parting.facing = facet(s.normal, alpha, random);
#endif
    parting.kept = path.throughput;
    float reflectance = mirrored_part(m, s.normal, path.direction);
    vec3 tint = mirror_color(whole, s.normal, path.direction);
    parting.mirrored = reflectance * tint;
    parting.bent = 0.0;
    parting.scattered = 1.0 - reflectance;
    parting.ratio = 1.0;
    Vertex at;
    at.origin = p + s.normal * parting.off;
    at.lobes = lobes_of(m, s.normal, path.direction);
    at.lobed = 1.0;
    at.is_medium = false;
    part_at_glass(parting, at, tint, reflectance, end.leaves);
    path.throughput = parting.kept * parting.scattered;
    return at;
}

// The light of a surface goes on in one of these ways, with about the probability of the light that goes it: in a mirror
// image, through glass, and by the lobes.
vec3 ways_of(Parting parting, Vertex at) {
    vec3 ways = vec3(brightness_of(parting.mirrored), parting.bent,
                     parting.scattered * at.lobed * max(at.lobes.bright, 0.05));
    return ways / max(ways.x + ways.y + ways.z, 1e-6);
}

// Turns a path into the mirror image of a surface, or into the image behind glass.
void go_into_image(inout Path path, Parting parting, vec3 ways, bool is_reflected) {
    if (is_reflected) {
        path.throughput = parting.kept * parting.mirrored / ways.x;
        vec3 to = reflect(path.direction, parting.facing);
        path.direction = normalize(to + parting.normal * max(0.02 - dot(to, parting.normal), 0.0));
        path.origin = parting.p + parting.normal * parting.off;
    } else {
        path.throughput = parting.kept * (parting.bent / ways.y);
        path.direction = bent_direction(parting, path.direction);
        path.origin = parting.p - parting.normal * parting.off;
    }
    // The next surface's colour replaces the white of this image.
    guide_color -= path.throughput;
    path.density = path.density == BY_EYE ? BY_EYE : BY_MIRROR;
}

// Turns a path into a ray that a surface or a medium scatters.
void scatter(inout Path path, Vertex at, float choice, vec2 random) {
    vec3 to = at.is_medium ? scattered_direction(path.direction, at.phase, random)
                           : lobe_direction(at.lobes, choice, random);
    float density = vertex_density(at, to);
    path.throughput *= density > 0.0 ? vertex_reflectance(at, to) / density : vec3(0.0);
    path.density = density;
    path.origin = at.origin;
    path.direction = to;
}
