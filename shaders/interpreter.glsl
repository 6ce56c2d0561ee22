// The interpreter of tapes. `crates/field/src/tape/` describes clauses, registers and operators;
// `interpreter.rs` there describes texels and the variant's defines, and writes operators.glsl.
//
// At the start the registers hold x, y, z and the normal. For a region's tape, the register of the normal's x holds the
// penumbra: the distance beyond which a surface casts no shadow.
//
// There are two loops over clauses. The loop with EVERY_CASE is for renderers that never skip a branch. It runs both
// clauses of a texel in one round. Rare operators are always second in a texel and run between runs of texels, because
// they would otherwise be computed with every clause. The second loop is for GPUs, which skip branches. It runs one
// clause per round, because compilers inline a function at each call.

#include "texel_lists.glsl"

uniform WORD_LIST tape;             // RGBA32UI

#ifdef COUNT_EVALUATIONS
float count_clauses = 0.0;          // clauses of regions run in this pixel, including empty clauses
float count_surface_clauses = 0.0;  // clauses of materials and light
#define COUNT_CLAUSES(counter, count) counter += count
#define CLAUSES_RUN count_clauses
#define SURFACE_CLAUSES_RUN count_surface_clauses
#else
#define COUNT_CLAUSES(counter, count)
#endif

#define BYTE(word, place) ((word >> (8 * place)) & 255u)
#define HAS(word, place, bit) ((word & (1u << (8 * place + bit))) != 0u)

// True if the operand at `place` is the immediate, according to the clause's form or, with at most 128 registers, to
// the operand's byte.
bool form_is_immediate(uint word, const int place) {
    // LOAD has the number 2.
    return place == 2 ? (word & 192u) == 192u || (word & 255u) == 2u : (word & 192u) == 128u;
}

// Returns the operator's number without the form of its operands; numbers below 16 are not operators.
int operator_number(uint word) {
    uint opcode = word & 255u;
    return int(opcode < 64u ? opcode : 64u | (opcode & 63u));
}

// The operators, and the macros READ(word, place) and WRITE(at, value) for registers. If there are few registers, they
// are variables, selected by the bits of the register's number. Otherwise they are in an array.
#include "operators.glsl"

// CLAUSE_PLACE is the type of `last`, which is true for the second clause of a texel. FORGET clears registers before a run,
// so that compilers for GPUs drop the old values. On a CPU this would take time.
#ifdef EVERY_CASE
#define CLAUSE_PLACE const bool
#define FORGET(file, first, count)
#else
#define CLAUSE_PLACE bool
#define FORGET(file, first, count) for (int i = first; i < count; ++i) file[i] = 0.0
#endif

float region_file[REGION_REGISTERS];

// Runs a clause. With EVERY_CASE, run_region computes rare operators from the operands a and b.
void region_clause(uint word, uint immediate, out float a, out float b) {
    a = REGION_OPERAND(word, 2, immediate);
    b = REGION_OPERAND(word, 3, immediate);
    float r = region_common(word, a, b, uintBitsToFloat(immediate));
    REGION_WRITE(BYTE(word, 1), r);
}

