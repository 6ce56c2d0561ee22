// The tape's interpreter: runs programs that lie in texture buffers. Words, slots and operators: `src/tape/`;
// the variant's defines and its operators: `src/tape/interpreter.rs`, which writes operators.glsl.
//
// A program is a header texel and the texels of its clauses, four clauses in each:
//   header.x     first texel of its table in `tape_table`, and from bit 24 on how many texels of it are kept
//   header.yzw   the slots of up to 12 outputs, a byte each, the lowest byte first
// The slots 0..5 hold x, y, z and the normal at the start, as far as there are slots. A texel whose last word is
// END is the last one; other words END do nothing. Rare operators stand only in the last place of a texel.

#include "operators.glsl"

uniform usamplerBuffer tape;        // RGBA32UI
uniform samplerBuffer tape_table;   // RGBA32F: TABLE entries can be read beyond the end of any program's table

#ifdef COUNT_EVALUATIONS
float count_clauses = 0.0;          // clauses run in this pixel, times points, those that do nothing included
#define COUNT_TEXEL(points) count_clauses += 4.0 * points
#define CLAUSES_RUN count_clauses
#else
#define COUNT_TEXEL(points)
#endif

const int PAGE = 1, LOAD = 2, STORE = 3, RELOAD = 4, SELECT_TEXTURE = 5, TEXTURE = 6;
const int PAGE_TEXELS = 64;

// Slots, and behind them the table's first TABLE entries. Of up to 8 slots and 16 entries each is a variable, and
// an operand is selected by the bits of its number; more are arrays, where an operand is one read of one array.
#if SLOTS <= 8 && TABLE <= 16
#define SELECTED
#endif

// --- What a word says ---

#define BYTE(word, place) ((word >> (8 * place)) & 255u)
#define SLOT(word, place) (BYTE(word, place) & uint(SLOTS - 1))
#define HAS(word, place, bit) ((word & (1u << (8 * place + bit))) != 0u)

bool a_is_immediate(uint word) {
    return (word & 192u) == 192u || (word & 255u) == uint(LOAD);
}

bool b_is_immediate(uint word) {
    return (word & 192u) == 128u;
}

// The operator's number without the form of its operands; below 16 what is no operator.
int operator_number(uint word) {
    uint opcode = word & 255u;
    return int(opcode < 64u ? opcode : 64u | (opcode & 63u));
}

// The slot to write, or one that does not exist.
uint output_slot(uint word) {
#ifdef SILENT_CLAUSES
    int opcode = int(word & 255u);
    bool silent = opcode == PAGE || opcode == STORE || opcode == SELECT_TEXTURE;
    return silent ? uint(SLOTS + TABLE) : SLOT(word, 1);
#else
    return SLOT(word, 1);
#endif
}

// --- Reading and writing slots; `file` is an array of any type ---

#define PICK4(file, first, word, place) (HAS(word, place, 1) ? (HAS(word, place, 0) ? file[first + 3] : file[first + 2]) : (HAS(word, place, 0) ? file[first + 1] : file[first]))
#define PICK8(file, first, word, place) (HAS(word, place, 2) ? PICK4(file, first + 4, word, place) : PICK4(file, first, word, place))
#define PICK16(file, first, word, place) (HAS(word, place, 3) ? PICK8(file, first + 8, word, place) : PICK8(file, first, word, place))

#if SLOTS == 4
#define PICK_SLOT(file, word, place) PICK4(file, 0, word, place)
#else
#define PICK_SLOT(file, word, place) PICK8(file, 0, word, place)
#endif
#if TABLE == 4
#define PICK_ENTRY(file, word, place) PICK4(file, SLOTS, word, place)
#elif TABLE == 8
#define PICK_ENTRY(file, word, place) PICK8(file, SLOTS, word, place)
#else
#define PICK_ENTRY(file, word, place) PICK16(file, SLOTS, word, place)
#endif

#define WRITE(file, i, at, value) file[i] = at == uint(i) ? value : file[i]
#define WRITE_SLOT4(file, at, value) WRITE(file, 0, at, value); WRITE(file, 1, at, value); WRITE(file, 2, at, value); WRITE(file, 3, at, value)
#define WRITE_SLOT8(file, at, value) WRITE_SLOT4(file, at, value); WRITE(file, 4, at, value); WRITE(file, 5, at, value); WRITE(file, 6, at, value); WRITE(file, 7, at, value)
#ifdef SELECTED
#define READ_SLOT(file, word, place) PICK_SLOT(file, word, place)
#if SLOTS == 4
#define WRITE_SLOT(file, at, value) WRITE_SLOT4(file, at, value)
#else
#define WRITE_SLOT(file, at, value) WRITE_SLOT8(file, at, value)
#endif
#else
#define READ_SLOT(file, word, place) file[SLOT(word, place)]
#define WRITE_SLOT(file, at, value) file[at] = value
#endif

