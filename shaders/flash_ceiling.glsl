// Dims light below the ceilings of cells (`flash::limiter`).

#include "flash_rules.glsl"

// The values at each cell's centre: w the ceiling of luminance, z the fraction of grey.
uniform sampler2D ceilings;

vec2 ceiling_of(ivec2 cell) {
    return texelFetch(ceilings, clamp(cell, ivec2(0), ivec2(COLUMNS, ROWS) - 1), 0).wz;
}

// Returns the ceiling and the fraction of grey at a position in cells, interpolated between the centres of four cells.
vec2 ceiling_at(vec2 place) {
    ivec2 first = ivec2(floor(place - 0.5));
    vec2 fraction = fract(place - 0.5);
    vec2 low = mix(ceiling_of(first), ceiling_of(first + ivec2(1, 0)), fraction.x);
    vec2 high = mix(ceiling_of(first + ivec2(0, 1)), ceiling_of(first + 1), fraction.x);
    return mix(low, high, fraction.y);
}

// True if a result of `ceiling_at` may change light, and not only by a rounding of the interpolation.
bool limits(vec2 ceiling) {
    return ceiling.x < 0.9999 * OPEN || ceiling.y > 0.0;
}

vec3 below_ceiling(vec3 color, vec2 ceiling) {
    float light = dot(color, vec3(0.2126, 0.7152, 0.0722));
    float knee = KNEE * ceiling.x;
    float rest = (1.0 - KNEE) * ceiling.x;
    float shown = light > knee ? ceiling.x - rest * exp((knee - light) / rest) : light;
    return mix(color, vec3(light), ceiling.y) * (light > 0.0 ? shown / light : 1.0);
}
