// Interpolates a finished frame between its pixels by Catmull-Rom splines.

uniform sampler2D picture;      // finished

// Returns the weights of four pixels around a position that is `t` beyond the second pixel.
vec4 weights(float t) {
    return vec4(
        t * (-0.5 + t * (1.0 - 0.5 * t)),
        1.0 + t * t * (1.5 * t - 2.5),
        t * (0.5 + t * (2.0 - 1.5 * t)),
        t * t * (0.5 * t - 0.5));
}

vec3 enlarged(vec2 at) {
    ivec2 size = textureSize(picture, 0);
    ivec2 limit = size - 1;
    vec2 place = at * vec2(size) - 0.5;
    vec2 first = floor(place);
    vec4 across = weights(place.x - first.x);
    vec4 upwards = weights(place.y - first.y);
    vec3 sum = vec3(0.0);
    vec3 low = vec3(1.0);
    vec3 high = vec3(0.0);
    for (int y = 0; y < 4; y++) {
        for (int x = 0; x < 4; x++) {
            ivec2 texel = clamp(ivec2(first) + ivec2(x, y) - 1, ivec2(0), limit);
            vec3 color = texelFetch(picture, texel, 0).rgb;
            sum += across[x] * upwards[y] * color;
            bool near = (x == 1 || x == 2) && (y == 1 || y == 2);
            low = near ? min(low, color) : low;
            high = near ? max(high, color) : high;
        }
    }
    // Clamp to the range of the nearest four pixels, so that edges get no rims.
    return clamp(sum, low, high);
}
