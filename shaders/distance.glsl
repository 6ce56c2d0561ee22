// Distances of primitives and their combination: Quilez, "distance functions" (2011) and "smooth minimum" (2013).

// Box of half extents `half_size` whose edges are rounded outwards by `radius`; exact.
float round_box(vec3 p, vec3 half_size, float radius) {
    vec3 q = abs(p) - half_size;
    return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0) - radius;
}

float box(vec3 p, vec3 half_size) {
    return round_box(p, half_size, 0.0);
}

// Polynomial smooth minimum; differs from min only where |a - b| < k.
float smooth_min(float a, float b, float k) {
    float h = max(k - abs(a - b), 0.0) / k;
    return min(a, b) - h * h * k * 0.25;
}

// a without b, the edge rounded over k.
float smooth_subtract(float a, float b, float k) {
    return -smooth_min(-a, b, k);
}
