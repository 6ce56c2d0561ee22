// The scene by way of the interpreter: its programs are found by the directory at the tape's start
// (src/world/interpreted.rs).

#include "interpreter.glsl"

const int DISTANCE_PROGRAM = 0;
const int OBJECT_PROGRAM = 1;
const int SKY_PROGRAM = 2;
const int AMBIENT_PROGRAM = 3;

int program_at(int place) {
    return int(texelFetch(tape, place >> 2)[place & 3]);
}

void scene_load() {}

void scene_begin() {
    load_program(program_at(DISTANCE_PROGRAM));
}

vec2 scene_distance(vec3 p, float penumbra) {
    return run_loaded(p, vec3(penumbra, 0.0, 0.0));
}

// What is asked of a surface, in this order.
const int NORMAL_PROBE = 0;
const int OBJECT_PROBE = 1;
const int MATERIAL_PROBE = 2;
const int OCCLUSION_PROBE = 3;
const int AMBIENT_PROBE = 4;

// As in surface.glsl, but with one call of the interpreter in a loop: each call is compiled anew, which is most of the
// time that a driver needs for this shader.
Surface scene_surface(vec3 p, int plane, vec3 direction, float cone, vec3 dx, vec3 dy) {
    Surface s;
    s.normal = vec3(0.0, 1.0, 0.0);
    s.object = 0;
    if (plane != NOTHING) {
        s.normal = plane_of(plane).xyz;
        s.object = int(plane_objects[plane] + 0.5);
    }
    vec4 d = PROBES;
    for (int probe = plane != NOTHING ? MATERIAL_PROBE : NORMAL_PROBE; probe <= AMBIENT_PROBE; probe++) {
        if (probe == OCCLUSION_PROBE && !occluder_near(p)) continue;
        vec4 x = vec4(p.x);
        vec4 y = vec4(p.y);
        vec4 z = vec4(p.z);
        vec3 n = s.normal;
        int program = DISTANCE_PROGRAM;
        if (probe == NORMAL_PROBE) {
            float h = tap_distance(cone);
            x += h * TAPS_X;
            y += h * TAPS_Y;
            z += h * TAPS_Z;
            n = vec3(0.0);
        } else if (probe == OBJECT_PROBE) {
            program = OBJECT_PROGRAM;
        } else if (probe == MATERIAL_PROBE) {
            program = 4 + s.object;
            vec3 right = along_surface(dx, n, direction);
            vec3 up = along_surface(dy, n, direction);
            x += vec4(0.0, right.x, up.x, 0.0);
            y += vec4(0.0, right.y, up.y, 0.0);
            z += vec4(0.0, right.z, up.z, 0.0);
        } else if (probe == OCCLUSION_PROBE) {
            x += n.x * PROBES;
            y += n.y * PROBES;
            z += n.z * PROBES;
            n = vec3(0.0);
        } else {
            program = AMBIENT_PROGRAM;
        }
        vec4 r[12];
        run_lanes(program_at(program), x, y, z, vec4(n.x), vec4(n.y), vec4(n.z), r);
        if (probe == NORMAL_PROBE) {
            s.normal = normal_of_taps(r[1]);
            COUNT_N(normal, 4);
        } else if (probe == OBJECT_PROBE) {
            s.object = int(r[0].x + 0.5);
        } else if (probe == MATERIAL_PROBE) {
            s.material = Material(vec3(r[0].x, r[1].x, r[2].x), r[3].x, r[4].x, vec3(r[5].x, r[6].x, r[7].x), r[8].x,
                                  r[9].x, r[10].x);
        } else if (probe == OCCLUSION_PROBE) {
            d = r[1];
            COUNT_N(occlusion, 4);
        } else {
            s.ambient = vec3(r[0].x, r[1].x, r[2].x);
        }
    }
    s.open = openness(p, s.normal, d);
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
