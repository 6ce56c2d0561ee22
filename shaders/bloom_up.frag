// Doubles the size of a bloom level with a tent filter of nine taps (Jimenez 2014) and blends the result into the
// target.

#include "post_block.glsl"

uniform sampler2D picture;          // half as large

layout(location = 0) out vec4 larger;

void main() {
    vec2 place = post_place();
    vec2 texel = 1.0 / vec2(textureSize(picture, 0));
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 9; i++) {
        vec2 step = vec2(i % 3 - 1, i / 3 - 1);
        sum += (2.0 - abs(step.x)) * (2.0 - abs(step.y)) * texture(picture, place + texel * step).rgb;
    }
    larger = vec4(sum / 16.0, 1.0);
}
