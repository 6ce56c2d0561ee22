// Computes a point of a surface with the functions of a compiled scene.

// Returns the distance for a ray. Compiled functions do not use the cell.
vec2 scene_distance(Cell cell, vec3 p, float penumbra) {
    return scene_distance(p, penumbra);
}

// The points are evaluated in this order: the point itself (for its object), the normal's taps.
const int FIRST_TAP = 1;
const int LAST_TAP = 4;

// `plane` is the plane that contains `p`, or NOTHING. `dx` and `dy` lead to the neighbouring pixels' rays
// at this distance.
Surface scene_surface(vec3 p, int plane, vec3 direction, float cone, vec3 dx, vec3 dy) {
    Surface s;
    s.normal = vec3(0.0);
    s.glow = vec3(0.0);
    float object = SOLE_OBJECT;
    if (plane != NOTHING) {
        s.normal = plane_of(plane).xyz;
        NOTE_PLANE;
        object = plane_objects[plane];
    }
    float h = tap_distance(cone);
    // Use one loop, so that a driver compiles the scene once for all points.
    for (int i = plane != NOTHING ? LAST_TAP + 1 : SOLE_OBJECT < 0.0 ? 0 : FIRST_TAP; i <= LAST_TAP; i++) {
        vec4 place = vec4(equal(ivec4(0, 1, 2, 3), ivec4(i - FIRST_TAP)));
        vec3 tap = vec3(dot(TAPS_X, place), dot(TAPS_Y, place), dot(TAPS_Z, place));
        float nearest;
        float estimate = scene_estimate(p + h * tap, nearest);
        if (i == 0) {
            object = nearest;
        } else {
            s.normal += estimate * tap;
            COUNT(count_normal);
        }
    }
    if (plane == NOTHING) {
        NOTE_SLOPE(s.normal, h);
        s.normal = normal_of(s.normal);
    }
    s.object = int(object + 0.5);
    s.material = scene_material(s.object, p, s.normal, along_surface(dx, s.normal, direction),
                                along_surface(dy, s.normal, direction));
    s.open = UNKNOWN_OPEN;
#ifdef PATHS
    s.ambient = vec3(0.0);
#else
#ifdef GLOW
    // With this width, a texture gives its mean colour around the point.
    vec3 width = vec3(GLOW_PROBE * frame_reach.x, 0.0, 0.0);
    s.glow = glow_from(scene_glow(p + width.x * s.normal, width, width.zyx));
#endif
    s.ambient = sky_ambient(s.normal, vec3(0.0), vec3(0.0));
#endif
    return s;
}

#ifdef PATHS
// Returns the sky's colour, or its ambient light from a direction.
vec3 sky_light(vec3 direction, vec3 dx, vec3 dy, bool is_color) {
    if (is_color) return sky_color(direction, dx, dy);
    return sky_ambient(direction, vec3(0.0), vec3(0.0));
}
#endif
