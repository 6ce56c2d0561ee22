// What a scene's expressions read besides the point: tables of the sound, and pictures.

float table_band(float index) {
    return frame_bands[int(clamp(index, 0.0, float(BAND_COUNT - 1)))].x;
}

// The spectrum, the waveform, then the rows of the history (src/frame/sound_tables.rs): cubic B-splines, of which each
// texel holds the four Bezier points between two entries (crates/field/src/graph/table.rs). All zero without sound.
uniform samplerBuffer sound_tables;

// The piece of a row of so many pieces, and the place in it, 0..1. The coordinate is clamped to 0..1.
int table_piece(int pieces, float u, out float x) {
    float along = (u > 0.0 ? min(u, 1.0) : 0.0) * float(pieces);
    int piece = min(int(along), pieces - 1);
    x = along - float(piece);
    return piece;
}

float table_curve(vec4 points, float x) {
    float s = 1.0 - x;
    return dot(points, vec4(s * s * s, 3.0 * s * s * x, 3.0 * s * x * x, x * x * x));
}

float table_row(int first, int pieces, float u) {
    float x;
    int piece = table_piece(pieces, u, x);
    return table_curve(texelFetch(sound_tables, first + piece), x);
}

float table_spectrum(float u) {
    return table_row(0, SPECTRUM_POINTS - 1, u);
}

float table_waveform(float u) {
    return table_row(SPECTRUM_POINTS - 1, WAVEFORM_POINTS - 1, u);
}

// Blends the four rows around that age. The first row in the buffer lies before the history's first.
float table_history(float u, float age) {
    const int PIECES = HISTORY_POINTS - 1;
    float x;
    int piece = table_piece(PIECES, u, x);
    float along = frame_clock.z + (age > 0.0 ? min(age, 1.0) : 0.0) * frame_clock.w;
    int upper = int(along);
    float y = along - float(upper);
    float s = 1.0 - y;
    vec4 rows = vec4(s * s * s / 6.0, 2.0 / 3.0 - 0.5 * y * y * (2.0 - y), 2.0 / 3.0 - 0.5 * s * s * (2.0 - s), y * y * y / 6.0);
    int at = SPECTRUM_POINTS - 1 + WAVEFORM_POINTS - 1 + upper * PIECES + piece;
    vec4 points = (rows.x * texelFetch(sound_tables, at) + rows.y * texelFetch(sound_tables, at + PIECES))
        + (rows.z * texelFetch(sound_tables, at + 2 * PIECES) + rows.w * texelFetch(sound_tables, at + 3 * PIECES));
    return table_curve(points, x);
}

#include "scene_textures.glsl"
#include "cell_hash.glsl"
