// A point of a surface, asked of the scene's functions.

// What a ray asks: compiled functions hold everywhere.
vec2 scene_distance(Cell cell, vec3 p, float penumbra) {
    return scene_distance(p, penumbra);
}

// `p` lies on the plane with the number `plane`, or on anything else if that is NOTHING. `dx` and `dy` are how far the
// pixel's neighbours see at this distance.
Surface scene_surface(vec3 p, int plane, vec3 direction, float cone, vec3 dx, vec3 dy) {
    Surface s;
    if (plane != NOTHING) {
        s.normal = planes[plane].xyz;
        NOTE_PLANE;
        s.object = int(plane_objects[plane] + 0.5);
    } else {
        float h = tap_distance(cone);
        vec4 taps = scene_estimates(p.x + h * TAPS_X, p.y + h * TAPS_Y, p.z + h * TAPS_Z);
        s.normal = normal_of_taps(taps);
        NOTE_SLOPE(taps, h);
        COUNT_N(normal, 4);
        s.object = scene_object(p);
    }
    s.material = scene_material(s.object, p, s.normal, along_surface(dx, s.normal, direction),
                                along_surface(dy, s.normal, direction));
    vec4 d = PROBES;
    if (occluder_near(p)) {
        d = scene_estimates(p.x + s.normal.x * PROBES, p.y + s.normal.y * PROBES, p.z + s.normal.z * PROBES);
        d = AS_DISTANCE(d);
        COUNT_N(occlusion, 4);
    }
    s.open = openness(p, s.normal, d);
    s.ambient = sky_ambient(s.normal, vec3(0.0), vec3(0.0));
    return s;
}
