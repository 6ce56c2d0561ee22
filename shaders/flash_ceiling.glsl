// How light is dimmed below the ceilings of cells (src/flash/limiter.rs).

#include "flash_rules.glsl"

// Of each cell's centre: w the ceiling of luminance, z the share of grey.
uniform sampler2D ceilings;

// Those of a cell and of the cells around it, a column of cells for each column.
struct Ceilings {
    mat3 light;
    mat3 grey;
};

Ceilings ceilings_around(ivec2 cell) {
    Ceilings around;
    ivec2 last = ivec2(COLUMNS, ROWS) - 1;
    for (int i = 0; i < 9; i++) {
        vec4 found = texelFetch(ceilings, clamp(cell + ivec2(i / 3, i % 3) - 1, ivec2(0), last), 0);
        around.light[i / 3][i % 3] = found.w;
        around.grey[i / 3][i % 3] = found.z;
    }
    return around;
}

// Whether any pixel of the cell may change.
bool limits(Ceilings around) {
    vec3 low = min(around.light[0], min(around.light[1], around.light[2]));
    vec3 most = max(around.grey[0], max(around.grey[1], around.grey[2]));
    return min(low.x, min(low.y, low.z)) < OPEN || max(most.x, max(most.y, most.z)) > 0.0;
}

// The shares of the centres before, here and behind at a place in the cell, 0..1.
vec3 shares(float place) {
    return vec3(max(0.5 - place, 0.0), 1.0 - abs(place - 0.5), max(place - 0.5, 0.0));
}

// Linear light as it is shown at a place in the cell.
vec3 below_ceiling(vec3 color, Ceilings around, vec2 place) {
    vec3 across = shares(place.x);
    vec3 upwards = shares(place.y);
    float ceiling = dot(upwards, around.light * across);
    float grey = dot(upwards, around.grey * across);
    float light = dot(color, vec3(0.2126, 0.7152, 0.0722));
    float knee = KNEE * ceiling;
    float rest = (1.0 - KNEE) * ceiling;
    float shown = light > knee ? ceiling - rest * exp((knee - light) / rest) : light;
    return mix(color, vec3(light), grey) * (light > 0.0 ? shown / light : 1.0);
}
