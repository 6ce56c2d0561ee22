// What a scene says of a surface: the thesis' functions from position and normal (section 3.2).

#include "material_fields.glsl"

// Everything about a point of a surface but the light that falls on it from lamps.
struct Surface {
    int object;
    vec3 normal;
    Material material;
    vec3 ambient;       // light from everywhere
    float open;         // how much of it arrives
    vec3 glow;          // light of what hides the rest of it
};
