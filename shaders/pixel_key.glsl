// The key of a pixel, which the alpha channel of its first sample holds. It identifies the surfaces on the pixel's path:
// between pixels with different keys is an edge of the geometry.

// Keys are less than this prime. With ROUGH_KEY added, they are below 2048, where 16-bit floats hold integers exactly.
const float KEYS = 1021.0;

// Added to the key if the path meets a rough mirror, because its noise needs more samples.
const float ROUGH_KEY = 1024.0;

// Converts the key of a pixel to the negative key of one whose light is mostly of thin balls and glow of swarms, and back.
float faint_key(float key) {
    return -1.0 - key;
}
