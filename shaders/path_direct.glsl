// The light of lights where a path scatters, by rays towards them and by rays that meet them by chance.

// How light is found: the first one in pictures, the others in tests of it.
const int SAMPLE_BOTH = 0;
const int SAMPLE_LIGHTS = 1;
const int SAMPLE_LOBES = 2;

// Shadows of paths have no penumbra: a path samples the light's width.
const float SHARPEST = 1e5;

float vertex_density(Vertex at, vec3 to) {
    if (at.is_medium) return scattering(at.phase, dot(at.lobes.direction, to));
    return lobe_density(at.lobes, to);
}

vec3 vertex_reflectance(Vertex at, vec3 to) {
    if (at.is_medium) return at.kept * scattering(at.phase, dot(at.lobes.direction, to));
    return lobe_reflectance(at.lobes, to);
}

// The weight of a direction that was drawn with the density `own` and could have been drawn with `other`.
float weight_of(float own, float other) {
    float ratio = other / max(own, 1e-30);
    return 1.0 / (1.0 + ratio * ratio);
}

int last_light() {
    return min(int(frame_clock.y), LIGHTS_MAX) - 1;
}

float all_shares(vec3 origin) {
    float sum = 0.0;
    for (int i = 0; i <= last_light(); i++) sum += light_share(i, origin);
    return sum;
}

// Returns the light of all lights that a ray meets by chance before `end`, or behind surfaces that do not stop all of it.
vec3 lights_met(Path path, float end, bool is_scattered) {
    vec3 sum = vec3(0.0);
    float shares = all_shares(path.origin);
    for (int i = 0; i <= last_light(); i++) {
        LightPoint met = light_on_ray(i, path.origin, path.direction, false);
        float share = light_share(i, path.origin);
        if (!(met.t >= 0.0) || !(share > 0.0)) continue;
        float passing = met.t < end ? 1.0 : is_scattered ? 0.0 : 1.0 - met.shadow;
        float weight = path_sampling == SAMPLE_LOBES ? 1.0 : weight_of(path.density, met.density * share / shares);
        sum += met.radiance * (passing * weight);
    }
    return path_sampling == SAMPLE_LIGHTS ? vec3(0.0) : sum;
}

// Returns the light of one light at a place, whose choice `random` is.
vec3 light_sampled(Vertex at, float cone, float random, vec2 direction_random) {
    float shares = all_shares(at.origin);
    if (!(shares > 0.0) || path_sampling == SAMPLE_LOBES) return vec3(0.0);
    float before = 0.0;
    int chosen = 0;
    float chosen_share = 0.0;
    for (int i = 0; i <= last_light(); i++) {
        float share = light_share(i, at.origin);
        if (share > 0.0 && before <= random * shares) {
            chosen = i;
            chosen_share = share;
        }
        before += share;
    }
    vec3 to = towards_light(chosen, at.origin, direction_random);
    LightPoint point = light_on_ray(chosen, at.origin, to, true);
    float density = point.density * chosen_share / shares;
    if (!(density > 0.0) || point.t < 0.0) return vec3(0.0);
    float weight = path_sampling == SAMPLE_LIGHTS ? 1.0 : mix(1.0, weight_of(density, vertex_density(at, to)), at.lobed);
    vec3 thrown = vertex_reflectance(at, to);
    // The part that rays find by chance.
    vec3 met = thrown * (1.0 - weight);
    vec3 normal = at.is_medium ? vec3(0.0) : at.lobes.normal;
#ifdef TRANSLUCENT
    // Light through the body, as in the raster. No ray meets it by chance.
    Material m = at.lobes.material;
    if (!at.is_medium) thrown += m.color * (0.5 * m.translucent / PI);
    shadow_dims = !at.is_medium && m.translucent > 0.0 ? 1.0 / max(m.depth, 1e-3) : 0.0;
    normal *= dot(normal, to) < 0.0 ? -1.0 : 1.0;
#endif
    vec3 light = finite_light(thrown * point.radiance / density);
    if (brightness_of(light) <= 0.0) return vec3(0.0);
    vec3 light_met = finite_light(met * point.radiance / density);
    float t = point.shadow > 0.0 ? point.t : 0.0;
    int rays = t > 0.0 ? shadow_rays(brightness_of(light_met), brightness_of(light)) : 1;
    float visible = 0.0;
    float visible_met = 0.0;
    for (int i = 0; i < rays; i++) {
        penumbra_growth = i == 0 ? 1.0 / SHARPNESS_MAX : 0.0;
        LightRay ray = LightRay(shadow_origin(at.origin, normal, cone), to, t, SHARPEST);
        visible_met = mix(1.0, light_visibility(ray, false), point.shadow);
        if (i == 0) visible = visible_met;
        if (visible <= 0.0) break;
    }
#ifdef TRANSLUCENT
    shadow_dims = 0.0;
#endif
    light = light * visible - light_met * visible_met;
    if (brightness_of(light) > 0.0) light *= left_by_media(at.origin, to, point.t);
    return light;
}
