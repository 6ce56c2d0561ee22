// The scene assets/scenes/speakers.scene, written by hand in GLSL. The compiled scene must look the same as this code
// and cost about the same.

const vec3 SPEAKER_CENTRE = vec3(5.0, 3.2, 10.0);
const vec3 CABINET_HALF = vec3(2.0, 3.0, 2.0);
const float CABINET_ROUNDING = 0.2;
const float BAR_SPACING = 0.16;
const float BAR_HEIGHT = 3.4;
const float BAR_Z = 8.7;
const float BAR_HALF_DEPTH = 0.09;
const float WOOFER_Y = -1.2;
const float WOOFER_LEAD = 0.55;

// Box of half extents `half_size` whose edges are rounded outwards by `radius`; exact.
float round_box(vec3 p, vec3 half_size, float radius) {
    vec3 q = abs(p) - half_size;
    return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0) - radius;
}

// Polynomial smooth minimum (Quilez 2013); differs from min only where |a - b| < k.
float smooth_min(float a, float b, float k) {
    float h = max(k - abs(a - b), 0.0) / k;
    return min(a, b) - h * h * k * 0.25;
}

float loudness(float volume) {
    return 1.0 - exp(-5.0 * volume);
}

float woofer_radius(float side) {
    return 1.3 + 0.45 * loudness(side < 0.0 ? frame_heard[0].x : frame_heard[0].y);
}

float bridge_radius(float x) {
    float loud = loudness(0.5 * (frame_heard[0].x + frame_heard[0].y));
    return 0.2 + 0.22 * loud + 0.09 * loud * cos(3.4 * x) * cos(2.0 * frame_time);
}

float speakers_distance(vec3 p) {
    vec3 q = vec3(abs(p.x), p.yz) - SPEAKER_CENTRE;
    float cabinet = round_box(q, CABINET_HALF, CABINET_ROUNDING);
    float rod = 0.93 * (length(p.yz - vec2(4.55, 10.0)) - bridge_radius(p.x));
    float bridge = max(rod, abs(p.x) - 3.6);
    float body = smooth_min(cabinet, bridge, 1.1);
    vec3 w = q - vec3(0.0, WOOFER_Y, -CABINET_HALF.z - CABINET_ROUNDING);
    float r = woofer_radius(p.x);
    float dish = length(w + vec3(0.0, 0.0, WOOFER_LEAD)) - r;
    body = -smooth_min(-body, dish, 0.16);
    float cap = length(w - vec3(0.0, 0.0, r - WOOFER_LEAD)) - 0.36;
    return smooth_min(body, cap, 0.12);
}

float bar_index(float x) {
    return clamp(floor(x / BAR_SPACING) + 16.0, 0.0, 31.0);
}

float bar_distance(vec3 p, float index) {
    float height = 0.04 + BAR_HEIGHT * level_of_band(index);
    vec3 centre = vec3((index - 15.5) * BAR_SPACING, 0.5 * height, BAR_Z);
    return round_box(p - centre, vec3(0.055, 0.5 * height, BAR_HALF_DEPTH) - 0.02, 0.02);
}

float bars_distance(vec3 p) {
    float first = bar_index(p.x);
    float centre = (first - 15.5) * BAR_SPACING;
    float second = clamp(first + (p.x > centre ? 1.0 : -1.0), 0.0, 31.0);
    return min(bar_distance(p, first), bar_distance(p, second));
}

void scene_load() {}

vec2 scene_distance(vec3 p, float penumbra) {
    float speakers = speakers_distance(p);
    float bars = bars_distance(p);
    float half_height = 0.5 * (BAR_HEIGHT + 0.04);
    vec3 half_size = vec3(16.0 * BAR_SPACING, half_height, BAR_HALF_DEPTH);
    float around = round_box(p - vec3(0.0, half_height, BAR_Z), half_size, 0.0);
    float others = max(around, 1.5 * BAR_SPACING - 0.055);
    return vec2(min(speakers, min(bars, others)), min(speakers, bars * max(1.0, penumbra / others)));
}

// The surfaces that are not planes belong to several objects.
const float SOLE_OBJECT = -1.0;

// 0 the speakers, 1 the bars, 2 the floor.
float scene_estimate(vec3 p, out float object) {
    float speakers = speakers_distance(p);
    float bars = bars_distance(p);
    object = bars < speakers ? 1.0 : 0.0;
    return min(speakers, bars);
}

vec3 wood_color(vec3 p, vec3 n, vec3 dx, vec3 dy) {
    vec3 weight = pow(abs(n), vec3(6.0));
    weight /= weight.x + weight.y + weight.z;
    vec3 q = p * 0.16;
    dx *= 0.16;
    dy *= 0.16;
    return weight.x * sample_texture(0, q.zy, dx.zy, dy.zy).rgb + weight.y * sample_texture(0, q.xz, dx.xz, dy.xz).rgb
         + weight.z * sample_texture(0, q.xy, dx.xy, dy.xy).rgb;
}

