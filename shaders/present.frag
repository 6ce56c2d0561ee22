// Turns light into the finished frame: bloom, exposure, tone map, sRGB, grain.

#include "picture_block.glsl"
#include "post_block.glsl"
#include "tone_map.glsl"
#include "encode.glsl"

uniform sampler2D picture;          // linear light
uniform sampler2D bloom;            // scattered light

#ifdef MEAN
uniform sampler2D mean;             // mean of earlier exposures: exposed light
#endif

#ifdef FADE
uniform sampler2D before;           // exposed light of the previous scene
#endif

layout(location = 0) out vec4 screen;

#ifdef LIGHT
// The largest 16-bit float.
const vec3 EXPOSED_MAX = vec3(65504.0);
#endif

// Interleaved gradient noise (Jimenez 2014), 0..1: less visible than random noise, and the same in each frame.
float noise(vec2 pixel) {
    return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715))));
}

// Returns the noise that is added to a colour: -1.5..1.5 steps of 1/255 at a grain of 1, mostly near 0. Half a step
// hides banding. The noise is constant in time, for stills.
float grain(vec2 pixel) {
    float film = noise(pixel + vec2(57.0, 131.0)) + noise(pixel.yx + vec2(211.0, 17.0)) - 1.0;
    return noise(pixel) - 0.5 + picture_look.w * film;
}

// Natural vignetting: the fourth power of the cosine of the angle to the axis. The corners are at 45 degrees.
float falloff(vec2 place) {
    vec2 off = 2.0 * place - 1.0;
    float cosine2 = 1.0 / (1.0 + 0.5 * dot(off, off));
    return mix(1.0, cosine2 * cosine2, picture_look.z);
}

void main() {
    vec2 place = post_place();
    vec3 light = texelFetch(picture, ivec2(gl_FragCoord.xy), 0).rgb;
    light = mix(light, texture(bloom, place).rgb, picture_look.y);
    light *= picture_look.x * falloff(place);
#ifdef FADE
    light = mix(light, texture(before, place).rgb, post_target.z);
#endif
#ifdef LIGHT
    light = min(light, EXPOSED_MAX);
#ifdef MEAN
    // With weight 1 there is no earlier exposure. An equal exposure does not change the mean.
    vec3 earlier = texelFetch(mean, ivec2(gl_FragCoord.xy), 0).rgb;
    light = post_target.w < 1.0 ? earlier + (light - earlier) * post_target.w : light;
#endif
    screen = vec4(light, 1.0);
#else
#ifdef MEAN
    light = texelFetch(mean, ivec2(gl_FragCoord.xy), 0).rgb;
#endif
    screen = vec4(srgb_from_linear(tone_map(light)) + grain(gl_FragCoord.xy) / 255.0, 1.0);
#endif
}
