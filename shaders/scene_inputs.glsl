// What a scene's expressions read beside the point: tables of the sound and pictures.

float table_band(float index) {
    return frame_bands[int(clamp(index, 0.0, float(BAND_COUNT - 1)))].x;
}

// The sound's side does not compute these yet.
float table_spectrum(float u) {
    return 0.0;
}
float table_waveform(float u) {
    return 0.0;
}
float table_history(float u, float age) {
    return 0.0;
}

#include "scene_textures.glsl"
#include "cell_hash.glsl"
