// Normals by central differences on a tetrahedron, four taps (Abt 2022, section 3.1).
const vec4 TAPS_X = vec4(1.0, -1.0, -1.0, 1.0);
const vec4 TAPS_Y = vec4(-1.0, -1.0, 1.0, 1.0);
const vec4 TAPS_Z = vec4(-1.0, 1.0, -1.0, 1.0);

// Distance of the taps from the point, proportional to the pixel's cone.
float tap_distance(float cone) {
    return CHOSEN_TAP(max(0.6 * cone, 4e-4));
}

// Returns the normal from the sum of the taps. Each tap is multiplied by its distance value.
vec3 normal_of(vec3 sum) {
    float size = length(sum);
    return size > 1e-12 && size < 1e12 ? sum / size : vec3(0.0, 1.0, 0.0);
}

vec3 sum_of_taps(vec4 d) {
    return vec3(dot(TAPS_X, d), dot(TAPS_Y, d), dot(TAPS_Z, d));
}

// Converts a value near the shaded point to a distance. A value that is not a distance is divided by its slope at that
// point. For a point on a plane the slope is unknown, so only the value's sign is used.
#ifdef NON_LIPSCHITZ
float slope_here = 1e-9;
#define NOTE_SLOPE(sum, h) slope_here = max(length(sum) / (4.0 * (h)), 1e-9)
#define NOTE_PLANE slope_here = 1e-9
#define AS_DISTANCE(value) ((value) / slope_here)
#else
#define NOTE_SLOPE(sum, h)
#define NOTE_PLANE
#define AS_DISTANCE(value) (value)
#endif
