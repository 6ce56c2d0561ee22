// Glass (variant GLASS): rays that enter a body, bend, and leave it through the same distance. A path follows the bent
// ray to its end. The ray that the first glass mirrors waits until then.

#ifdef GLASS
// -1 inside of glass, where rays go to the surface from below; else 1. `trace` multiplies distances by it.
float ray_side = 1.0;
// True at a surface where a ray leaves glass: no light is added there.
bool is_leaving_glass = false;
// Fraction of light that is lost per unit of length in the glass.
vec3 glass_absorbs = vec3(0.0);

// In glass, a ray also ends at opaque surfaces. Their distance is evaluated only where it is needed: up to this distance
// the ray is free of them.
float free_in_glass = FAR;
// True if the last evaluation of `trace` was of opaque surfaces inside of glass.
bool met_in_glass = false;

void begin_in_glass(float t) {
    free_in_glass = ray_side < 0.0 ? t : FAR;
    met_in_glass = false;
}

// Chooses the distance for the next evaluation.
void look_in_glass(float t) {
    met_in_glass = ray_side < 0.0 && t >= free_in_glass;
}

// True if the other distance is evaluated next: from the same point, or where the ray is no longer free.
bool looks_again_in_glass(inout float t, float stride, inout float before) {
    if (met_in_glass) {
        free_in_glass = t + stride;
        return true;
    }
    bool is_known = !(ray_side < 0.0 && t + stride > free_in_glass);
    if (!is_known) {
        t = free_in_glass;
        before = 0.0;
    }
    return !is_known;
}

// The penumbra for distances around a surface: WITHOUT_GLASS for surfaces inside of glass, else 0.
float surface_penumbra = 0.0;
#define SURFACE_PENUMBRA surface_penumbra
// Rays start up to this height below a plane.
#define PLANES_FROM(start, cone) (-1.1 * max(0.002, cone))

struct WaitingRay {
    vec3 origin;
    vec3 direction;
    vec3 throughput;    // 0 if no ray waits
    float travelled;
};
WaitingRay waiting = WaitingRay(vec3(0.0), vec3(0.0), vec3(0.0), 0.0);

// Returns the mirrored fraction of light at the surface of glass: Fresnel's reflectance by Schlick's approximation
// (1994). `ratio` is the refractive index in front of the surface, divided by the index behind the surface. The result is 1 for total
// reflection.
float glass_reflectance(float ratio, float cosine) {
    float f0 = (ratio - 1.0) / (ratio + 1.0);
    f0 *= f0;
    float sine2 = ratio * ratio * (1.0 - cosine * cosine);
    if (sine2 >= 1.0) return 1.0;
    // Towards a thinner medium the angle behind the surface counts.
    float grazing = 1.0 - (ratio > 1.0 ? sqrt(1.0 - sine2) : cosine);
    float square = grazing * grazing;
    return f0 + (1.0 - f0) * square * square * grazing;
}
#else
const float ray_side = 1.0;
const bool is_leaving_glass = false;
const bool met_in_glass = false;

void begin_in_glass(float t) {}

void look_in_glass(float t) {}

bool looks_again_in_glass(inout float t, float stride, inout float before) {
    return false;
}

#define SURFACE_PENUMBRA 0.0
#define PLANES_FROM(start, cone) (start)
#endif
