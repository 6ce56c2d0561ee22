// The ray of a sample: its origin, its direction, and its change from pixel to pixel. With PROJECTED, the picture is not
// flat or has two eyes. The CPU computes the same rays: crates/render/src/frame/projection.rs.

#ifndef PROJECTED
#define ray_origin camera_position.xyz
// True if all samples of a pixel start at one point; true if a ray is in the picture.
#define RAYS_START_TOGETHER true
#define IS_SEEN(direction) true

vec3 eye_ray() {
    vec2 place = 2.0 * sample_place() * viewport.zw - 1.0;
    return normalize(camera_forward.xyz + place.x * camera_right.xyz + place.y * camera_up.xyz);
}

// Return the offsets, at the distance `reached`, to the rays of the pixels to the right and above.
vec3 ray_dx(float reached) {
    return camera_right.xyz * (2.0 * viewport.z * reached);
}

vec3 ray_dy(float reached) {
    return camera_up.xyz * (2.0 * viewport.w * reached);
}

float axial(float t, vec3 direction) {
    return t * dot(direction, camera_forward.xyz);
}
#else
const float QUARTER = 1.57079633;
// The rays of an eye start at different points. Around a dome's circle is black.
#define RAYS_START_TOGETHER (frame_projection.z <= 0.0)
#define IS_SEEN(direction) ((direction) != vec3(0.0))

vec3 ray_origin;
vec3 ray_right;
vec3 ray_above;

// A sphere or half of one: longitude and latitude are proportional to the position.
vec3 cylinder_ray(vec2 place, vec2 pixel, float eye) {
    float half_width = frame_projection.x == PROJECTION_SPHERE ? 2.0 * QUARTER : QUARTER;
    float longitude = half_width * place.x;
    float latitude = QUARTER * place.y;
    vec3 ahead = sin(longitude) * camera_right.xyz + cos(longitude) * camera_forward.xyz;
    vec3 across = cos(longitude) * camera_right.xyz - sin(longitude) * camera_forward.xyz;
    ray_right = cos(latitude) * half_width * pixel.x * across;
    ray_above = QUARTER * pixel.y * (cos(latitude) * camera_up.xyz - sin(latitude) * ahead);
    // Around the whole sphere, the eyes turn with the head: rays start on a circle and touch it.
    ray_origin += eye * (frame_projection.x == PROJECTION_SPHERE ? across : camera_right.xyz);
    return cos(latitude) * ahead + sin(latitude) * camera_up.xyz;
}

// A dome: the angle to the axis is proportional to the distance from the centre. The result is 0 outside of the circle.
vec3 dome_ray(vec2 place, vec2 pixel, float eye) {
    float radius = length(place);
    float angle = QUARTER * radius;
    // sin(angle) / radius, and its derivative divided by the radius.
    float s = radius > 1e-3 ? sin(angle) / radius : QUARTER;
    float c = radius > 1e-3 ? (QUARTER * cos(angle) - s) / (radius * radius) : -QUARTER * QUARTER * QUARTER / 3.0;
    vec3 away = place.x * camera_right.xyz + place.y * camera_up.xyz;
    vec3 bend = c * away - QUARTER * s * camera_forward.xyz;
    ray_right = pixel.x * (s * camera_right.xyz + place.x * bend);
    ray_above = pixel.y * (s * camera_up.xyz + place.y * bend);
    ray_origin += eye * camera_right.xyz;
    return radius > 1.0 ? vec3(0.0) : s * away + cos(angle) * camera_forward.xyz;
}

// A flat picture for one of two eyes, which meet at the camera's target.
vec3 flat_ray(vec2 place, vec2 pixel, float eye) {
    vec3 right = normalize(camera_right.xyz);
    ray_right = pixel.x * camera_right.xyz;
    ray_above = pixel.y * camera_up.xyz;
    ray_origin += eye * right;
    vec3 direction = camera_forward.xyz + place.x * camera_right.xyz + place.y * camera_up.xyz;
    return normalize(direction - eye * frame_projection.w * right);
}

vec3 eye_ray() {
    vec3 corner = eye_corner(sample_place());
    float eye = corner.z * frame_projection.z;
    vec2 size = eye_size();
    vec2 sides = frame_projection.x == PROJECTION_DOME ? vec2(min(size.x, size.y)) : size;
    vec2 place = (2.0 * (sample_place() - corner.xy) - size) / sides;
    vec2 pixel = 2.0 / sides;
    ray_origin = camera_position.xyz;
    if (frame_projection.x == PROJECTION_FLAT) return flat_ray(place, pixel, eye);
    if (frame_projection.x == PROJECTION_DOME) return dome_ray(place, pixel, eye);
    return cylinder_ray(place, pixel, eye);
}

vec3 ray_dx(float reached) {
    return ray_right * reached;
}

vec3 ray_dy(float reached) {
    return ray_above * reached;
}

// Returns the depth of a point for the lens: along the axis of a flat picture, along the ray otherwise.
float axial(float t, vec3 direction) {
    return frame_projection.x == PROJECTION_FLAT ? t * dot(direction, camera_forward.xyz) : t;
}
#endif
