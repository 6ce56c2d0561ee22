// Paths through glass (variant GLASS): where rays begin, what the glass leaves of the light, and which ray is traced next.

// Maximum number of surfaces on a path. Without glass: four mirrors, and the surface in the last mirror. With glass: two
// hollow bodies with two walls each, the surface behind them, and SURFACES_KEPT for the waiting ray.
#if defined(COVERAGE)
const int SURFACES_MAX = 1;
const int SURFACES_KEPT = 1;
#elif defined(GLASS)
const int SURFACES_MAX = 12;
const int SURFACES_KEPT = 3;
#elif defined(MIRRORS)
const int SURFACES_MAX = 5;
#else
const int SURFACES_MAX = 1;
#endif

#ifdef GLASS
// Returns the distance at which a ray begins. Walls of glass are thin, so rays start close to the surface.
float first_distance(int surface) {
    return ray_side > 0.0 ? 0.01 * float(min(surface, 1)) : 0.0;
}

// True if a ray leaves glass where it has met its surface. Chooses the distance for the surface there.
bool leaves_glass(Hit hit, bool is_ball) {
    bool is_inside = ray_side < 0.0;
    bool leaves = is_inside && !met_in_glass && hit.plane == NOTHING && !is_ball;
    surface_penumbra = is_inside && !leaves ? WITHOUT_GLASS : 0.0;
    is_leaving_glass = leaves;
    return leaves;
}

// Dims the light by the glass in front of a surface. A surface that is left counts as glass from inside.
void see_through_glass(inout EyePath path, inout Surface s, Hit hit, bool leaves) {
    if (ray_side < 0.0) path.throughput *= exp(-glass_absorbs * hit.t);
    if (hit.plane != NOTHING) s.material.glass = 0.0;
    if (leaves) {
        s.normal = -s.normal;
        s.material.glass = 1.0;
        s.material.haze = 0.0;
        ray_side = 1.0;
    }
}

// Returns the part of a surface that is no glass, for lights.
Surface opaque_part(Surface s) {
    s.material.color *= 1.0 - s.material.glass;
    return s;
}

// Continues the path with the bent ray. The mirrored ray waits if it can. Returns false if the surface is no glass.
bool bend(inout EyePath path, Mirror at, vec3 came, bool leaves, float fraction_min) {
    Material m = at.s.material;
    if (!(m.glass > 0.0)) return false;
    float ratio = leaves ? m.ior : 1.0 / m.ior;
    float of_glass = glass_reflectance(ratio, clamp(-dot(came, at.facet), 0.0, 1.0));
    vec3 mirrored = at.kept * max(at.reflectance, m.glass * of_glass) * at.tint;
    if (of_glass < 1.0) {
        path.throughput = at.kept * m.glass;
        // A path has one waiting ray. Later reflections follow the bent ray.
        bool waits = !leaves && !is_medium_pass() && waiting.throughput == vec3(0.0);
        if (waits && most_of(mirrored) > fraction_min) {
            waiting = WaitingRay(path.origin, path.direction, mirrored, path.travelled);
            path.throughput *= 1.0 - of_glass;
        }
        path.origin = at.p - at.s.normal * at.off;
        vec3 bent = refract(came, at.facet, ratio);
        // Keep the ray from leaving the body's surface on the wrong side.
        path.direction = normalize(bent - at.s.normal * max(0.02 + dot(bent, at.s.normal), 0.0));
        if (!leaves) {
            ray_side = -1.0;
            glass_absorbs = m.absorb;
        }
    } else {
        path.throughput = leaves ? at.kept : mirrored;
        ray_side = leaves ? -1.0 : 1.0;
    }
    return true;
}

// Continues the path with the waiting ray where it would end. Keeps some surfaces for it.
void resume_waiting(inout EyePath path, inout bool ends) {
    bool is_waiting = waiting.throughput != vec3(0.0);
    if (!is_waiting || !(ends || path.surface == SURFACES_MAX - SURFACES_KEPT)) return;
    path.origin = waiting.origin;
    path.direction = waiting.direction;
    path.throughput = waiting.throughput;
    path.travelled = waiting.travelled;
    waiting.throughput = vec3(0.0);
    ray_side = 1.0;
    ends = false;
    end_medium();
}
#else
float first_distance(int surface) {
    return 0.01 * float(surface);
}

bool leaves_glass(Hit hit, bool is_ball) {
    return false;
}

void see_through_glass(inout EyePath path, inout Surface s, Hit hit, bool leaves) {}

Surface opaque_part(Surface s) {
    return s;
}

bool bend(inout EyePath path, Mirror at, vec3 came, bool leaves, float fraction_min) {
    return false;
}

void resume_waiting(inout EyePath path, inout bool ends) {}
#endif
