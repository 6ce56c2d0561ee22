// Limits the rounds of a pixel's loops in the variant LIMITED_ROUNDS, the interpreter on llvmpipe. When the loops of a
// group of pixels have run 65,535 rounds together, llvmpipe ends all of these loops, and the image would show what was
// left in the registers.
//
// Each texel of a tape is a round. Rays therefore take only the steps that they can afford, and longer steps when few
// steps are left. The remaining rounds are for surfaces.

// Rounds of the pixel up to which rays of each kind are traced. A step takes as many rounds as the slowest pixel of the
// group needs, and a pixel cannot count the rounds of other pixels. The limits therefore leave room for slower pixels.
// They were measured, not proven.
const int EYE_ROUNDS = 26000;
const int MIRROR_ROUNDS = 30000;
const int SHADOW_ROUNDS = 40000;
// A ray through media takes fewer, longer steps beyond this.
const int MEDIUM_ROUNDS = 36000;

#ifdef LIMITED_ROUNDS
// Rounds of this pixel so far, and rounds of the last evaluation of the distance.
int rounds_run = 0;
int rounds_of_last = 1;

// Returns the number of steps that a ray can afford, at most `most`.
int steps_left(int most, int rounds) {
    return min(most, (rounds - rounds_run) / rounds_of_last);
}

void count_rounds(int count) {
    rounds_run += count;
}

// Counts an evaluation of the distance. The ray's own step takes four more rounds.
void count_rounds_of_step(int count) {
    rounds_of_last = count + 4;
    rounds_run += rounds_of_last;
}
#else
int steps_left(int most, int rounds) {
    return most;
}

void count_rounds(int count) {}

void count_rounds_of_step(int count) {}
#endif

int trace_rounds(bool reflected) {
    return reflected ? MIRROR_ROUNDS : EYE_ROUNDS;
}
