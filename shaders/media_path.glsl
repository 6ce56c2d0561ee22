// The medium that a path sees: on the ray of the eye and, after mirrors and glass, on the next ray through air.

#if defined(MEDIA) && !defined(VIEWS)
#define DRAWS_MEDIA
#include "media.glsl"

const int SEGMENTS_MAX = 2;
SeenMedium path_medium = SeenMedium(vec3(0.0), 1.0, 1.0, FAR);
// The number of rays through air so far, and the number of this ray among them.
int air_segments = 0;
int medium_segment = 0;

// Adds the medium before the end of the ray: its light in the pass of media, what it leaves of mirrored light elsewhere.
void meet_medium(inout EyePath path, float end) {
    // There is no medium in glass.
    medium_segment = ray_side > 0.0 ? air_segments++ : SEGMENTS_MAX;
    if (medium_segment >= SEGMENTS_MAX) {
    } else if (is_medium_pass()) {
        vec4 along = medium_along(path.origin, path.direction, end, cone_of(path), medium_pattern());
        path.color += path.throughput * along.rgb;
        path.throughput *= along.a;
        if (medium_segment == 0) {
            path_medium.left = along.a;
            path_medium.end = end;
        } else {
            path_medium.left_of_mirrored = along.a;
        }
    } else if (medium_segment == 0) {
        path_medium = medium_seen(sample_place(), end);
    } else {
        path.throughput *= path_medium.left_of_mirrored;
    }
}

// True in the pass of media after the last ray on which media are drawn.
bool medium_is_known() {
    return is_medium_pass() && medium_segment == SEGMENTS_MAX - 1;
}

void end_medium() {
    air_segments = SEGMENTS_MAX;
}

// Returns the light behind the medium with the medium, or what covers the background.
vec3 seen_through_medium(vec3 color) {
    if (is_medium_pass()) return color;
#ifdef COVERAGE
    return 1.0 - path_medium.left * (1.0 - color);
#else
    return path_medium.left * color + path_medium.light;
#endif
}

// Results of the pass of media: the distance at which the ray ends, with the fraction that is left of mirrored light in
// the last bits, and the fraction that is left of the light behind the medium.
#define MEDIUM_RAY packed_end(path_medium)
#define MEDIUM_LEFT path_medium.left
#else
void meet_medium(inout EyePath path, float end) {}

bool medium_is_known() {
    return false;
}

void end_medium() {}

vec3 seen_through_medium(vec3 color) {
    return color;
}

#define MEDIUM_RAY 0.0
#define MEDIUM_LEFT 1.0
#endif
