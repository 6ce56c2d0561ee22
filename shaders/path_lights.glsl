// Lights as things with a surface: balls, discs in the sky, rectangles. Paths sample directions towards them, and also
// meet them by chance.
//
// The raster (light.glsl) gives the same light as these in the limit of small, distant lights. It approximates three
// things: a lamp or sun shines from its middle, so that a large ball below the horizon is cut off too early; a highlight
// and a shadow are blurred by the light's width without its exact outline; a panel's light is exact, but its highlight is
// that of its nearest point, and a part of it below the horizon is subtracted.

// The radius of lamps and the angular radius of suns without a width.
const float LAMP_RADIUS_MIN = 0.01;
const float SUN_WIDTH_MIN = 1e-3;

// What a ray meets at a light.
struct LightPoint {
    float t;            // distance along the ray; negative if the ray misses the light
    vec3 radiance;
    float density;      // of this direction, among directions drawn towards the light
    float shadow;       // fraction that shadows remove
};

const LightPoint NO_LIGHT = LightPoint(-1.0, vec3(0.0), 0.0, 0.0);

float lamp_radius2(vec4 color) {
    float radius = max(color.w, LAMP_RADIUS_MIN);
    return radius * radius;
}

// The squared sine of the angle that a sun's radius fills.
float sun_sine2(vec4 color) {
    float width = max(color.w, SUN_WIDTH_MIN);
    return width * width / (1.0 + width * width);
}

// 1 - cosine of an angle with this squared sine. A difference would lose all digits of small angles.
float rise_of(float sine2) {
    return sine2 / (1.0 + sqrt(max(1.0 - sine2, 0.0)));
}

// Returns about how bright a light is at `origin`, to choose one among all lights. It depends on nothing else, so that a
// ray that meets the light by chance knows the same choice.
float light_share(int number, vec3 origin) {
    vec4 place = lights[4 * number];
    vec4 color = lights[4 * number + 1];
    vec4 right = lights[4 * number + 2];
    float bright = brightness_of(color.rgb);
    if (place.w == LIGHT_SUN) return bright;
    vec3 way = place.xyz - origin;
    float distance2 = dot(way, way);
    float fade = faded(sqrt(distance2), right.w);
#ifdef PANELS
    if (place.w == LIGHT_PANEL) {
        vec3 facing = cross(right.xyz, lights[4 * number + 3].xyz);
        float area = 4.0 * length(facing);
        return dot(way, facing) < 0.0 ? bright * fade * area / max(distance2, 0.25 * area) : 0.0;
    }
#endif
    return bright * fade / max(distance2, lamp_radius2(color));
}

// Returns the point of a light on a ray. With `aimed`, the ray was drawn towards the light, so that it never misses.
LightPoint light_on_ray(int number, vec3 origin, vec3 direction, bool aimed) {
    vec4 place = lights[4 * number];
    vec4 color = lights[4 * number + 1];
    vec4 right = lights[4 * number + 2];
    vec4 up = lights[4 * number + 3];
    vec3 middle = place.xyz - origin;
#ifdef PANELS
    if (place.w == LIGHT_PANEL) {
        vec3 facing = cross(right.xyz, up.xyz);
        float quarter = max(length(facing), 1e-12);
        facing /= quarter;
        float before = -dot(middle, facing);
        float slope = -dot(direction, facing);
        if (!(before > 0.0 && slope > 1e-6)) return NO_LIGHT;
        float t = before / slope;
        vec3 off = t * direction - middle;
        // Not only for rectangles: the sides of a panel may be at any angle.
        vec2 at = vec2(dot(cross(off, up.xyz), facing), dot(cross(right.xyz, off), facing)) / quarter;
        if (!aimed && max(abs(at.x), abs(at.y)) > 1.0) return NO_LIGHT;
        return LightPoint(t, color.rgb * faded(length(middle), right.w), t * t / (4.0 * quarter * slope), up.w);
    }
#endif
    bool sun = place.w == LIGHT_SUN;
    vec3 way = sun ? -normalize(place.xyz) : middle;
    float distance2 = sun ? 1.0 : dot(way, way);
    float radius2 = sun ? sun_sine2(color) : lamp_radius2(color);
    float along = dot(direction, way);
    vec3 beside = cross(direction, way);
    float depth = radius2 - dot(beside, beside);
    bool inside = distance2 <= radius2;
    if (!aimed && !(depth >= 0.0 && (along > 0.0 || inside))) return NO_LIGHT;
    float half_chord = sqrt(max(depth, 0.0));
    LightPoint met;
    met.t = sun ? SUN_DISTANCE : max(inside ? along + half_chord : along - half_chord, 0.0);
    met.radiance = color.rgb * ((sun ? 1.0 : faded(sqrt(distance2), right.w)) / (PI * radius2));
    met.density = 1.0 / (inside ? 4.0 * PI : 2.0 * PI * rise_of(radius2 / distance2));
    met.shadow = up.w;
    return met;
}

// Two directions at right angles to a normal and to each other (Duff et al. 2017).
void basis_of(vec3 normal, out vec3 side, out vec3 other) {
    float s = normal.z >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (s + normal.z);
    float b = normal.x * normal.y * a;
    side = vec3(1.0 + s * normal.x * normal.x * a, s * b, -s * normal.x);
    other = vec3(b, s + normal.y * normal.y * a, -normal.y);
}

// Returns a direction around an axis: `rise` is 1 - the cosine of its angle to the axis.
vec3 around(vec3 axis, float rise, float turn) {
    vec3 side;
    vec3 other;
    basis_of(axis, side, other);
    float sine = sqrt(max(rise * (2.0 - rise), 0.0));
    return normalize(axis * (1.0 - rise) + (side * cos(2.0 * PI * turn) + other * sin(2.0 * PI * turn)) * sine);
}

// Returns a random direction towards a light.
vec3 towards_light(int number, vec3 origin, vec2 random) {
    vec4 place = lights[4 * number];
    vec4 color = lights[4 * number + 1];
    vec3 middle = place.xyz - origin;
#ifdef PANELS
    if (place.w == LIGHT_PANEL) {
        vec2 at = 2.0 * random - 1.0;
        return normalize(middle + at.x * lights[4 * number + 2].xyz + at.y * lights[4 * number + 3].xyz);
    }
#endif
    bool sun = place.w == LIGHT_SUN;
    vec3 way = sun ? -place.xyz : middle;
    float distance2 = max(dot(way, way), 1e-12);
    float sine2 = sun ? sun_sine2(color) : lamp_radius2(color) / distance2;
    float rise = sine2 >= 1.0 ? 2.0 : rise_of(sine2);
    return around(way * inversesqrt(distance2), random.x * rise, random.y);
}
