// The rounds that the loops of a pixel may run, in the variant LIMITED_ROUNDS: the interpreter on llvmpipe, which ends
// every loop of a group of pixels for good once all their loops together have run 65,535 rounds. After that the tapes of
// materials and light would no longer run, and the picture would show what happens to lie in the registers.
//
// Each texel of a tape is a round. Rays therefore take as many steps as they can afford, and longer ones when they are
// few. The rest of the rounds is for surfaces.

// How many rounds of the pixel may have run while rays of a kind are still traced. A group runs as many rounds in each step
// as the longest of its pixels. A pixel cannot count those of the others, so these numbers leave room: they are measured,
// not proven.
const int EYE_ROUNDS = 26000;
const int MIRROR_ROUNDS = 30000;
const int SHADOW_ROUNDS = 40000;

#ifdef LIMITED_ROUNDS
// Rounds of this pixel so far, and those of the last evaluation of the distance.
int rounds_run = 0;
int rounds_of_last = 1;

// How many of `most` steps a ray can afford.
int steps_left(int most, int rounds) {
    return min(most, (rounds - rounds_run) / rounds_of_last);
}
#else
int steps_left(int most, int rounds) {
    return most;
}
#endif

int trace_rounds(bool reflected) {
    return reflected ? MIRROR_ROUNDS : EYE_ROUNDS;
}
