// The scene of the thesis, by hand: two wooden speakers with a mallard each, woofers that grow with the volume
// of their channel, a bridge between them, 32 bars of spectrum. The mirror floor y = 0 is a plane that the
// tracer solves exactly, so it is not part of the distance.
//
// Units: a speaker is 4.4 wide and 6.4 high. Distances are exact or lower bounds (Lipschitz constant 1).

#include "distance.glsl"

const int SKY = 0;
const int FLOOR = 1;
const int SPEAKER = 2;
const int BAR = 3;

const float FLOOR_HEIGHT = 0.0;
// All surfaces lie inside this box.
const vec3 BOUNDS_MIN = vec3(-7.2, 0.0, 7.8);
const vec3 BOUNDS_MAX = vec3(7.2, 6.4, 12.2);

const vec3 SPEAKER_CENTRE = vec3(5.0, 3.2, 10.0);
const vec3 CABINET_HALF = vec3(2.0, 3.0, 2.0);
const float CABINET_ROUNDING = 0.2;

const float BAR_SPACING = 0.16;
const float BAR_HALF_WIDTH = 0.055;
const float BAR_HALF_DEPTH = 0.09;
const float BAR_Z = 8.7;
const float BAR_HEIGHT = 3.4;

// Mean |sample| of music is 0.05 to 0.3: a saturating curve brings it to 0..1.
float loudness(float volume) {
    return 1.0 - exp(-5.0 * volume);
}

// The woofer's dish is cut out by a sphere whose centre lies before the front; x its radius, y the radius of the
// rim it leaves on the front.
const float WOOFER_Y = -1.2;
const float WOOFER_LEAD = 0.55;

float woofer_radius(float side) {
    return 1.3 + 0.45 * loudness(side < 0.0 ? sound.x : sound.y);
}

// Radius of the bridge at x: never negative, thicker when loud, with a standing wave on it.
float bridge_radius(float x) {
    float loud = loudness(0.5 * (sound.x + sound.y));
    return 0.2 + 0.22 * loud + 0.09 * loud * cos(3.4 * x) * cos(2.0 * camera_right.w);
}

float speakers_distance(vec3 p) {
    // The two speakers mirror each other; only the loudness differs.
    vec3 q = vec3(abs(p.x), p.yz) - SPEAKER_CENTRE;
    float cabinet = round_box(q, CABINET_HALF, CABINET_ROUNDING);

    // The bridge: a rod along x from cabinet to cabinet, blended into them. 0.93 pays for the wave's slope.
    float rod = 0.93 * (length(p.yz - vec2(4.55, 10.0)) - bridge_radius(p.x));
    float bridge = max(rod, abs(p.x) - 3.6);
    float body = smooth_min(cabinet, bridge, 1.1);

    float front = -CABINET_HALF.z - CABINET_ROUNDING;
    vec3 w = q - vec3(0.0, WOOFER_Y, front);
    float r = woofer_radius(p.x);
    float dish = length(w + vec3(0.0, 0.0, WOOFER_LEAD)) - r;
    body = smooth_subtract(body, dish, 0.16);
    // The dust cap rides on the dish's bottom.
    float cap = length(w - vec3(0.0, 0.0, r - WOOFER_LEAD)) - 0.36;
    return smooth_min(body, cap, 0.12);
}

int bar_index(float x) {
    return int(clamp(floor(x / BAR_SPACING) + 16.0, 0.0, 31.0));
}

float bar_distance(vec3 p, int index) {
    float height = 0.04 + BAR_HEIGHT * band(index);
    vec3 centre = vec3((float(index) - 15.5) * BAR_SPACING, 0.5 * height, BAR_Z);
    return round_box(p - centre, vec3(BAR_HALF_WIDTH, 0.5 * height, BAR_HALF_DEPTH) - 0.02, 0.02);
}

// What is known about the surfaces near a point: bound <= distance <= estimate.
struct Nearest {
    float bound;        // as far as a ray may step
    float estimate;     // the distance to a surface that is there: penumbras and occlusion trust this alone
    int object;         // what that surface belongs to
};

// Another bar than the two measured ones is at least so far away.
const float BAR_REACH = 1.5 * BAR_SPACING - BAR_HALF_WIDTH;

// `penumbra` is the distance from which on a surface casts no shadow here, else 0. Beyond their reach the bars'
// distance is that of the wrong bar half of the time, so their penumbra ends there: else their shadows are serrated.
Nearest scene_nearest(vec3 p, float penumbra) {
    float speakers = speakers_distance(p);
    // Of the 32 bars the two nearest in x are measured. Another one can be no nearer than the box around all,
    // nor than two places away.
    int first = bar_index(p.x);
    float centre = (float(first) - 15.5) * BAR_SPACING;
    int second = clamp(first + (p.x > centre ? 1 : -1), 0, 31);
    float bars = min(bar_distance(p, first), bar_distance(p, second));
    float around = box(p - vec3(0.0, 0.5 * (BAR_HEIGHT + 0.04), BAR_Z),
                       vec3(16.0 * BAR_SPACING, 0.5 * (BAR_HEIGHT + 0.04), BAR_HALF_DEPTH));
    float others = max(around, BAR_REACH);
    int object = bars < speakers ? BAR : SPEAKER;
    float estimate = min(speakers, bars * max(1.0, penumbra / BAR_REACH));
    return Nearest(min(speakers, min(bars, others)), estimate, object);
}