#define FIRST_TEXEL(head) int(head.x & 0xFFFFFFu)
#if TABLE == 0
int table = 0;   // the table's first texel
int page = 0;    // that of the page that immediates index
float table_entry(uint entry) {
    vec4 four = texelFetch(tape_table, page + int(entry >> 2));
    return (entry & 2u) == 0u ? ((entry & 1u) == 0u ? four.x : four.y) : ((entry & 1u) == 0u ? four.z : four.w);
}
#define READ_A(type, file, word) (a_is_immediate(word) ? type(entry) : READ_SLOT(file, word, 2))
#define READ_B(type, file, word) (b_is_immediate(word) ? type(entry) : READ_SLOT(file, word, 3))
#define FETCH_IMMEDIATE(word) float entry = table_entry(b_is_immediate(word) ? BYTE(word, 3) : BYTE(word, 2))
#else
#define FETCH_IMMEDIATE(word)
// How many texels of a table are copied. For arrays drivers must not know a small number: they would write the loop
// out, which takes long to compile.
#ifdef SELECTED
#define KEPT_TEXELS(head) (TABLE / 4)
#else
#define KEPT_TEXELS(head) min(int(head.x >> 24), PAGE_TEXELS)
#endif
#define KEPT(i) (SLOTS + ((4 * i) & (TABLE - 1)))
#ifdef SELECTED
#define READ_A(type, file, word) (a_is_immediate(word) ? PICK_ENTRY(file, word, 2) : READ_SLOT(file, word, 2))
#define READ_B(type, file, word) (b_is_immediate(word) ? PICK_ENTRY(file, word, 3) : READ_SLOT(file, word, 3))
#else
#define READ_A(type, file, word) file[a_is_immediate(word) ? uint(SLOTS) + (BYTE(word, 2) & uint(TABLE - 1)) : SLOT(word, 2)]
#define READ_B(type, file, word) file[b_is_immediate(word) ? uint(SLOTS) + (BYTE(word, 3) & uint(TABLE - 1)) : SLOT(word, 3)]
#endif
#endif

// --- One point of a region ---

// Slots of a region's tape. A tape is a run of texels of two clauses, each followed by its immediate; the first one does
// nothing where its word is 0. The last texel's second word is END with the slots of the results in its bytes 2 and 3.
float region_file[REGION_SLOTS];

#define REGION_SLOT(word, place) (BYTE(word, place) & uint(REGION_SLOTS - 1))
#if REGION_SLOTS == 4
#define READ_REGION(word, place) PICK4(region_file, 0, word, place)
#elif REGION_SLOTS == 8
#define READ_REGION(word, place) PICK8(region_file, 0, word, place)
#else
#define READ_REGION(word, place) region_file[REGION_SLOT(word, place)]
#endif

// Runs a clause. Rare operators are computed where `last` is true: a constant.
void region_clause(uint word, uint immediate, const bool last) {
    int number = operator_number(word);
    float a = a_is_immediate(word) ? uintBitsToFloat(immediate) : READ_REGION(word, 2);
    float b = b_is_immediate(word) ? uintBitsToFloat(immediate) : READ_REGION(word, 3);
    float r = common_operator(number, a, b);
    if (last) r = rare_operator(number, r, a, b);
    uint at = REGION_SLOT(word, 1);
    // END gives the slot of its byte 2 to itself.
    if (last && number == 0) at = REGION_SLOT(word, 2);
#if REGION_SLOTS == 4
    WRITE_SLOT4(region_file, at, r);
#elif REGION_SLOTS == 8
    WRITE_SLOT8(region_file, at, r);
#else
    region_file[at] = r;
#endif
}

// The results of a region's tape at a point: bound and estimate, or an object.
vec2 run_region(int tape, vec3 p, float penumbra) {
    region_file[0] = p.x;
    region_file[1] = p.y;
    region_file[2] = p.z;
    region_file[3] = penumbra;
    uvec4 words = uvec4(0u);
    for (int texel = 0; texel < TEXELS_MAX; ++texel) {
        words = texelFetch(regions, tape + texel);
        COUNT_TEXEL(2.0);
#ifdef EVERY_CASE
        region_clause(words.x, words.y, false);
#else
        region_clause(words.x, words.y, true);
#endif
        region_clause(words.z, words.w, true);
        if ((words.z & 255u) == 0u) break;
    }
    return vec2(READ_REGION(words.z, 2), READ_REGION(words.z, 3));
}

// --- Four points ---

vec4 lanes_file[SLOTS + TABLE + 1];
#if MEMORY > 0
vec4 lanes_memory[MEMORY];
#endif
#if TEXTURES > 0
uint selected_texture = 0u;     // the word of the last SELECT_TEXTURE
vec4 sample_texture(int index, vec2 uv, vec2 dx, vec2 dy);
#endif

