// A round of turning the gains that cells shall have on average into those at their centres, between which the
// picture's gain is linear: a cell's own gain counts for 9/16 of its mean, one beside it for 3/32, one at its corner
// for 1/64. The last round marks the cells whose mean would be too large whatever their own gain is.

#include "flash_rules.glsl"
// In the block: z how much of the error is taken back, w 1 in the last round.
#include "post_block.glsl"

uniform sampler2D corrections;      // so far; w the mean gain that is wanted

layout(location = 0) out vec4 correction;

// A gain as it is used.
float gain_of(float gain) {
    return post_target.w > 0.5 ? clamp(gain, 0.0, 1.0) : gain;
}

void main() {
    ivec2 cell = ivec2(gl_FragCoord.xy);
    ivec2 last = textureSize(corrections, 0) - 1;
    correction = texelFetch(corrections, cell, 0);
    if (correction.z < 0.5) {
        return;
    }
    float own = gain_of(correction.x);
    float mean = 0.0;
    for (int i = 0; i < 9; i++) {
        ivec2 step = ivec2(i % 3, i / 3) - 1;
        vec4 other = texelFetch(corrections, clamp(cell + step, ivec2(0), last), 0);
        float share = (step.x == 0 ? 0.75 : 0.125) * (step.y == 0 ? 0.75 : 0.125);
        // The own gain reaches to the edge of a neighbour that is not limited.
        mean += share * (other.z > 0.5 ? gain_of(other.x) : own);
    }
    correction.x = own + post_target.z * (correction.w - mean);
    correction.z = post_target.w > 0.5 && mean > correction.w + LEVEL_ERROR ? 2.0 : 1.0;
}
