// What a ray sees that meets nothing: dusk, brightest at the horizon, so that no ray ends in a black void.

vec3 sky_color(vec3 direction) {
    float height = max(direction.y, 0.0);
    vec3 zenith = vec3(0.004, 0.007, 0.020);
    vec3 middle = vec3(0.012, 0.030, 0.062);
    vec3 horizon = vec3(0.30, 0.115, 0.050);
    vec3 color = mix(middle, zenith, smoothstep(0.05, 0.6, height));
    return color + horizon * exp(-14.0 * height);
}
