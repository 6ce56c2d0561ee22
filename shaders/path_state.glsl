// The state of a pixel's path between two passes of path.frag, in four layers of 32-bit floats:
//
// 0: the origin of the next ray; the path's number and the ray's number in it, as a whole number below 2^24
// 1: the ray's direction as an octahedron's map; see `Path.density`; the distance travelled from the eye
// 2: the fraction of the ray's light that reaches the eye; brightness of the light that the path has found
// 3: the sum of the light of all paths so far; the sum of the squares of their brightness

uniform sampler2DArray path_state;

const int RAYS_MAX = 255;           // a multiple of the path's number; crates/render/src/gpu/path_state.rs
const int FINISHED = RAYS_MAX - 1;  // stands for the ray's number in a pixel whose paths are all finished

struct Path {
    vec3 origin;
    int number;         // paths that the pixel has finished
    int ray;            // rays of this path before this one
    vec3 direction;
    float density;      // density of the direction among those that could have been drawn; BY_EYE, BY_MIRROR
    float travelled;
    vec3 throughput;
    float found;
    vec3 sum;
    float squares;
};

// The ray shows what the eye sees, directly or in mirrors: the sky's colour, but no lights.
const float BY_EYE = -1.0;
// A mirror reflects light from elsewhere: the sky's ambient light, but no lights.
const float BY_MIRROR = 0.0;

// Rays inside of glass store this number minus their density. It is below the other number.
const float INSIDE = -8.0;
const float INSIDE_BELOW = -4.0;

float brightness_of(vec3 light) {
    return dot(light, vec3(0.2126, 0.7152, 0.0722));
}

vec2 octahedral(vec3 v) {
    vec2 q = v.xy / (abs(v.x) + abs(v.y) + abs(v.z));
    vec2 signs = mix(vec2(-1.0), vec2(1.0), greaterThanEqual(q, vec2(0.0)));
    return v.z < 0.0 ? (1.0 - abs(q.yx)) * signs : q;
}

vec3 from_octahedral(vec2 q) {
    vec3 v = vec3(q, 1.0 - abs(q.x) - abs(q.y));
    vec2 signs = mix(vec2(-1.0), vec2(1.0), greaterThanEqual(q, vec2(0.0)));
    if (v.z < 0.0) v.xy = (1.0 - abs(q.yx)) * signs;
    return normalize(v);
}

// Returns the number of a texel's finished paths.
int paths_of(float tag) {
    return int(tag) / RAYS_MAX;
}

Path path_of(ivec2 texel) {
    vec4 a = texelFetch(path_state, ivec3(texel, 0), 0);
    vec4 b = texelFetch(path_state, ivec3(texel, 1), 0);
    vec4 c = texelFetch(path_state, ivec3(texel, 2), 0);
    vec4 d = texelFetch(path_state, ivec3(texel, 3), 0);
    int number = paths_of(a.w);
    return Path(a.xyz, number, int(a.w) - RAYS_MAX * number, from_octahedral(b.xy), b.z, b.w, c.rgb, c.w, d.rgb, d.w);
}