vec3 cabinet_color(vec3 p, vec3 n, vec3 dx, vec3 dy) {
    float side = p.x < 0.0 ? -1.0 : 1.0;
    vec3 q = p - vec3(side, 1.0, 1.0) * SPEAKER_CENTRE;
    vec3 grain = wood_color(p + vec3(side * 3.1, 0.0, 0.0), n, dx, dy);
    vec3 color = grain * grain * vec3(0.80, 1.02, 1.25) + 0.24 * grain;
    vec2 scale = vec2(side, -1.0) / 2.5;
    vec2 uv = scale * vec2(q.x, q.y - 1.55) + 0.5;
    vec4 picture = sample_texture(1, uv, dx.xy * scale, dy.xy * scale);
    if (n.z < -0.8 && q.z < -1.9 && all(lessThan(abs(uv - 0.5), vec2(0.5)))) color = mix(color, picture.rgb, picture.a);
    float r = woofer_radius(side);
    float rim = sqrt(r * r - WOOFER_LEAD * WOOFER_LEAD);
    float axis = length(q.xy - vec2(0.0, WOOFER_Y));
    float rings = 0.5 + 0.5 * cos(34.0 * axis);
    vec3 membrane = mix(vec3(0.028, 0.030, 0.034), vec3(0.060, 0.062, 0.066), rings);
    vec3 cap = mix(vec3(0.30, 0.19, 0.08), membrane, smoothstep(0.33, 0.35, axis));
    vec3 rubber = mix(vec3(0.016), color, smoothstep(rim + 0.16, rim + 0.18, axis));
    vec3 woofer = mix(cap, rubber, smoothstep(rim - 0.03, rim - 0.01, axis));
    return axis < rim + 0.22 && q.z < -0.2 && abs(p.x) > 2.9 ? woofer : color;
}

vec3 bar_hue(float u) {
    vec3 middle = vec3(0.95, 0.10, 0.42);
    return u < 0.5 ? mix(vec3(1.0, 0.30, 0.05), middle, 2.0 * u) : mix(middle, vec3(0.06, 0.55, 1.0), 2.0 * u - 1.0);
}

vec3 bar_light(vec3 p) {
    float index = bar_index(p.x);
    float level = level_of_band(index);
    return bar_hue((index + 0.5) / 32.0) * (0.25 + 1.3 * level * smoothstep(-0.6, 1.0, p.y / (0.04 + BAR_HEIGHT * level)));
}


vec4 scene_glow(vec3 p, vec3 dx, vec3 dy) {
    return vec4(bar_light(p), bars_distance(p));
}

vec3 eye() {
    float t = frame_time;
    return vec3(5.0 * sin(0.2 * t), 3.95 + 1.15 * sin(0.13 * t + 0.6), -7.5 + 2.0 * sin(0.1 * t));
}

Material scene_material(int object, vec3 p, vec3 n, vec3 dx, vec3 dy) {
    if (object == 0) return Material(cabinet_color(p, n, dx, dy), 0.45, 0.0, vec3(0.0), 0.0, 0.0, 0.0, 0.0);
    if (object == 1) {
        float index = bar_index(p.x);
        vec3 hue = bar_hue((index + 0.5) / 32.0);
        return Material(0.5 * hue, 0.5, 0.0, bar_light(p), 0.0, 0.0, 0.0, 0.0);
    }
    vec2 from_speakers = p.xz - vec2(0.0, 10.0);
    vec2 from_eye = p.xz - eye().xz;
    float away = min(dot(from_speakers, from_speakers), dot(from_eye, from_eye));
    return Material(vec3(0.0, 0.12, 0.128), 0.9, 0.0, vec3(0.0), 0.38, 0.0, 1.0 - exp(-away / 3025.0), 0.0);
}

vec3 sky_color(vec3 direction, vec3 dx, vec3 dy) {
    float up = max(direction.y, 0.0);
    vec3 color = mix(vec3(0.012, 0.030, 0.062), vec3(0.004, 0.007, 0.020), smoothstep(0.05, 0.6, up));
    return color + vec3(0.30, 0.115, 0.050) * exp(-14.0 * up);
}

vec3 sky_ambient(vec3 normal, vec3 dx, vec3 dy) {
    vec3 ambient = mix(vec3(0.012, 0.050, 0.056), vec3(0.060, 0.075, 0.110), 0.5 + 0.5 * normal.y);
    return ambient + vec3(0.045, 0.036, 0.034) * max(-normal.z, 0.0);
}
