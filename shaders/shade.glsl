// The light that a surface sends towards the eye, without mirror images.

// All lights together whose shadows are left out are weaker than this part of a surface's other light, plus this light as
// shown. In 27 scenes at most 0.006 % of the pixels changed by more than 4 of 255.
const float SHADOWED_PART = 0.02;
const float SHADOWED_SHOWN = 0.002;
// Light of thin balls that is weaker than this has no shadows.
const float THIN_SHADOWED_MIN = 0.001;

// Thin balls in front of the end of a ray.
struct ThinBalls {
    vec3 color;     // 0 if they need no light
    vec3 fraction;  // of their light that reaches the eye
    float before;   // their distance from the end of the ray
};

#ifdef BOUNCE
// Returns the light that nearby surfaces throw on this one. The blockers that the probes of occlusion meet count as
// surfaces of the same colour, half turned to the light.
vec3 thrown_by_neighbours(Surface s) {
    Material m = s.material;
    return m.color * m.color * ((1.0 - m.metalness) * (1.0 - s.open) * nearby_bounce);
}
#endif

// Returns the light from the surface at p towards the eye.
#ifdef DRAWS_SWARM
// The light is multiplied by `fraction`. Adds the light of thin balls, for which further shadow rays run.
vec3 shade(Surface s, vec3 p, vec3 direction, float cone, vec3 fraction, ThinBalls thin) {
#else
vec3 shade(Surface s, vec3 p, vec3 direction, float cone) {
#endif
    Material m = s.material;
    // Add the light without shadows first: while a shadow ray runs, all values that are used later occupy registers.
    vec3 light = m.emission + diffuse_color(m, s.normal, direction) * (light_of(s.ambient) * s.open + s.glow);
#ifdef BOUNCE
    vec3 thrown_on = thrown_by_neighbours(s);
    light += thrown_on * light_of(s.ambient) * s.open;
#endif
    // The loop tests its condition at the end. With a test at the start, a renderer that never skips a branch would run
    // one more round in vain.
    int last = min(int(frame_clock.y), LIGHTS_MAX) - 1;
    int i = 0;
#ifdef DRAWS_SWARM
    light *= fraction;
    int count = last + 1;
    if (thin.color != vec3(0.0)) last += count;
    // A surface that sends no light needs no shadow rays.
    if (fraction == vec3(0.0)) i = count;
#endif
    do {
        int number = i;
#ifdef DRAWS_SWARM
        if (i == count) {
            p -= thin.before * direction;
            s = thin_surface(thin.color, p, direction);
            m = s.material;
            fraction = thin.fraction;
            light += fraction * m.color * light_of(s.ambient);
#ifdef BOUNCE
            thrown_on = vec3(0.0);
#endif
        }
        number = i < count ? i : i - count;
#endif
        // frame_reach.z is 0. Without this term, compilers move expressions that are the same for all lights before the
        // loop, and the results occupy registers during the shadow rays.
        vec3 view_direction = direction + frame_reach.z * float(i);
        Incoming incoming = light_at(number, p, s.normal, view_direction);
        // Light that comes through the body or from nearby surfaces, and the start of the ray to the light: at the surface,
        // or for lights behind it where their light arrives.
        vec3 through = vec3(0.0);
        vec3 from = p;
        vec3 side = s.normal;
#ifdef BOUNCE
        through += incoming.through * thrown_on * (0.5 / PI);
        if (dot(s.normal, incoming.direction) < 0.0) from += (0.5 * frame_reach.x) * s.normal;
#endif
#ifdef TRANSLUCENT
        // Light that comes out of the body has no direction any more, so half of it comes out on this side.
        through += incoming.through * m.color * (0.5 * m.translucent / PI);
        shadow_dims = m.translucent > 0.0 ? 1.0 / max(m.depth, 1e-3) : 0.0;
        if (dot(s.normal, incoming.direction) < 0.0 && m.translucent > 0.0) {
            from = p;
            side = -s.normal;
        }
#endif
        vec3 arriving = incoming.light + through;
        if (most_of(arriving) > 1e-5) {
            float sharpness = clamp(1.0 / max(incoming.widening, 1e-4), SHARPNESS_MIN, SHARPNESS_MAX);
            vec3 thrown = incoming.light * thrown_back(m, s.normal, incoming, view_direction) + through;
            float least = (SHADOWED_PART * most_of(light) + SHADOWED_SHOWN / picture_look.x) / float(last + 1);
#ifdef DRAWS_SWARM
            thrown *= fraction;
            if (i >= count) least = max(least, THIN_SHADOWED_MIN);
#endif
            // A light without shadows, or too weak for its shadow to be seen, needs no shadow ray.
            bool has_shadow = incoming.shadow > 0.0 && most_of(thrown) >= least;
            float t = has_shadow ? incoming.t : 0.0;
            float visible = light_visibility(from, side, incoming.direction, t, sharpness, cone);
            visible = mix(1.0, visible, incoming.shadow);
            NOTE_LIGHT(incoming.light, visible);
            if (visible > 0.0) light += visible * thrown;
        }
    } while (i++ < last);
#ifdef TRANSLUCENT
    shadow_dims = 0.0;
#endif
    return light;
}
