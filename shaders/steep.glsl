// Rays through formulas that are no distance functions, in the variant STEEP. Each cell of the tree (regions.glsl) knows
// how steep the formula may be inside (src/region/gradient.rs), so a step that cannot pass a surface is known, too: the
// value over the rate at which it can fall along the ray, or up to the cell's face.

// Steps of a ray, grazing ones counted in, and rounds that close in on where the sign changed.
const int STEEP_STEPS_MAX = 512;
const int CLOSINGS_MAX = 6;
// The smallest step, as a share of the radius of the pixel's cone: nothing that is seen is thinner.
const float STEEP_STEP_MIN = 0.5;
// So close is close enough to where the sign changes, as a share of the same.
const float CLOSE_ENOUGH = 0.05;

// Bounds of the gradient.
struct Slopes {
    vec3 low;
    vec3 high;
};

// The bounds in the words .z and .w of a cell: shares of one scale, whole numbers over 128.
Slopes unpack_slopes(uvec2 words) {
    ivec2 signed_words = ivec2(words);
    float unit = uintBitsToFloat(words.y & 0xFFFF0000u) / 128.0;
    vec3 low = vec3((signed_words.x << 24) >> 24, (signed_words.x << 16) >> 24, (signed_words.x << 8) >> 24);
    vec3 high = vec3(signed_words.x >> 24, (signed_words.y << 24) >> 24, (signed_words.y << 16) >> 24);
    return Slopes(low * unit, high * unit);
}

// The largest rate at which the value can fall along a direction.
float slope_towards(Slopes slopes, vec3 direction) {
    vec3 falls = max(-slopes.low * direction, -slopes.high * direction);
    return falls.x + falls.y + falls.z;
}

// What the value is divided by to be no more than a distance.
float steepness(Slopes slopes) {
    return max(length(max(abs(slopes.low), abs(slopes.high))), 1e-12);
}
