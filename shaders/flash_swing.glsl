// The changes of a cell between peaks and valleys: src/flash/swing.rs, frame by frame on the GPU.

#include "flash_block.glsl"
#include "flash_rules.glsl"

// Beyond any light, and longer ago than anything that is remembered.
const float NEVER = 1e9;

// The value that a texture holds, or this if nothing is known of any picture before.
vec4 remembered(vec4 texel, vec4 at_first) {
    return flash_step.w > 0.5 ? at_first : texel;
}

float luminance(vec3 color) {
    return dot(color, vec3(0.2126, 0.7152, 0.0722));
}

// x the last change, 1 up, -1 down, 0 none; y the lowest, z the highest luminance since then.
const vec3 NO_SWING = vec3(0.0, NEVER, -NEVER);

// The change that a luminance makes, 1, -1 or 0 for none.
float light_change(inout vec3 swing, float light) {
    float low = min(swing.y, light);
    float high = max(swing.z, light);
    bool rises = light - low >= LIGHT_CHANGE && low < LIGHT_DARKER;
    bool falls = high - light >= LIGHT_CHANGE && light < LIGHT_DARKER;
    float change = falls && swing.x >= 0.0 ? -1.0 : (rises && swing.x <= 0.0 ? 1.0 : 0.0);
    swing = change != 0.0 ? vec3(change, light, light) : vec3(swing.x, low, high);
    return change;
}

// x 1 if the last change led to red, 0 if not, -1 before the first picture; yz the chromaticity since then that is
// farthest from where the next change leads.
const vec3 NO_RED_SWING = vec3(-1.0, 0.0, 0.0);

vec2 chromaticity(vec3 color) {
    vec3 rgb = color + FLARE;
    float x = dot(rgb, vec3(0.4124, 0.3576, 0.1805));
    float y = dot(rgb, vec3(0.2126, 0.7152, 0.0722));
    float z = dot(rgb, vec3(0.0193, 0.1192, 0.9505));
    return vec2(4.0 * x, 9.0 * y) / (x + 15.0 * y + 3.0 * z);
}

float red_change(inout vec3 swing, vec3 color) {
    vec2 now = chromaticity(color);
    float red = color.r > 0.0 && color.r >= RED_SHARE * (color.r + color.g + color.b) ? 1.0 : 0.0;
    bool first = swing.x < 0.0;
    bool changes = !first && red != swing.x && distance(now, swing.yz) > RED_CHANGE;
    float further = distance(now, RED) > distance(swing.yz, RED) ? 1.0 : 0.0;
    bool extreme = first || changes || further != swing.x;
    swing = vec3(first || changes ? red : swing.x, extreme ? now : swing.yz);
    return changes ? (red > 0.5 ? 1.0 : -1.0) : 0.0;
}

// How long ago the last six changes were, in seconds, the newest first.
struct Ages {
    vec4 newest;
    vec2 oldest;
};

Ages aged(vec4 newest, vec2 oldest) {
    return Ages(min(newest + flash_step.x, NEVER), min(oldest + flash_step.x, NEVER));
}

// Whether one more change makes as many within a second as begin one flash too many, if it is a rise.
bool are_enough(Ages ages) {
    return ages.oldest.y < 1.0 - flash_step.y - ROUNDING;
}

void note_change(inout Ages ages, float change) {
    if (change != 0.0) {
        ages = Ages(vec4(0.0, ages.newest.xyz), vec2(ages.newest.w, ages.oldest.x));
    }
}
