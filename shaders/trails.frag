// Adds trails to the light of a scene: the last frame, warped, blurred and dimmed. The brighter of both is visible, so
// trails never add up.
//
// KEPT: writes the frame that becomes the next last frame, in fractions of the brightest light that is fed back.
// MIX: mixes two last frames instead.

#include "post_block.glsl"
#include "texel_lists.glsl"

uniform sampler2D picture;          // linear light; with MIX a last frame
uniform sampler2D last_frame;       // linear light in fractions of the brightest light

// The rules: decay, the radius of the blur across and up (0..1 is an eye's picture), the brightest light. Then the columns
// and rows of the grid, and of the eyes' pictures in the frame. Then 1 for a dome. Then the corners of the grid row
// by row: xy the place in the last frame (crates/render/src/gpu/trails.rs).
uniform NUMBER_LIST warp_grid;

layout(location = 0) out vec4 light;

vec2 corner(ivec2 at, int columns) {
    return TEXEL(warp_grid, 3 + at.y * (columns + 1) + at.x).xy;
}

// Columns and rows of the eyes' pictures in the frame, and the picture of this pixel's eye.
vec2 eye_parts;
vec2 eye_part;

// Returns the place in the eye's last picture that is visible at `place`.
vec2 warped(vec2 place) {
    ivec2 cells = ivec2(TEXEL(warp_grid, 1).xy);
    vec2 along = place * vec2(cells);
    ivec2 at = clamp(ivec2(along), ivec2(0), cells - 1);
    vec2 part = along - vec2(at);
    vec2 lower = mix(corner(at, cells.x), corner(at + ivec2(1, 0), cells.x), part.x);
    vec2 upper = mix(corner(at + ivec2(0, 1), cells.x), corner(at + ivec2(1, 1), cells.x), part.x);
    return mix(lower, upper, part.y);
}

vec3 last_light(vec2 place) {
    vec2 inside = step(abs(place - 0.5), vec2(0.5));
    vec2 edge = 0.5 * eye_parts / vec2(textureSize(last_frame, 0));
    vec2 own = (eye_part + clamp(place, edge, 1.0 - edge)) / eye_parts;
    return inside.x * inside.y * texture(last_frame, own).rgb;
}

// A tent of nine taps.
vec3 blurred(vec2 place, vec2 radius) {
    if (radius.y <= 0.0) return last_light(place);
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 9; i++) {
        vec2 to = vec2(i % 3 - 1, i / 3 - 1);
        sum += (2.0 - abs(to.x)) * (2.0 - abs(to.y)) * last_light(place + radius * to);
    }
    return sum / 16.0;
}

// Returns the fraction of the pixel that is in the circle of a dome; 1 in other pictures.
float in_dome(vec2 place) {
    vec2 size = 1.0 / (post_target.xy * eye_parts);
    float radius = 0.5 * min(size.x, size.y);
    float inside = clamp(radius - length((place - 0.5) * size) + 0.5, 0.0, 1.0);
    return mix(1.0, inside, TEXEL(warp_grid, 2).x);
}

void main() {
    vec4 own = texelFetch(picture, ivec2(gl_FragCoord.xy), 0);
#ifdef MIX
    light = mix(own, texture(last_frame, post_place()), post_target.z);
#else
    vec4 rules = TEXEL(warp_grid, 0);
    eye_parts = TEXEL(warp_grid, 1).zw;
    eye_part = floor(post_place() * eye_parts);
    vec2 place = post_place() * eye_parts - eye_part;
    vec3 trails = in_dome(place) * rules.x * rules.w * blurred(warped(place), rules.yz);
    vec3 both = max(own.rgb, trails);
#ifdef KEPT
    both = min(both / rules.w, vec3(1.0));
#endif
    light = vec4(both, 1.0);
#endif
}
