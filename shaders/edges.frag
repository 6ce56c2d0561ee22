// Keeps only pixels that differ visibly from their neighbours. These pixels get more samples: the stencil or the
// written mark selects them.

#include "picture_block.glsl"
#include "encode.glsl"
#include "pixel_key.glsl"

uniform sampler2D picture;

layout(location = 0) out float mark;

// Contrast from this value on is noise of rough mirrors.
const float ROUGH_CONTRAST = 0.02;
// The same limit for farther neighbours. It is higher because their colours differ even without noise.
const float FAR_ROUGH_CONTRAST = 0.06;

const int NEAREST = 4;
const int NEIGHBOURS = 12;
const ivec2 PLACES[NEIGHBOURS] = ivec2[](
    ivec2(1, 0), ivec2(-1, 0), ivec2(0, 1), ivec2(0, -1), ivec2(3, 1), ivec2(-3, -1), ivec2(-1, 3), ivec2(1, -3),
    ivec2(2, 2), ivec2(-2, -2), ivec2(-2, 2), ivec2(2, -2)
);

// The light of this pixel, and whether it or a neighbour has bright faint points.
vec3 own_light = vec3(1e9);
bool has_faint = false;

// Returns a pixel. Faint points of a neighbour, which make it brighter, are no contrast to this pixel.
vec4 seen(ivec2 texel, ivec2 limit) {
    vec4 sampled = texelFetch(picture, clamp(texel, ivec2(0), limit), 0);
    if (sampled.a >= 0.0) return sampled;
    has_faint = true;
    return vec4(min(sampled.rgb, own_light), faint_key(sampled.a));
}

vec3 shown(vec3 light) {
    vec3 exposed = picture_look.x * light;
    return exposed / (1.0 + exposed);
}

void look_around(ivec2 texel, ivec2 limit, int from, int to, inout vec4 low, inout vec4 high) {
    for (int i = from; i < to; i++) {
        vec4 other = seen(texel + PLACES[i], limit);
        low = min(low, other);
        high = max(high, other);
    }
}

// Approximates the visible difference in brightness. The mapping is monotonic, so the extremes of the colours are
// enough.
float contrast(vec4 low, vec4 high) {
    vec3 range = srgb_from_linear(shown(high.rgb)) - srgb_from_linear(shown(low.rgb));
    return max(range.r, max(range.g, range.b));
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    ivec2 limit = textureSize(picture, 0) - 1;
    vec4 low = seen(texel, limit);
    bool is_faint = has_faint;
    own_light = low.rgb;
    vec4 high = low;
    look_around(texel, limit, 0, NEAREST, low, high);
    bool is_edge = high.a - low.a > 0.5;
    // The edges of faint points are smooth already.
    if (has_faint && !is_edge && (is_faint || high.a < ROUGH_KEY)) discard;
    float least = is_edge ? picture_edges.x : picture_edges.y;
    if (contrast(low, high) >= (high.a >= ROUGH_KEY ? ROUGH_CONTRAST : least)) {
        mark = 1.0;
        return;
    }
    // Search farther neighbours for noise that the nearest pixels do not show.
    if (high.a < ROUGH_KEY) discard;
    look_around(texel, limit, NEAREST, NEIGHBOURS, low, high);
    if (contrast(low, high) < FAR_ROUGH_CONTRAST) discard;
    mark = 1.0;
}
