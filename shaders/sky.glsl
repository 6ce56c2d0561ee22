// What a ray sees that meets nothing: dusk, brightest at the horizon, so that no ray ends in a black void.

vec3 sky_color(vec3 direction) {
    float height = max(direction.y, 0.0);
    vec3 zenith = vec3(0.010, 0.018, 0.045);
    vec3 middle = vec3(0.045, 0.095, 0.150);
    vec3 horizon = vec3(0.42, 0.26, 0.17);
    vec3 color = mix(middle, zenith, smoothstep(0.05, 0.7, height));
    return mix(color, horizon, exp(-7.0 * height));
}
