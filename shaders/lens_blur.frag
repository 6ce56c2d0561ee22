// Depth of field: adds up the light of all discs that reach a pixel. A disc's brightness is the light of its point,
// divided by the disc's area. Discs behind a sharp point do not cover it. Alpha is the fraction of discs in front.

#include "post_block.glsl"

uniform sampler2D picture;          // light; alpha the radius of the disc, negative in front of the sharp distance

layout(location = 0) out vec4 blurred;

const float PI = 3.14159265;
const float GOLDEN_ANGLE = 2.39996323;
const int TAPS_MAX = 80;

// Returns the fraction of a disc that covers an area. Radius and area are in pixels.
float fraction_of(float area, float radius) {
    return min(1.0, area / (PI * radius * radius + 1e-6));
}

void main() {
    vec2 place = post_place();
    float reach = post_target.z;    // the largest radius
    int taps = int(post_target.w);
    vec4 own = texture(picture, place);
    float weight = fraction_of(1.0, own.a);
    vec4 sum = vec4(own.rgb * weight, weight);
    float front = 0.0;
    for (int i = 0; i < TAPS_MAX; i++) {
        if (i >= taps) break;
        // The taps form a spiral, which is denser in the middle. Each tap represents a part of a ring.
        float u = (float(i) + 0.5) / float(taps);
        float radius = reach * pow(u, 0.6);
        float area = 1.2 * PI * reach * reach * pow(u, 0.2) / float(taps);
        float angle = GOLDEN_ANGLE * float(i);
        vec4 other = texture(picture, place + post_target.xy * radius * vec2(cos(angle), sin(angle)));
        bool behind = other.a > own.a;
        float spread = behind ? min(abs(other.a), abs(own.a)) : abs(other.a);
        float reached = clamp(0.7 * (spread - radius) + 0.5, 0.0, 1.0) * fraction_of(area, spread);
        sum += vec4(other.rgb, 1.0) * reached;
        if (other.a < min(own.a, 0.0) - 0.5) front += reached;
    }
    blurred = vec4(sum.rgb / sum.a, clamp(front, 0.0, 1.0));
}
