// What a ray sees that meets nothing: dusk, brightest at the horizon, so that no ray ends in a black void.

vec3 sky_color(vec3 direction) {
    float height = max(direction.y, 0.0);
    vec3 zenith = vec3(0.004, 0.007, 0.020);
    vec3 middle = vec3(0.020, 0.045, 0.085);
    vec3 horizon = vec3(0.40, 0.17, 0.075);
    vec3 color = mix(middle, zenith, smoothstep(0.05, 0.6, height));
    return color + horizon * exp(-16.0 * height);
}
