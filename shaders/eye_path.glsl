// The path from the eye through mirrors and glass: its next ray, its light and its first surface.
struct EyePath {
    vec3 origin;
    vec3 direction;
    vec3 throughput;    // fraction of the ray's light that reaches the eye
    vec3 color;         // light so far
    float travelled;    // from the eye to the ray's origin
    float blurred;      // growth of the ray's width per unit of length after rough mirrors
    int surface;        // number of surfaces before the ray
};

float most_of(vec3 light) {
    return max(light.r, max(light.g, light.b));
}

// The width of the path's cone at the ray's origin.
float cone_of(EyePath path) {
    return camera_position.w * path.travelled;
}

// The path's first surface: 1 / distance of the first surface along the camera's axis, the key of its surfaces, and ROUGH_KEY
// after a rough mirror (pixel_key.glsl).
float seen_nearness = 0.0;
float surface_key = 0.0;
float seen_rough = 0.0;

// A surface that mirrors a path.
struct Mirror {
    Surface s;
    vec3 p;
    vec3 facet;         // the normal of the facet that the path meets
    float off;          // distance of mirrored rays from the surface
    vec3 kept;          // light at the surface
    float reflectance;
    vec3 tint;          // colour of mirror images
};
