// Rough mirrors (variant BLUR): each sample of a pixel meets another facet.

#ifdef BLUR
// Two numbers in 0..1 for a surface of the path. A pixel's numbers come from a hash (pcg3d, Jarzynski and Olano 2020)
// and are the same in each frame. The pixel's further samples follow the R2 sequence (Roberts 2018).
vec2 scatter(int surface) {
    uvec3 v = uvec3(uvec2(sample_place()), uint(surface)) * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> 16u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    return fract(vec2(v.xy >> 8u) / 16777216.0 + sample_number() * vec2(0.7548777, 0.5698403));
}

// Returns the normal of the facet that the path meets at a surface.
vec3 facet_of(Surface s, inout EyePath path) {
    float alpha = s.material.blur * s.material.blur;
    if (!(alpha > 1e-4)) return s.normal;
    seen_rough = ROUGH_KEY;
    path.blurred += 0.5 * alpha;
    FORGET_SWARM_TILES
    return facet(s.normal, alpha, scatter(path.surface));
}
#else
vec3 facet_of(Surface s, inout EyePath path) {
    return s.normal;
}
#endif
