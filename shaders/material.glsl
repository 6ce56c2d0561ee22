// What a scene says about a surface: functions of position and normal (Abt 2022, section 3.2).

#include "material_fields.glsl"

// Everything about a point of a surface except the light that lamps cast on it.
struct Surface {
    int object;
    vec3 normal;
    Material material;
    vec3 ambient;       // light from everywhere
    float open;         // how much of it arrives
    vec3 glow;          // light from what hides the rest of it
};
