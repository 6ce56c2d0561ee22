// The scene's functions, run by the interpreter. The directory at the start of `tape` lists the programs
// (crates/field/src/world/interpreted.rs); distances come from the regions' tapes.

#include "interpreter.glsl"

const int SKY_PROGRAM = 0;
const int AMBIENT_PROGRAM = 1;
const int GLOW_PROGRAM = 2;
const int MEDIUM_PROGRAM = 3;
const int MATERIAL_PROGRAMS = 4;

void scene_load() {}

// Returns the program for a point or a direction from the grid of the directory entry `place`.
int program_at(int place, vec3 at) {
    int grid = int(TEXEL(tape, place >> 2)[place & 3]);
    uvec4 low = TEXEL(tape, grid);
    vec3 per_unit = uintBitsToFloat(TEXEL(tape, grid + 1).xyz);
    int last = int(low.w);
    vec3 cell = clamp((at - uintBitsToFloat(low.xyz)) * per_unit, vec3(0.0), vec3(float(last)));
    ivec3 q = clamp(ivec3(cell), ivec3(0), ivec3(last));
    int number = q.x + 8 * (q.y + 8 * q.z);
    return int(TEXEL(tape, grid + 2 + (number >> 2))[number & 3]);
}

struct Place {
    vec3 p;
    vec3 n;
};

// Runs a program (crates/field/src/world/interpreted.rs): first its textures, then its tape. Texture coordinates are
// computed for this pixel, the pixel to the right, and the pixel above. The results stay in the registers that the
// returned header lists.
uvec4 run_program(int program, Place here, Place right, Place above) {
    uvec4 head = TEXEL(tape, program);
#if SAMPLES > 0
    int samples = int(head.w);
    FORGET_SAMPLED;
    int sample_number = 0;
    int neighbour = 0;
    vec2 dx = vec2(0.0);
    vec2 dy = vec2(0.0);
    for (int round = 0; round <= SAMPLES; round++) {
        vec2 uv;
        uvec4 texture_head;
        // Use a single call in a loop, because each call is compiled separately. The loop runs three times per texture,
        // and once for the program's own tape.
        for (;;) {
            bool is_own = sample_number >= samples;
            texture_head = TEXEL(tape, program + 1 + sample_number);
            int first = is_own ? program + 1 + samples : int(texture_head.y);
            bool is_here = is_own || neighbour == 2;
            vec3 p = is_here ? here.p : neighbour == 0 ? right.p : above.p;
            vec3 n = is_here ? here.n : neighbour == 0 ? right.n : above.n;
            uv = run_tape(first, p, n);
            if (is_here) break;
            if (neighbour == 0) { dx = uv; } else { dy = uv; }
            neighbour++;
        }
        if (sample_number >= samples) break;
        vec4 texel = sample_texture(int(texture_head.x), uv, dx - uv, dy - uv);
        int at = 4 * sample_number;
        SAMPLED(at) = texel.x;
        SAMPLED(at + 1) = texel.y;
        SAMPLED(at + 2) = texel.z;
        SAMPLED(at + 3) = texel.w;
        neighbour = 0;
        sample_number++;
    }
#else
    run_tape(program + 1, here.p, here.n);
#endif
    return head;
}

vec2 scene_distance(Cell cell, vec3 p, float penumbra) {
    return run_region(cell.tape, p, penumbra);
}

// Computes the normal and the object of a point with one call in a loop, because each call is compiled separately.
//
// Tried: one call of run_region for rays, probes and shadows. On Xe it saves 13 % of the code but no spills. On Vega
// (ACO) it saves 29 % of the code, but takes 156 registers, so that only one wave fits.
const int OBJECT_TAP = 4;

void tap_surface(vec3 p, float cone, inout Surface s) {
    float h = tap_distance(cone);
    vec4 taps = vec4(0.0);
    for (int tap = 0; tap <= OBJECT_TAP; tap++) {
        bool is_object = tap == OBJECT_TAP;
        int i = tap & 3;
        vec3 at = is_object ? p : p + h * vec3(TAPS_X[i], TAPS_Y[i], TAPS_Z[i]);
        Cell cell = cell_at(in_root(at));
        COUNT(count_lookups);
        int tape = cell.tape;
        if (is_object) {
            s.object = cell.object;
            if (cell.object != SEVERAL) break;
            // The object's tape is stored before the distance's tape.
            tape = int(TEXEL(regions, tape - 1).x);
        }
        vec2 d = run_region(tape, at, SURFACE_PENUMBRA);
        if (is_object) {
            s.object = int(d.x + 0.5);
        } else {
            taps[i] = d.y;
            COUNT(count_normal);
        }
    }
    vec3 sum = sum_of_taps(taps);
    s.normal = normal_of(sum);
    NOTE_SLOPE(sum, h);
}

