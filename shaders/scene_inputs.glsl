// What a scene's expressions read besides the point: tables of the sound, and pictures.

float table_band(float index) {
    return frame_bands[int(clamp(index, 0.0, float(BAND_COUNT - 1)))].x;
}

// The spectrum, then the waveform, then the rows of the history (src/frame/sound_tables.rs). All zero without sound.
uniform samplerBuffer sound_tables;

// Interpolates between the entries of the row that begins at that texel; the coordinate is clamped to 0..1.
float table_row(int first, int count, float u) {
    float along = (u > 0.0 ? min(u, 1.0) : 0.0) * float(count - 1);
    int left = int(along);
    float x = along - float(left);
    float low = texelFetch(sound_tables, first + left).x;
    float high = texelFetch(sound_tables, first + min(left + 1, count - 1)).x;
    return low * (1.0 - x) + high * x;
}

float table_spectrum(float u) {
    return table_row(0, SPECTRUM_POINTS, u);
}

float table_waveform(float u) {
    return table_row(SPECTRUM_POINTS, WAVEFORM_POINTS, u);
}

float table_history(float u, float age) {
    float along = frame_clock.z + (age > 0.0 ? min(age, 1.0) : 0.0) * frame_clock.w;
    int upper = int(along);
    float y = along - float(upper);
    int first = SPECTRUM_POINTS + WAVEFORM_POINTS + upper * HISTORY_POINTS;
    return table_row(first, HISTORY_POINTS, u) * (1.0 - y) + table_row(first + HISTORY_POINTS, HISTORY_POINTS, u) * y;
}

#include "scene_textures.glsl"
#include "cell_hash.glsl"
