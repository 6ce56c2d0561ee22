// The results of the pass of media (media.glsl), in texels of 2 x 2 pixels of the frame.

uniform sampler2D medium_light;     // light, and the fraction of the light behind the medium that is left
uniform sampler2D medium_end;       // the distance at which the ray ends; the last bits: what is left of mirrored light

const uint LEFT_BITS = 255u;
// Rays that differ by this much in their optical thickness get half of the weight.
const float THICKNESS_BLUR = 0.04;
// Media that emit light without dimming any are as thick as media of this density.
const float GLOWING_DENSITY = 0.05;

struct SeenMedium {
    vec3 light;
    float left;             // fraction of the light behind the medium
    float left_of_mirrored; // fraction of light behind the medium that the first mirror shows
    float end;              // distance at which the ray ends
};

SeenMedium medium_texel(ivec2 texel) {
    ivec2 place = clamp(texel, ivec2(0), textureSize(medium_light, 0) - 1);
    uint bits = floatBitsToUint(texelFetch(medium_end, place, 0).r);
    vec4 light = texelFetch(medium_light, place, 0);
    return SeenMedium(light.rgb, light.a, float(bits & LEFT_BITS) / float(LEFT_BITS), uintBitsToFloat(bits & ~LEFT_BITS));
}

float packed_end(SeenMedium seen) {
    uint left = uint(float(LEFT_BITS) * clamp(seen.left_of_mirrored, 0.0, 1.0) + 0.5);
    return uintBitsToFloat((floatBitsToUint(seen.end) & ~LEFT_BITS) | left);
}

// Adds a texel to a weighted sum for a ray like `own`. Returns its weight, which is lower if the media between both ends
// may matter: if they may be thick, and light gets to the nearer end.
float add_medium(inout SeenMedium sum, SeenMedium other, SeenMedium own, float weight) {
    float off = max(medium_grid_scale.w, GLOWING_DENSITY) * (other.end - own.end) * (1.0 / THICKNESS_BLUR);
    off *= other.end < own.end ? other.left : own.left;
    // Not 0 in the sum, so that a ray without similar neighbours has a medium too.
    weight *= 1.0 / (1.0 + min(off * off, 1e6));
    sum.light += weight * other.light;
    sum.left += weight * other.left;
    sum.left_of_mirrored += weight * other.left_of_mirrored;
    return weight;
}

SeenMedium mean_medium(SeenMedium sum, float weights, float end) {
    float scale = 1.0 / max(weights, 1e-9);
    return SeenMedium(sum.light * scale, sum.left * scale, sum.left_of_mirrored * scale, end);
}
