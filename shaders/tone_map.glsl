// Tone maps: they convert exposed light, which is finite and not negative, to linear light of the screen, 0..1.
// crates/field/src/lang/scene.rs assigns the numbers of TONE_MAP.

#if TONE_MAP == 0
// AgX (Troy Sobotka): light is desaturated, and a curve in logarithms maps 16.5 stops of it. Bright colours fade to
// white. The stops are 10 below and 6.5 above middle grey, which becomes 0.48 of the encoded range, with a slope of
// 2.2.
const mat3 AGX_INSET = mat3(
    0.842479062253094, 0.0423282422610123, 0.0423756549057051,
    0.0784335999999992, 0.878468636469772, 0.0784336,
    0.0792237451477643, 0.0791661274605434, 0.879142973793104);
const mat3 AGX_OUTSET = mat3(
    1.19687900512017, -0.0528968517574562, -0.0529716355144438,
    -0.0980208811401368, 1.15190312990417, -0.0980434501171241,
    -0.0990297440797205, -0.0989611768448433, 1.15107367264116);
const float AGX_DARKEST = -12.47393;
const float AGX_STOPS = 16.5;
// Raises the saturation, which is low in neutral AgX.
const float AGX_SATURATION = 1.4;
// The exponent that decodes the result. It gives a little more contrast than AgX's 2.2.
const float AGX_POWER = 2.36;

vec3 tone_map(vec3 color) {
    vec3 stops = log2(max(AGX_INSET * color, 1e-10));
    vec3 x = clamp((stops - AGX_DARKEST) / AGX_STOPS, 0.0, 1.0);
    // The sigmoid as a polynomial, within 0.003; 0 and 1 are preserved. (Toe of power 1.6, shoulder of 2.4.)
    vec3 y = 2.0 * x - 1.0;
    vec3 bend = 2.11095 * y - 0.32981;
    bend = bend * y - 3.83692;
    bend = bend * y - 0.21282;
    bend = bend * y + 2.64875;
    bend = bend * y + 1.16617;
    bend = bend * y - 0.88461;
    vec3 encoded = x + x * (1.0 - x) * bend;
    float luminance = dot(encoded, vec3(0.2126, 0.7152, 0.0722));
    encoded = AGX_OUTSET * (luminance + AGX_SATURATION * (encoded - luminance));
    return pow(clamp(encoded, 0.0, 1.0), vec3(AGX_POWER));
}
#elif TONE_MAP == 1
// ACES: Stephen Hill's fit of its reference rendering and sRGB output transforms, scaled to the other curves'
// brightness.
vec3 tone_map(vec3 color) {
    const mat3 inset = mat3(0.59719, 0.07600, 0.02840, 0.35458, 0.90834, 0.13383, 0.04823, 0.01566, 0.83777);
    const mat3 outset = mat3(1.60475, -0.10208, -0.00327, -0.53108, 1.10813, -0.07276, -0.07367, -0.00605, 1.07602);
    vec3 v = inset * (1.6 * min(color, 1e6));
    vec3 fitted = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081);
    return clamp(outset * fitted, 0.0, 1.0);
}
#elif TONE_MAP == 2
// Extended Reinhard on luminance (Abt 2022, section 3.2): light as bright as WHITE becomes white. It is scaled to
// match the other curves in brightness at medium light.
vec3 tone_map(vec3 color) {
    const float WHITE = 6.0;
    color *= 1.35;
    float luminance = dot(color, vec3(0.2126, 0.7152, 0.0722));
    return clamp(color * ((1.0 + luminance / (WHITE * WHITE)) / (1.0 + luminance)), 0.0, 1.0);
}
#else
vec3 tone_map(vec3 color) {
    return clamp(color, 0.0, 1.0);
}
#endif
