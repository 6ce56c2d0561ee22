// The scene by way of the interpreter: its programs are found by the directory at the tape's start
// (src/world/interpreted.rs), distances by the regions' tapes.

#include "interpreter.glsl"

const int SKY_PROGRAM = 0;
const int AMBIENT_PROGRAM = 1;
const int MATERIAL_PROGRAMS = 4;

int program_at(int place) {
    return int(texelFetch(tape, place >> 2)[place & 3]);
}

vec2 scene_distance(Cell cell, vec3 p, float penumbra) {
    return run_region(cell.tape, p, penumbra);
}

// The normal, the object and the occluders' distances of a point: one call in a loop, as each is compiled anew. Each
// round looks for the next probe that needs an evaluation.
const int OBJECT_PROBE = 4;
const int FIRST_OCCLUSION_PROBE = 5;
const int PROBES_END = 9;

void probe_surface(vec3 p, bool is_plane, float cone, inout Surface s, out vec4 occluders) {
    float h = tap_distance(cone);
    vec4 taps = vec4(0.0);
    occluders = PROBES;
    int probe = is_plane ? FIRST_OCCLUSION_PROBE : 0;
    int end = occluder_near(p) ? PROBES_END : FIRST_OCCLUSION_PROBE;
    for (int round = 0; round < PROBES_END; round++) {
        vec3 at = p;
        int tape = 0;
        for (; probe < end; probe++) {
            int i = probe & 3;
            if (probe == OBJECT_PROBE) {
                s.normal = normal_of_taps(taps);
                NOTE_SLOPE(taps, h);
                at = p;
            } else if (probe < OBJECT_PROBE) {
                at = p + h * vec3(TAPS_X[i], TAPS_Y[i], TAPS_Z[i]);
            } else {
                at = p + PROBES[probe - FIRST_OCCLUSION_PROBE] * s.normal;
            }
            Cell cell = cell_at(in_root(at));
            COUNT(lookups);
            tape = cell.tape;
            if (probe < OBJECT_PROBE) break;
            if (probe == OBJECT_PROBE) {
                s.object = cell.object;
                if (cell.object == SEVERAL) break;
            } else if (AS_DISTANCE(cell.bound) < PROBES[probe - FIRST_OCCLUSION_PROBE]) {
                break;
            }
        }
        if (probe >= end) break;
        // The object's tape stands before the distance's.
        if (probe == OBJECT_PROBE) tape = int(texelFetch(regions, tape - 1).x);
        vec2 d = run_region(tape, at, 0.0);
        if (probe < OBJECT_PROBE) {
            taps[probe] = d.y;
            COUNT(normal);
        } else if (probe == OBJECT_PROBE) {
            s.object = int(d.x + 0.5);
        } else {
            occluders[probe - FIRST_OCCLUSION_PROBE] = AS_DISTANCE(d.y);
            COUNT(occlusion);
        }
        probe++;
    }
}

Surface scene_surface(vec3 p, int plane, vec3 direction, float cone, vec3 dx, vec3 dy) {
    Surface s;
    s.normal = vec3(0.0, 1.0, 0.0);
    s.object = 0;
    if (plane != NOTHING) {
        s.normal = planes[plane].xyz;
        NOTE_PLANE;
        s.object = int(plane_objects[plane] + 0.5);
    }
    vec4 occluders;
    probe_surface(p, plane != NOTHING, cone, s, occluders);
    s.open = openness(p, s.normal, occluders);
    vec3 right = along_surface(dx, s.normal, direction);
    vec3 up = along_surface(dy, s.normal, direction);
    // The material, then the ambient light: again one call in a loop.
    for (int i = 0; i < 2; i++) {
        int program = i == 0 ? MATERIAL_PROGRAMS + s.object : AMBIENT_PROGRAM;
        vec4 r[12];
        run_lanes(program_at(program), p.x + vec4(0.0, right.x, up.x, 0.0), p.y + vec4(0.0, right.y, up.y, 0.0),
                  p.z + vec4(0.0, right.z, up.z, 0.0), vec4(s.normal.x), vec4(s.normal.y), vec4(s.normal.z), r);
        if (i == 0) {
            s.material = Material(vec3(r[0].x, r[1].x, r[2].x), r[3].x, r[4].x, vec3(r[5].x, r[6].x, r[7].x), r[8].x,
                                  r[9].x, r[10].x);
        } else {
            s.ambient = vec3(r[0].x, r[1].x, r[2].x);
        }
    }
    return s;
}

vec3 sky_color(vec3 direction, vec3 dx, vec3 dy) {
    vec4 r[12];
    run_lanes(program_at(SKY_PROGRAM), vec4(0.0), vec4(0.0), vec4(0.0),
              vec4(direction.x, direction.x + dx.x, direction.x + dy.x, direction.x),
              vec4(direction.y, direction.y + dx.y, direction.y + dy.y, direction.y),
              vec4(direction.z, direction.z + dx.z, direction.z + dy.z, direction.z), r);
    return vec3(r[0].x, r[1].x, r[2].x);
}
