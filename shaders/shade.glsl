// The light that a surface sends towards the eye, without mirror images.

// All lights together whose shadows are left out are weaker than this part of a surface's other light, plus this light as
// shown. In 27 scenes at most 0.006 % of the pixels changed by more than 4 of 255. The same limit for ambient light
// without occlusion changed at most 0.05 % of the pixels (tunnel).
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

// True unless ambient light is so weak that its occlusion cannot be seen beside the other light.
bool is_occlusion_seen(Surface s, vec3 ambient, vec3 light, vec3 fraction) {
#ifdef BOUNCE
    // Occluders also throw the light of lamps, which may be strong.
    ambient += nearby_bounce * 1e3 * s.material.color;
#endif
    return SHOWS_OPEN || most_of(ambient) >= SHADOWED_PART * most_of(light) + SHADOWED_SHOWN / picture_look.x;
}

#ifdef BOUNCE
// Returns the light that nearby surfaces throw on this one. The blockers that the probes of occlusion meet count as
// surfaces of the same colour, half turned to the light.
vec3 thrown_by_neighbours(Surface s) {
    Material m = s.material;
    return m.color * m.color * ((1.0 - m.metalness) * (1.0 - s.open) * nearby_bounce);
}
#endif

// Returns the fraction of the light from the surface at p that reaches the eye. Adds the light of thin balls, for which
// further shadow rays run.
vec3 shade(Surface s, vec3 p, vec3 direction, float cone, vec3 fraction, ThinBalls thin) {
    Material m = s.material;
    // Add the light without shadows first: while a shadow ray runs, all values that are used later occupy registers.
    vec3 diffuse = fraction * diffuse_color(m, s.normal, direction);
    vec3 light = fraction * m.emission + diffuse * s.glow;
    // What the next ray decides about: first the probes of occlusion about ambient light, then shadow rays about lights.
    vec3 thrown = diffuse * light_of(s.ambient);
    bool is_probed = s.open < 0.0 && (PLANES > 0 || occluder_near(p)) && is_occlusion_seen(s, thrown, light, fraction);
    LightRay ray = LightRay(p, s.normal, is_probed ? FAR : 0.0, 1.0);
    bool probing = true;
    float shadow = 1.0;
    vec3 thrown_on = vec3(0.0);
    NOTED_LIGHT
    int last = min(int(frame_clock.y), LIGHTS_MAX) - 1;
    int i = 0;
#ifdef DRAWS_SWARM
    int count = last + 1;
    if (thin.color != vec3(0.0)) last += count;
    // A surface that sends no light needs no shadow rays.
    if (fraction == vec3(0.0)) i = count;
#endif
    // Each round runs a ray and then chooses the next one, so that the probes need no registers beside those of a light.
    while (true) {
        float visible = ray.t > 0.0 ? mix(1.0, light_visibility(ray, probing), shadow) : 1.0;
        if (probing) {
            NOTE_OPEN(visible);
#ifdef BOUNCE
            s.open = visible;
            thrown_on = thrown_by_neighbours(s);
            thrown += fraction * thrown_on * light_of(s.ambient);
#endif
        } else {
            NOTE_LIGHT(visible);
        }
        if (visible > 0.0) light += visible * thrown;
        probing = false;
        if (i > last) break;
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
        bool arrives = most_of(incoming.light + through) > 1e-5;
        thrown = incoming.light * thrown_back(m, s.normal, incoming, view_direction) + through;
        thrown = arrives ? fraction * thrown : vec3(0.0);
        float least = (SHADOWED_PART * most_of(light) + SHADOWED_SHOWN / picture_look.x) / float(last + 1);
#ifdef DRAWS_SWARM
        if (i >= count) least = max(least, THIN_SHADOWED_MIN);
#endif
        // A light without shadows, or too weak for its shadow to be seen, needs no shadow ray.
        float t = incoming.shadow > 0.0 && most_of(thrown) >= least ? incoming.t : 0.0;
        float sharpness = clamp(1.0 / max(incoming.widening, 1e-4), SHARPNESS_MIN, SHARPNESS_MAX);
        ray = LightRay(shadow_origin(from, side, cone), incoming.direction, t, sharpness);
        shadow = incoming.shadow;
        KEEP_LIGHT(arrives ? incoming.light : vec3(0.0))
        i++;
    }
#ifdef TRANSLUCENT
    shadow_dims = 0.0;
#endif
    return light;
}
