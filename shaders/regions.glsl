// Looks up cells in the tree over space, which is built for each frame (crates/field/src/region/). A cell has a
// lower bound of the distance from its points to all surfaces, and a shortened tape for the distance in the cell.
//
// Texels 0..4095 are the first root's 16 x 16 x 16 cells, x first. A scene without bounds has more roots with the same
// middle, each four times as wide as the next smaller one. A divided cell has a brick of 4 x 4 x 4.
//
// - x: DIVIDED if the cell has a brick; else the bound as float bits, which is 0 if the cell may contain a surface
// - y: the brick's first texel if the cell has a brick; else the tape's first texel, and the number of the nearest
//   object from bit 24 on

#include "texel_lists.glsl"

uniform WORD_LIST regions;          // RGBA32UI

const uint DIVIDED = 0xFFFFFFFFu;
// ROOT_SIDE, AHEAD and other constants are shared with the CPU: crates/field/src/rays.rs.

struct Cell {
    float bound;    // lower bound of the distance from points of the cell to all surfaces
    int tape;       // first texel of the tape for bound and estimate in the cell
    int object;     // the nearest object, or SEVERAL
    float side;     // in cells of the first root; 0 outside of the tree
#ifdef NON_LIPSCHITZ
    uvec2 slopes;   // bounds of the gradient (non_lipschitz.glsl)
#endif
};

#ifdef NO_CELLS
// Stands for the cell in compiled scenes that are drawn without a tree.
const Cell NO_CELL = Cell(0.0, 0, SEVERAL, 0.0);
#else
Cell cell_at(vec3 q) {
    float far = max(abs(q.x), max(abs(q.y), abs(q.z)));
    bool inside = far < region_middle.w;
    uvec4 texel = uvec4(0u);
#ifdef NON_LIPSCHITZ
    float side = 1.0;
    int root = 0;
#else
    float side = far < 8.0 ? 1.0 : far < 32.0 ? 4.0 : far < 128.0 ? 16.0 : 64.0;
    int root = far < 8.0 ? 0 : far < 32.0 ? 4096 : far < 128.0 ? 8192 : 12288;
#endif
    ivec3 place = ivec3(floor(q / side)) + 8;
    if (inside) texel = TEXEL(regions, root + place.x + 16 * (place.y + 16 * place.z));
    while (texel.x == DIVIDED) {
        side *= 0.25;
        place = ivec3(floor(q / side)) & 3;
        texel = TEXEL(regions, int(texel.y) + place.x + 4 * (place.y + 4 * place.z));
    }
    Cell cell;
    cell.bound = inside ? uintBitsToFloat(texel.x) : 0.0;
    cell.tape = inside ? int(texel.y & 0xFFFFFFu) : int(region_scale.w);
    cell.object = inside ? int(texel.y >> 24) : SEVERAL;
    cell.side = inside ? side : 0.0;
#ifdef NON_LIPSCHITZ
    cell.slopes = texel.zw;
#endif
    return cell;
}
#endif

// Converts a point to coordinates from the tree's middle, in units of the first root's cells.
vec3 in_root(vec3 p) {
    return (p - region_middle.xyz) * region_scale.xyz;
}

// A ray through the tree. It has few members because they occupy registers while the scene is evaluated.
struct Walk {
    vec3 origin;
    vec3 direction;
    vec3 inverse;   // 1 / direction, in root cells
    float nudge;    // a short distance in root cells, longer than the rounding error of a point on the ray
};

Walk walk_of(vec3 origin, vec3 direction) {
    vec3 pace = direction * region_scale.xyz;
    // A component of exactly 0 would make 0 * inf = NaN.
    vec3 inverse = 1.0 / (pace + mix(vec3(-1e-12), vec3(1e-12), greaterThanEqual(pace, vec3(0.0))));
    vec3 start = in_root(origin);
    float nudge = AHEAD + AHEAD_OF_FAR * max(abs(start.x), max(abs(start.y), abs(start.z)));
    return Walk(origin, direction, inverse, nudge);
}

// Returns the position at which the ray's cell at t is looked up. It is slightly beyond t, so that a ray never gets
// stuck at a face.
vec3 place_on(Walk walk, float t) {
    vec3 ahead = mix(vec3(-walk.nudge), vec3(walk.nudge), greaterThanEqual(walk.direction, vec3(0.0)));
    return in_root(walk.origin + t * walk.direction) + ahead;
}

// Returns the distance at which the ray leaves the cell of q. q is the result of `place_on` for t.
float exit_of(Cell cell, Walk walk, vec3 q, float t) {
    vec3 face = (floor(q / cell.side) + step(vec3(0.0), walk.direction)) * cell.side;
    // Measure from the point at t: q is ahead of it by `nudge` along each axis.
    vec3 left = (face - q) * walk.inverse + walk.nudge * abs(walk.inverse);
    return t + min(left.x, min(left.y, left.z));
}

float past(float t) {
    return t * (1.0 + PAST_FACE) + PAST_FACE;
}
