// Records values for the views (`view`) while a sample is computed, in the variant VIEWS; the macros are empty
// elsewhere.

#ifdef VIEWS
#include "view_scales.glsl"

layout(std140) uniform ViewBlock {
    vec4 view_choice;   // x the view (VIEW_...), y the view's parameter
    vec4 view_plane;    // the slice: unit normal into the frame, and the distance of the origin
};

// The surface that the ray hits first.
bool noted = false;
float noted_t = 0.0;
vec3 noted_p = vec3(0.0);
vec3 noted_normal = vec3(0.0);
float noted_open = 1.0;
bool has_noted_open = false;
int noted_object = 0;
// The light of the lamps without shadows, and the light that arrives despite shadows.
float noted_light = 0.0;
float noted_arrives = 0.0;

// Only the first surface is recorded, without haze and mirrors. The counts of evaluations cover the whole sample.
void note_surface(inout Surface s, float t, vec3 p) {
    if (noted) return;
    noted = true;
    noted_t = t;
    noted_p = p;
    noted_normal = s.normal;
    noted_object = s.object;
    if (view_choice.x != VIEW_CLAUSES) {
        s.material.haze = 0.0;
        s.material.reflect = 0.0;
    }
}

void note_light(vec3 light, float visible) {
    float amount = dot(light, vec3(1.0));
    noted_light += amount;
    noted_arrives += amount * visible;
}

void note_open(float open) {
    if (!has_noted_open) noted_open = open;
    has_noted_open = true;
}

#define NOTE_SURFACE(s, t, p) note_surface(s, t, p)
#define NOTE_OPEN(open) note_open(open)
#define SHOWS_OPEN true
#define NOTED_LIGHT vec3 arrived = vec3(0.0);
#define KEEP_LIGHT(light) arrived = light;
#define NOTE_LIGHT(visible) note_light(arrived, visible)
// The step of the central differences for normals.
#define CHOSEN_TAP(h) (view_choice.x == VIEW_NORMALS && view_choice.y > 0.0 ? view_choice.y : (h))
#else
#define NOTE_SURFACE(s, t, p)
#define NOTE_OPEN(open)
#define SHOWS_OPEN false
#define NOTED_LIGHT
#define KEEP_LIGHT(light)
#define NOTE_LIGHT(visible)
#define CHOSEN_TAP(h) (h)
#endif
