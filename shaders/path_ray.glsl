// A ray of a path: its end, and the parts of its light there.

// Pairs of random numbers of a path, and of each of its rays.
const int PLACE_PAIR = 0;
const int LENS_PAIR = 1;
const int RAY_PAIRS = 2;
const int LIGHT_PAIR = 0;       // the direction to a light
const int LOBE_PAIR = 1;        // the direction of the next ray
const int CHOICE_PAIR = 2;      // which light, which lobe
const int SURVIVAL_PAIR = 3;    // mirror or lobe, and the end of a path
#ifdef SWARM
const int SWARM_PAIR = 4;       // whether a ray meets thin balls
const int PAIRS = 5;
#else
const int PAIRS = 4;
#endif

// The end of a ray that leaves the scene, beyond every light.
const float NEVER = 1e9;

// Where a ray ends.
struct RayEnd {
    Hit hit;            // the surface; a ball of a swarm counts as one
    float t;            // distance along the ray; NEVER in the sky
    bool is_inside;     // the ray is inside of glass
    bool leaves;        // it leaves this glass here
    vec3 dx;            // offsets to the rays of the pixels to the right and above
    vec3 dy;
};

// The light of a ray at a surface, by the way on which it goes on.
struct Parting {
    vec3 p;             // on the surface
    float off;          // distance of the next ray's origin from the surface
    vec3 normal;
    vec3 facing;        // normal of the facet that the ray meets
    vec3 kept;          // light at the surface
    vec3 mirrored;      // fraction that goes on in a mirror image
    float bent;         // through glass
    float scattered;    // by the lobes
    float ratio;        // of refractive indices, on the way through glass
};

// The place from which a path goes on.
struct Vertex {
    vec3 origin;
    Lobes lobes;        // of a surface; of a medium only the direction
    float lobed;        // fraction of the lobes' light that rays may meet by chance
    bool is_medium;
    vec3 kept;          // of a medium
    float phase;
};

vec3 finite_light(vec3 light) {
    float bright = brightness_of(light);
    return bright >= 0.0 && bright < 1e12 ? max(light, vec3(0.0)) : vec3(0.0);
}

void add(inout Path path, vec3 light) {
    vec3 sound = finite_light(light);
    path.sum += sound;
    path.found += brightness_of(sound);
}
