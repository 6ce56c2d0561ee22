// The surface properties of a scene: functions of position and normal (Abt 2022, section 3.2).

#include "material_fields.glsl"

// All properties of a surface point except the light that lamps send to it.
struct Surface {
    int object;
    vec3 normal;
    Material material;
    vec3 ambient;       // light from all directions
    float open;         // fraction of the ambient light that arrives; UNKNOWN_OPEN before the probes
    vec3 glow;          // light from shining objects that block ambient light
};

// The sum of all media at a point (media.glsl).
struct Medium {
    float density;      // fraction of light that is lost per unit of length
    vec3 scattered;     // fraction that is scattered per unit of length
    vec3 emitted;       // light per unit of length: emission and scattered ambient light
    float phase;        // direction of scattering, -1 backward .. 1 forward
};
