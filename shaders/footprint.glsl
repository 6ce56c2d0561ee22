// The area of a surface under a pixel.

const int NOTHING = -1;

// Returns the movement of the visible point along the surface if the ray moves by `step` at the distance of the point.
vec3 along_surface(vec3 step, vec3 normal, vec3 direction) {
    float along = dot(direction, normal);
    along = abs(along) < 0.05 ? (along < 0.0 ? -0.05 : 0.05) : along;
    return step - direction * (dot(step, normal) / along);
}
