// Rectangles that shine.

// Returns an edge's term of Lambert's formula for the light of a polygon (1760): the edge's normal, multiplied by the
// angle between the directions to the edge's ends.
vec3 edge_of_panel(vec3 a, vec3 b) {
    vec3 across = cross(a, b);
    float sine = length(across);
    float angle = atan(sine, dot(a, b));
    // At a point on the edge's line, the edge has no normal. There, and for short edges, use the sine as the angle.
    return sine > 1e-5 ? across * (angle / sine) : across;
}

Incoming light_of_panel(vec4 place, vec4 color, vec4 right, vec4 up, vec3 p, vec3 normal, vec3 direction) {
    vec3 middle = place.xyz - p;
    vec3 facing = cross(right.xyz, up.xyz);
    float area = length(facing);
    facing /= max(area, 1e-9);
    float before = -dot(middle, facing);
    vec3 a = normalize(middle - right.xyz - up.xyz);
    vec3 b = normalize(middle + right.xyz - up.xyz);
    vec3 c = normalize(middle + right.xyz + up.xyz);
    vec3 d = normalize(middle - right.xyz + up.xyz);
    vec3 flux = edge_of_panel(a, b) + edge_of_panel(b, c) + edge_of_panel(c, d) + edge_of_panel(d, a);
    // Panels that are partly below the horizon are slightly too dark, because that part is not cut off.
    float arriving = before > 0.0 ? max(-0.5 * dot(flux, normal), 0.0) : 0.0;
    float t = length(middle);
    // The intersection of the mirrored line of sight with the panel's plane, clamped to the panel.
    vec3 mirrored = reflect(direction, normal);
    float slope = -dot(mirrored, facing);
    vec3 met = slope > 1e-4 ? mirrored * (before / slope) - middle : mirrored * t - middle;
    vec2 inside = vec2(dot(met, right.xyz) / max(dot(right.xyz, right.xyz), 1e-9),
                       dot(met, up.xyz) / max(dot(up.xyz, up.xyz), 1e-9));
    inside = clamp(inside, -1.0, 1.0);
    Incoming incoming;
    incoming.direction = middle / max(t, 1e-6);
    incoming.mirrored = normalize(middle + inside.x * right.xyz + inside.y * up.xyz);
    incoming.t = t;
    incoming.widening = sqrt(area / PI) / max(t, 1e-3);
    incoming.light = color.rgb * (arriving * faded(t, right.w));
    incoming.shadow = up.w;
    incoming.through = color.rgb * (before > 0.0 ? max(-0.5 * dot(flux, incoming.direction), 0.0) * faded(t, right.w) : 0.0);
    return incoming;
}
