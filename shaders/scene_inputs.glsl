// What a scene's expressions read beside the point: tables of the sound and pictures.

float table_band(float index) {
    int i = int(clamp(index, 0.0, 31.0));
    return frame_bands[i >> 2][i & 3];
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
