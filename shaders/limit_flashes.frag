// The finished picture, with those cells dimmed that would flash too often (src/flash/limiter.rs).

#include "encode.glsl"

uniform sampler2D picture;      // finished
uniform sampler2D corrections;  // of each cell: gain of linear light, share of grey, whether it is limited at all

layout(location = 0) out vec4 screen;

// The correction of a cell, or `own` if it is not limited: cells that do not flash must not affect those that do.
vec4 correction_of(vec2 cell, vec4 own) {
    ivec2 last = textureSize(corrections, 0) - 1;
    vec4 correction = texelFetch(corrections, clamp(ivec2(cell), ivec2(0), last), 0);
    return correction.z > 0.5 ? correction : own;
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    vec3 color = texelFetch(picture, texel, 0).rgb;
    vec2 place = gl_FragCoord.xy / vec2(textureSize(picture, 0)) * vec2(textureSize(corrections, 0));
    vec4 own = correction_of(floor(place), vec4(1.0, 0.0, 0.0, 0.0));
    // Interpolated between the centres of four cells.
    vec2 first = floor(place - 0.5);
    vec2 share = fract(place - 0.5);
    vec4 low = mix(correction_of(first, own), correction_of(first + vec2(1.0, 0.0), own), share.x);
    vec4 high = mix(correction_of(first + vec2(0.0, 1.0), own), correction_of(first + 1.0, own), share.x);
    vec4 correction = mix(low, high, share.y);
    vec3 light = linear_from_srgb(color);
    float grey = dot(light, vec3(0.2126, 0.7152, 0.0722));
    vec3 limited = srgb_from_linear(mix(light, vec3(grey), correction.y) * correction.x);
    screen = vec4(own.z > 0.5 ? limited : color, 1.0);
}
