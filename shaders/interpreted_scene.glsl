// The scene's functions by way of the interpreter: its programs are found by the directory at the tape's start
// (src/world/interpreted.rs).

#include "interpreter.glsl"

const int DISTANCE_PROGRAM = 0;
const int OBJECT_PROGRAM = 1;
const int SKY_PROGRAM = 2;
const int AMBIENT_PROGRAM = 3;

int program_at(int place) {
    return int(texelFetch(tape, place >> 2)[place & 3]);
}

void scene_begin() {
    load_program(program_at(DISTANCE_PROGRAM));
}

vec2 scene_distance(vec3 p, float penumbra) {
    return run_loaded(p, vec3(penumbra, 0.0, 0.0));
}

vec4 scene_estimates(vec4 x, vec4 y, vec4 z) {
    vec4 results[12];
    run_lanes(program_at(DISTANCE_PROGRAM), x, y, z, vec3(0.0), results);
    return results[1];
}

int scene_object(vec3 p) {
    return int(run_point(program_at(OBJECT_PROGRAM), p, vec3(0.0)).x + 0.5);
}

Material scene_material(int object, vec3 p, vec3 n, vec3 dx, vec3 dy) {
    vec4 r[12];
    run_lanes(program_at(4 + object), vec4(p.x, p.x + dx.x, p.x + dy.x, p.x),
              vec4(p.y, p.y + dx.y, p.y + dy.y, p.y), vec4(p.z, p.z + dx.z, p.z + dy.z, p.z),
              n, r);
    return Material(vec3(r[0].x, r[1].x, r[2].x), r[3].x, r[4].x, vec3(r[5].x, r[6].x, r[7].x), r[8].x, r[9].x,
                    r[10].x);
}

vec3 light_from(int program, vec3 direction) {
    vec4 r[12];
    run_lanes(program_at(program), vec4(0.0), vec4(0.0), vec4(0.0), direction, r);
    return vec3(r[0].x, r[1].x, r[2].x);
}

vec3 sky_color(vec3 direction, vec3 dx, vec3 dy) {
    return light_from(SKY_PROGRAM, direction);
}

vec3 sky_ambient(vec3 normal, vec3 dx, vec3 dy) {
    return light_from(AMBIENT_PROGRAM, normal);
}
