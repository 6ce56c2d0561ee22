// The inputs of a scene's expressions that need functions: tables of the sound, and textures.

#include "levels.glsl"
#include "texel_lists.glsl"

// The spectrum, the waveform, the numbers of the song's parts, the rows of the history, then texts and pictures as shapes
// (crates/render/src/frame/sound_tables.rs). The curves are cubic B-splines: each texel holds the polynomial between two
// entries, constant term first. The numbers are in x. All zero without sound.
//
// The first row of the shapes holds their numbers in x. The other rows hold the bilinear patches of a grid of distances
// (crates/field/src/graph/shape_atlas.rs): the coefficients of 1, x, y and xy.
uniform NUMBER_LIST sound_tables;

float shape_number(float index) {
    int number = int(clamp(index, 0.0, float(SHAPE_NUMBER_COUNT - 1)));
    return shape_rows > 0 ? TEXEL(sound_tables, shape_first + number).x : 0.0;
}

float shape_distance(float column, float row) {
    float along = column > 0.0 ? min(SHAPE_STEP * column, float(SHAPE_COLUMNS - 1)) : 0.0;
    float up = row > 0.0 ? min(SHAPE_STEP * row, float(shape_rows - 1)) : 0.0;
    int left = min(int(along), SHAPE_COLUMNS - 2);
    int lower = min(int(up), shape_rows - 2);
    int at = shape_first + (lower + 1) * SHAPE_COLUMNS + left;
    vec4 terms = shape_rows > 0 ? TEXEL(sound_tables, at) : vec4(1.0, 0.0, 0.0, 0.0);
    float x = along - float(left);
    float y = up - float(lower);
    return (terms.w * x + terms.z) * y + (terms.y * x + terms.x);
}

// Returns the number of the piece at the coordinate u in a row of `pieces` pieces. x is the position in the piece,
// 0..1. u is clamped to 0..1.
int table_piece(int pieces, float u, out float x) {
    float along = (u > 0.0 ? min(u, 1.0) : 0.0) * float(pieces);
    int piece = min(int(along), pieces - 1);
    x = along - float(piece);
    return piece;
}

float table_curve(vec4 piece, float x) {
    return ((piece.w * x + piece.z) * x + piece.y) * x + piece.x;
}

float table_row(int first, int pieces, float u) {
    float x;
    int piece = table_piece(pieces, u, x);
    return table_curve(TEXEL(sound_tables, first + piece), x);
}

float table_spectrum(float u) {
    return table_row(0, SPECTRUM_POINTS - 1, u);
}

float table_waveform(float u) {
    return table_row(SPECTRUM_POINTS - 1, WAVEFORM_POINTS - 1, u);
}

float table_part(float index) {
    int number = int(clamp(index, 0.0, float(PART_NUMBERS - 1)));
    return TEXEL(sound_tables, SPECTRUM_POINTS - 1 + WAVEFORM_POINTS - 1 + number).x;
}

// Blends the four rows around an age. The buffer has one extra row before the first row of the history.
float table_history(float u, float age) {
    const int PIECES = HISTORY_POINTS - 1;
    float x;
    int piece = table_piece(PIECES, u, x);
    float along = frame_clock.z + (age > 0.0 ? min(age, 1.0) : 0.0) * frame_clock.w;
    int upper = int(along);
    float y = along - float(upper);
    int at = SPECTRUM_POINTS - 1 + WAVEFORM_POINTS - 1 + PART_NUMBERS + upper * PIECES + piece;
    float sum = 0.0;
    // frame_reach.z is 0. Without this term, compilers unroll the loop, and four rows occupy registers at once.
    int rows = 4 + int(frame_reach.z);
    for (int row = 0; row < rows; row++) {
        // The weight is the cubic B-spline at the row's distance from the age.
        float off = abs(y + 1.0 - float(row));
        float far = 2.0 - off;
        float weight = off < 1.0 ? 2.0 / 3.0 - 0.5 * off * off * far : far * far * far / 6.0;
        sum += weight * table_curve(TEXEL(sound_tables, at + row * PIECES), x);
    }
    return sum;
}

#include "scene_textures.glsl"
#include "cell_hash.glsl"
