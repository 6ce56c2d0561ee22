// Detects the changes of a cell between peaks and valleys, like tests/flash_twin/src/swing.rs.

#include "flash_block.glsl"
#include "flash_rules.glsl"

// A value above all luminances and ages that the limiter stores.
const float NEVER = 1e9;

// Returns the stored `texel`, or `at_first` if there is no earlier frame.
vec4 remembered(vec4 texel, vec4 at_first) {
    return flash_step.z > 0.5 ? at_first : texel;
}

float luminance(vec3 color) {
    return dot(color, vec3(0.2126, 0.7152, 0.0722));
}

// x: the last change: 1 up, -1 down, 0 none. y, z: the lowest and the highest luminance since that change. After a
// rise, y is the valley before the rise; after a fall, z is the peak before the fall.
const vec3 NO_SWING = vec3(0.0, NEVER, -NEVER);

// Returns the change that this luminance causes: 1, -1, or 0 for no change.
float light_change(inout vec3 swing, float light) {
    float low = swing.x > 0.0 ? swing.y : min(swing.y, light);
    float high = swing.x < 0.0 ? swing.z : max(swing.z, light);
    bool rises = light - low >= LIGHT_CHANGE && low < LIGHT_DARKER;
    bool falls = high - light >= LIGHT_CHANGE && light < LIGHT_DARKER;
    float change = falls && swing.x >= 0.0 ? -1.0 : (rises && swing.x <= 0.0 ? 1.0 : 0.0);
    swing = vec3(change != 0.0 ? change : swing.x, change < 0.0 ? light : low, change > 0.0 ? light : high);
    return change;
}

// True if the last change was too small to count so far, and may become large enough at this luminance.
bool may_count_only_at(vec3 swing, float light) {
    bool sure = swing.z - swing.y >= SURE_CHANGE && swing.y < SURE_DARKER;
    bool risen = swing.x > 0.0 && light - swing.y >= LIGHT_CHANGE && swing.y < LIGHT_DARKER;
    bool fallen = swing.x < 0.0 && swing.z - light >= LIGHT_CHANGE && light < LIGHT_DARKER;
    return !sure && (risen || fallen);
}

// x: 1 if the last change led to red, 0 if not, -1 before the first frame. UNSURE is added if an error of measurement
// may have caused the change. yz: the extreme chromaticity since then: after a change to red the nearest to red, else
// the farthest.
const vec3 NO_RED_SWING = vec3(-1.0, 0.0, 0.0);
const float UNSURE = 0.25;

vec2 chromaticity(vec3 color) {
    vec3 rgb = color + FLARE;
    float x = dot(rgb, vec3(0.4124, 0.3576, 0.1805));
    float y = dot(rgb, vec3(0.2126, 0.7152, 0.0722));
    float z = dot(rgb, vec3(0.0193, 0.1192, 0.9505));
    return vec2(4.0 * x, 9.0 * y) / (x + 15.0 * y + 3.0 * z);
}

float saturated_red(vec3 color, float fraction) {
    return color.r > 0.0 && color.r >= fraction * (color.r + color.g + color.b) ? 1.0 : 0.0;
}

float red_change(inout vec3 swing, vec3 color) {
    vec2 now = chromaticity(color);
    float red = saturated_red(color, RED_FRACTION);
    float last = floor(swing.x + 0.5);
    bool first = last < 0.0;
    float size = distance(now, swing.yz);
    bool changes = !first && red != last && size > RED_CHANGE;
    float further = distance(now, RED) > distance(swing.yz, RED) ? 1.0 : 0.0;
    bool extreme = first || changes || further != last;
    bool sure = first || size > SURE_RED_CHANGE && saturated_red(color, SURE_RED_FRACTION) == red;
    swing = vec3(first || changes ? red + (sure ? 0.0 : UNSURE) : swing.x, extreme ? now : swing.yz);
    return changes ? (red > 0.5 ? 1.0 : -1.0) : 0.0;
}

bool may_count_only_as_red(vec3 swing, vec3 color) {
    return swing.x == saturated_red(color, RED_FRACTION) + UNSURE;
}

// The ages of the last six changes in seconds, newest first.
struct Ages {
    vec4 newest;
    vec2 oldest;
};

Ages aged(vec4 newest, vec2 oldest) {
    return Ages(min(newest + flash_step.x, NEVER), min(oldest + flash_step.x, NEVER));
}

// True if one more rise would begin one flash too many within 1 s - `early`.
bool are_enough(Ages ages, float early) {
    return ages.oldest.y < 1.0 - early - ROUNDING;
}

// Seconds for which a rise marks a cell: HOLD if it would be one flash too many, EARLY if it is only too early, else 0.
float hold_after(Ages ages) {
    return are_enough(ages, EARLY) ? HOLD : (are_enough(ages, 0.0) ? EARLY : 0.0);
}

// True if this mark only means that a rise is delayed.
bool is_put_off(float hold) {
    return hold > 0.0 && hold <= EARLY + ROUNDING;
}

// True if a mark that lasts for these seconds began now.
bool is_fresh(float hold) {
    return is_put_off(hold) || hold >= FRESH;
}

// The seconds that are left of the last frame's mark. A delay ends with its frame.
float left_of(float hold) {
    hold -= flash_step.x;
    return is_put_off(hold) ? 0.0 : max(hold, 0.0);
}

// Records a change. If there is no change, `renews` sets the age of the last change to 0.
void note_change(inout Ages ages, float change, bool renews) {
    if (renews && change == 0.0) {
        ages.newest.x = 0.0;
    }
    if (change != 0.0) {
        ages = Ages(vec4(0.0, ages.newest.xyz), vec2(ages.newest.w, ages.oldest.x));
    }
}
