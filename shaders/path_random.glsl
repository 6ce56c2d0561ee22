// Numbers in 0..1 for paths: Sobol's sequence in two dimensions, with Owen's scrambling by a hash (Burley 2020, "Practical
// hash-based Owen scrambling"). Each pixel and each pair of numbers of a path has another scrambling. Only integers
// decide, so the same command gives the same image.

uint path_seed;     // of the pixel
uint path_index;    // number of the path in the sequence

// The permutation of the PCG family (O'Neill 2014).
uint hashed(uint x) {
    x = x * 747796405u + 2891336453u;
    x = ((x >> ((x >> 28u) + 4u)) ^ x) * 277803737u;
    return (x >> 22u) ^ x;
}

uint reversed(uint x) {
    x = ((x >> 1u) & 0x55555555u) | ((x & 0x55555555u) << 1u);
    x = ((x >> 2u) & 0x33333333u) | ((x & 0x33333333u) << 2u);
    x = ((x >> 4u) & 0x0F0F0F0Fu) | ((x & 0x0F0F0F0Fu) << 4u);
    x = ((x >> 8u) & 0x00FF00FFu) | ((x & 0x00FF00FFu) << 8u);
    return (x >> 16u) | (x << 16u);
}

// Scrambles a number whose bits are reversed: each bit depends on the bits before it (Laine and Karras 2011).
uint permuted(uint x, uint seed) {
    x += seed;
    x ^= x * 0x6C50B47Cu;
    x ^= x * 0xB82F1E52u;
    x ^= x * 0xC7AFE638u;
    x ^= x * 0x8D22F6E6u;
    return x;
}

float unit_of(uint x) {
    return float(x >> 8u) * (1.0 / 16777216.0);
}

// Paths have at most 2^16 samples, so these bits of a sample's place in the sequence are enough.
const int SEQUENCE_BITS = 16;

// Returns a pair of numbers of the path.
vec2 random_pair(int pair) {
    uint seed = hashed(path_seed ^ hashed(uint(pair) + 1u));
    uint place = reversed(permuted(reversed(path_index), seed));
    uint second = 0u;
    uint number = 0x80000000u;
    for (int bit = 0; bit < SEQUENCE_BITS; bit++) {
        second ^= ((place >> bit) & 1u) != 0u ? number : 0u;
        number ^= number >> 1u;
    }
    // The first number of the sequence is `place` with its bits reversed, so that two reversals cancel.
    return vec2(unit_of(reversed(permuted(place, hashed(seed ^ 0x68BC21EBu)))),
                unit_of(reversed(permuted(reversed(second), hashed(seed ^ 0x02E5BE93u)))));
}

#ifdef MEDIA
uint path_stream;   // state of a sequence of independent numbers

float next_random() {
    path_stream = hashed(path_stream);
    return unit_of(path_stream);
}
#endif