void lanes_clause(uint word, const bool last, vec4 x, vec4 y, vec4 z, vec4 nx, vec4 ny, vec4 nz) {
    int number = operator_number(word);
    FETCH_IMMEDIATE(word);
    vec4 a = READ_A(vec4, lanes_file, word);
    vec4 b = READ_B(vec4, lanes_file, word);
    vec4 r = common_operator(number, a, b);
    if (last) r = rare_operator(number, r, a, b);
#ifdef INPUT_CLAUSES
    r = number == 8 ? x : number == 9 ? y : number == 10 ? z : r;
    r = number == 11 ? nx : number == 12 ? ny : number == 13 ? nz : r;
#endif
#if MEMORY > 0
    if (last) {
        uint place = (word >> 16) & uint(MEMORY - 1);
        if (number == RELOAD) r = lanes_memory[place];
        if (number == STORE) lanes_memory[place] = READ_SLOT(lanes_file, word, 1);
    }
#endif
#if TEXTURES > 0
    if (number == SELECT_TEXTURE) selected_texture = word;
#endif
#if TABLE == 0
    if (number == PAGE) page = table + PAGE_TEXELS * int(word >> 16);
#endif
    uint at = output_slot(word);
#if TEXTURES > 0
    if (number == TEXTURE) at = uint(SLOTS + TABLE);    // run_textures writes it
#endif
    WRITE_SLOT(lanes_file, at, r);
}

#if TEXTURES > 0
// Textures are read at point 0, with points 1 and 2 as those of the pixels to the right and above, and have one value
// for all four.
void run_texture(uint word) {
    vec4 u = READ_SLOT(lanes_file, word, 2);
    vec4 v = READ_SLOT(lanes_file, word, 3);
    vec2 uv = vec2(u.x, v.x);
    vec4 texel = sample_texture(int(selected_texture >> 16), uv, vec2(u.y, v.y) - uv, vec2(u.z, v.z) - uv);
    uint channel = BYTE(selected_texture, 1);
    vec4 r = vec4(channel < 2u ? (channel == 0u ? texel.x : texel.y) : (channel == 2u ? texel.z : texel.w));
    uint at = SLOT(word, 1);
    WRITE_SLOT(lanes_file, at, r);
}
#endif

// All outputs at the four points (x.i, y.i, z.i) with the normals (nx.i, ny.i, nz.i).
void run_lanes(int program, vec4 x, vec4 y, vec4 z, vec4 nx, vec4 ny, vec4 nz, out vec4 results[12]) {
    uvec4 head = texelFetch(tape, program);
#if TABLE == 0
    table = FIRST_TEXEL(head);
    page = table;
#else
    for (int i = 0; i < KEPT_TEXELS(head); ++i) {
        vec4 four = texelFetch(tape_table, FIRST_TEXEL(head) + i);
        lanes_file[KEPT(i)] = vec4(four.x);
        lanes_file[KEPT(i) + 1] = vec4(four.y);
        lanes_file[KEPT(i) + 2] = vec4(four.z);
        lanes_file[KEPT(i) + 3] = vec4(four.w);
    }
#endif
    lanes_file[0] = x;
    lanes_file[1] = y;
    lanes_file[2] = z;
    lanes_file[3] = nx;
#if SLOTS > 4
    lanes_file[4] = ny;
    lanes_file[5] = nz;
#endif
    // Textures are read between runs of texels: what never skips a branch would read them in every texel.
    int texel = 1;
    for (int run = 0; run <= TEXELS_MAX; ++run) {
        uint last = 0u;
        for (; texel <= TEXELS_MAX; ++texel) {
            uvec4 words = texelFetch(tape, program + texel);
            COUNT_TEXEL(4.0);
            last = words.w;
#ifdef EVERY_CASE
            lanes_clause(words.x, false, x, y, z, nx, ny, nz);
            lanes_clause(words.y, false, x, y, z, nx, ny, nz);
            lanes_clause(words.z, false, x, y, z, nx, ny, nz);
            lanes_clause(words.w, true, x, y, z, nx, ny, nz);
#else
            for (int i = 0; i < 4; ++i) lanes_clause(words[i], true, x, y, z, nx, ny, nz);
#endif
            if ((last & 255u) == 0u || operator_number(last) == TEXTURE) break;
        }
        if ((last & 255u) == 0u || texel > TEXELS_MAX) break;
#if TEXTURES > 0
        run_texture(last);
#endif
        ++texel;
    }
    results[0] = READ_SLOT(lanes_file, head.y, 0);
    results[1] = READ_SLOT(lanes_file, head.y, 1);
    results[2] = READ_SLOT(lanes_file, head.y, 2);
    results[3] = READ_SLOT(lanes_file, head.y, 3);
    results[4] = READ_SLOT(lanes_file, head.z, 0);
    results[5] = READ_SLOT(lanes_file, head.z, 1);
    results[6] = READ_SLOT(lanes_file, head.z, 2);
    results[7] = READ_SLOT(lanes_file, head.z, 3);
    results[8] = READ_SLOT(lanes_file, head.w, 0);
    results[9] = READ_SLOT(lanes_file, head.w, 1);
    results[10] = READ_SLOT(lanes_file, head.w, 2);
    results[11] = READ_SLOT(lanes_file, head.w, 3);
}