// The programs at a surface: ambient light, glow (if objects shine), the material's surface and body (if the scene's
// materials use it). Paths need only the material.
#ifdef PATHS
const int FIRST_ROUND = 2;
#else
const int FIRST_ROUND = 0;
#endif
#ifdef GLOW
const int GLOW_ROUNDS = 1;
#else
const int GLOW_ROUNDS = 0;
#endif
#ifdef BODY
const int SURFACE_ROUNDS = 4;
#else
const int SURFACE_ROUNDS = 3;
#endif

Surface scene_surface(vec3 p, int plane, vec3 direction, float cone, vec3 dx, vec3 dy) {
    Surface s;
    s.normal = vec3(0.0, 1.0, 0.0);
    s.object = 0;
    s.ambient = vec3(0.0);
    s.glow = vec3(0.0);
    if (plane != NOTHING) {
        s.normal = plane_of(plane).xyz;
        NOTE_PLANE;
        s.object = int(plane_objects[plane] + 0.5);
    }
    if (plane == NOTHING) tap_surface(p, cone, s);
    s.open = UNKNOWN_OPEN;
    Place here = Place(p, s.normal);
    Place right = Place(p + along_surface(dx, s.normal, direction), s.normal);
    Place above = Place(p + along_surface(dy, s.normal, direction), s.normal);
    // Compute ambient light, glow and material with a single call in a loop.
    uvec4 head = uvec4(0u);
    for (int i = is_leaving_glass ? 2 : FIRST_ROUND; i < SURFACE_ROUNDS; i += i == 0 ? 2 - GLOW_ROUNDS : 1) {
        int place = i == 0 ? AMBIENT_PROGRAM : MATERIAL_PROGRAMS + 2 * s.object;
        if (i == 3) place++;
        Place asked = here;
        Place beside = right;
        Place over = above;
#ifdef GLOW
        if (i == 1) {
            // The probe covers this width, so that a texture gives its mean colour around the point.
            vec3 width = vec3(GLOW_PROBE * frame_reach.x, 0.0, 0.0);
            place = GLOW_PROGRAM;
            asked = Place(p + width.x * s.normal, vec3(0.0));
            beside = Place(asked.p + width, asked.n);
            over = Place(asked.p + width.zyx, asked.n);
        }
#endif
        head = run_program(program_at(place, i == 0 ? s.normal : asked.p), asked, beside, over);
        vec3 first = vec3(READ(head.x, 0), READ(head.x, 1), READ(head.x, 2));
        if (i == 0) s.ambient = first;
        if (i == 1) s.glow = glow_from(vec4(first, READ(head.x, 3)));
#ifdef BODY
        if (i == 2) { READ_MATERIAL(s.material, head) }
#endif
    }
#ifdef BODY
    READ_BODY(s.material, head)
#else
    READ_MATERIAL(s.material, head)
#endif
    return s;
}

#ifdef MEDIA
Medium scene_medium(vec3 p) {
    // Media read no textures.
    int program = program_at(MEDIUM_PROGRAM, p);
    uvec4 head = TEXEL(tape, program);
    run_tape(program + 1, p, vec3(0.0));
    return Medium(READ(head.x, 0), vec3(READ(head.x, 1), READ(head.x, 2), READ(head.x, 3)),
                  vec3(READ(head.y, 0), READ(head.y, 1), READ(head.y, 2)), READ(head.y, 3));
}
#endif

// Tried: one call of run_program for materials, light and sky. It saves 9 to 14 % of the code. But the sky must then be
// computed before the lights, which costs every compiled scene a wave on Vega.
vec3 sky_of(int place, vec3 direction, vec3 dx, vec3 dy) {
#ifdef PIXEL
    vec3 pixel = vec3(picture_pixel(), 0.0);
    vec3 right = pixel + vec3(frame_screen.z, 0.0, 0.0);
    vec3 above = pixel + vec3(0.0, frame_screen.w, 0.0);
#else
    const vec3 pixel = vec3(0.0);
    const vec3 right = vec3(0.0);
    const vec3 above = vec3(0.0);
#endif
    uvec4 head = run_program(program_at(place, direction), Place(pixel, direction), Place(right, direction + dx),
                             Place(above, direction + dy));
    return vec3(READ(head.x, 0), READ(head.x, 1), READ(head.x, 2));
}

#ifdef PATHS
// Returns the sky's colour, or its ambient light from a direction.
vec3 sky_light(vec3 direction, vec3 dx, vec3 dy, bool is_color) {
    return sky_of(is_color ? SKY_PROGRAM : AMBIENT_PROGRAM, direction, dx, dy);
}
#else
vec3 sky_color(vec3 direction, vec3 dx, vec3 dy) {
    return sky_of(SKY_PROGRAM, direction, dx, dy);
}
#endif
