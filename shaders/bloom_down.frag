// Halves a bloom level with thirteen taps, which form five overlapping boxes of four taps (Jimenez 2014). With FIRST,
// bright boxes get less weight, so that a pixel much brighter than its surroundings does not cause a flickering glow.

#include "post_block.glsl"
#include "sample_light.glsl"

uniform sampler2D picture;          // twice as large

layout(location = 0) out vec4 smaller;

vec3 tap(vec2 place, vec2 texel, float x, float y) {
    return texture(picture, place + texel * vec2(x, y)).rgb;
}

// Returns the weighted mean of four taps. Alpha is the weight.
vec4 weighed(vec3 sum, float fraction) {
    vec3 mean = 0.25 * sum;
#ifdef FIRST
    fraction *= sample_weight(mean);
#endif
    return vec4(mean * fraction, fraction);
}

void main() {
    vec2 place = post_place();
    vec2 texel = 1.0 / vec2(textureSize(picture, 0));
    vec3 inner = tap(place, texel, -1.0, -1.0) + tap(place, texel, 1.0, -1.0) + tap(place, texel, -1.0, 1.0)
        + tap(place, texel, 1.0, 1.0);
    vec3 middle = tap(place, texel, 0.0, 0.0);
    vec3 left = tap(place, texel, -2.0, 0.0);
    vec3 right = tap(place, texel, 2.0, 0.0);
    vec3 below = tap(place, texel, 0.0, -2.0);
    vec3 above = tap(place, texel, 0.0, 2.0);
    vec4 sum = weighed(inner, 0.5);
    sum += weighed(middle + left + below + tap(place, texel, -2.0, -2.0), 0.125);
    sum += weighed(middle + right + below + tap(place, texel, 2.0, -2.0), 0.125);
    sum += weighed(middle + left + above + tap(place, texel, -2.0, 2.0), 0.125);
    sum += weighed(middle + right + above + tap(place, texel, 2.0, 2.0), 0.125);
    smaller = vec4(min(sum.rgb / sum.a, LIGHT_MAX), 1.0);
}
