// Draws a finished frame into a window. The frame is cropped, mirrored, and warped so that its corners are at four
// given points. The rest of the window is black.

#include "post_block.glsl"
#include "place_block.glsl"
#include "enlarge.glsl"

layout(location = 0) out vec4 screen;

// A window pixel is the mean of at most this number of frame pixels along each side.
const int TAPS_MAX = 8;

// Returns the covered fraction of a pixel, given its distance to an edge in pixels.
float inside(float pixels) {
    return clamp(pixels + 0.5, 0.0, 1.0);
}

void main() {
    vec3 here = vec3(post_place(), 1.0);
    vec3 led = vec3(dot(place_rows[0].xyz, here), dot(place_rows[1].xyz, here), dot(place_rows[2].xyz, here));
    vec2 place = led.xy / max(led.z, 1e-6);
    vec2 step = max(fwidth(place), vec2(1e-9));
    vec2 low = (place - place_part.xy) / step;
    vec2 high = (place_part.zw - place) / step;
    float cover = inside(low.x) * inside(low.y) * inside(high.x) * inside(high.y);
    if (led.z <= 0.0 || cover <= 0.0) {
        screen = vec4(0.0, 0.0, 0.0, 1.0);
        return;
    }
    ivec2 size = textureSize(picture, 0);
    ivec2 taps = ivec2(clamp(ceil(step * vec2(size) - 0.5), vec2(1.0), vec2(float(TAPS_MAX))));
    vec3 color = vec3(0.0);
    if (taps == ivec2(1)) {
        color = enlarged(place);
    } else {
        // Compute the mean of the frame's pixels under a pixel of the window.
        for (int y = 0; y < taps.y; y++) {
            for (int x = 0; x < taps.x; x++) {
                vec2 at = place + step * ((vec2(float(x), float(y)) + 0.5) / vec2(taps) - 0.5);
                color += texelFetch(picture, clamp(ivec2(at * vec2(size)), ivec2(0), size - 1), 0).rgb;
            }
        }
        color /= float(taps.x * taps.y);
    }
    screen = vec4(color * cover, 1.0);
}