// Returns the results of a region's tape at a point: bound and estimate, or an object.
vec2 run_region(int first, vec3 p, float penumbra) {
    region_file[0] = p.x;
    region_file[1] = p.y;
    region_file[2] = p.z;
    region_file[3] = penumbra;
    FORGET(region_file, 4, REGION_REGISTERS);
    uvec4 words = uvec4(0u);
    int texel = first;
    float a;
    float b;
#ifdef EVERY_CASE
    // llvmpipe needs a second exit of the loop. Without a second exit, the lanes that end first lose the last texel
    // that they read. Tried: a loop without a counter. The same lanes lost their last texel, so images were wrong.
    //
    // Tried on llvmpipe: two texels in each round. This takes 7 % fewer instructions, but gyroid takes 11 % longer
    // because its rare operators end rounds early. Tried: roots as rare operators. This saves 7 % in kaleidoscope and
    // costs 5 % in lattice and wave_tank.
    int end = first + TEXELS_MAX;
    for (int round = 0; round < TEXELS_MAX; ++round) {
        while (texel < end) {
            words = TEXEL(regions, texel);
            texel++;
            COUNT_CLAUSES(count_clauses, 2.0);
            region_clause(words.x, words.y, a, b);
            region_clause(words.z, words.w, a, b);
            if ((words.z & 255u) == 0u || region_is_rare(operator_number(words.z))) break;
        }
        if ((words.z & 255u) == 0u) break;
        float r = region_rare(words.z, a, b, 0.0);
        REGION_WRITE(BYTE(words.z, 1), r);
    }
    count_rounds_of_step(texel - first);
#else
    for (int i = 0; i < 2 * TEXELS_MAX; ++i) {
        bool last = (i & 1) != 0;
        if (last) { words.xy = words.zw; } else { words = TEXEL(regions, texel); texel++; }
        COUNT_CLAUSES(count_clauses, 1.0);
        region_clause(words.x, words.y, a, b);
        if (last && (words.x & 255u) == 0u) break;
    }
#endif
    return vec2(REGION_READ(words.z, 2), REGION_READ(words.z, 3));
}

// The registers, and the sampled colours with four channels per texture. GPUs' compilers put arrays of more than 64
// registers into memory (crates/field/src/tape/interpreter.rs). The colours then follow the registers in the same
// array, because a separate array would occupy registers during all of the shading.
#if REGISTERS > 64 && !defined(EVERY_CASE)
float tape_file[REGISTERS + 4 * SAMPLES];
#define SAMPLED(at) tape_file[uint(REGISTERS) + uint(at)]
#define FORGET_SAMPLED
#else
float tape_file[REGISTERS];
#if SAMPLES > 0
float sampled[4 * SAMPLES];
#endif
#define SAMPLED(at) sampled[at]
#define FORGET_SAMPLED FORGET(sampled, 0, 4 * SAMPLES)
#endif

void tape_clause(uint word, uint immediate, CLAUSE_PLACE last, out float a, out float b) {
    a = OPERAND(word, 2, immediate);
    b = OPERAND(word, 3, immediate);
    float r = tape_common(word, a, b, uintBitsToFloat(immediate));
#if SAMPLES > 0
    if (last && (word & 255u) == uint(TEXTURE)) r = SAMPLED(min(immediate, uint(4 * SAMPLES - 1)));
#endif
    WRITE(BYTE(word, 1), r);
}

// Runs a tape at a point. The results stay in their registers; the first two are returned.
vec2 run_tape(int first, vec3 p, vec3 n) {
    tape_file[0] = p.x;
    tape_file[1] = p.y;
    tape_file[2] = p.z;
    tape_file[3] = n.x;
    tape_file[4] = n.y;
    tape_file[5] = n.z;
    FORGET(tape_file, 6, REGISTERS);
    uvec4 words = uvec4(0u);
    int texel = first;
    float a;
    float b;
#ifdef EVERY_CASE
    int end = first + TEXELS_MAX;
    for (int round = 0; round < TEXELS_MAX; ++round) {
        while (texel < end) {
            words = TEXEL(tape, texel);
            texel++;
            COUNT_CLAUSES(count_surface_clauses, 2.0);
            tape_clause(words.x, words.y, false, a, b);
            tape_clause(words.z, words.w, true, a, b);
            if ((words.z & 255u) == 0u || tape_is_rare(operator_number(words.z))) break;
        }
        if ((words.z & 255u) == 0u) break;
        float r = tape_rare(words.z, a, b, 0.0);
        WRITE(BYTE(words.z, 1), r);
    }
    count_rounds(texel - first);
#else
    for (int i = 0; i < 2 * TEXELS_MAX; ++i) {
        bool last = (i & 1) != 0;
        if (last) { words.xy = words.zw; } else { words = TEXEL(tape, texel); texel++; }
        COUNT_CLAUSES(count_surface_clauses, 1.0);
        tape_clause(words.x, words.y, last, a, b);
        if (last && (words.x & 255u) == 0u) break;
    }
#endif
    return vec2(READ(words.z, 2), READ(words.z, 3));
}
