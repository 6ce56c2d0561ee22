// What a pixel covers of a surface.

// The number of no plane.
const int NOTHING = -1;

// How the point seen moves along the surface where the ray moves by `step` at its distance.
vec3 along_surface(vec3 step, vec3 normal, vec3 direction) {
    float along = dot(direction, normal);
    along = abs(along) < 0.05 ? (along < 0.0 ? -0.05 : 0.05) : along;
    return step - direction * (dot(step, normal) / along);
}
