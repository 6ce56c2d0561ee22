//! What the interpreter of `shaders/interpreter.glsl` needs: programs as words, and the text of a variant.
//!
//! **Programs.** [`Tape::program`] writes a header and the clauses, four in a texel. Inputs of the point that
//! would be read into the slots where the interpreter has them at the start are left out. Rare operators
//! ([`is_rare`]) are put last in a texel, by words END before them, which do nothing there: a renderer that never
//! skips a branch then computes them once in four clauses. So the last word of a texel is END only in the
//! program's last texel.
//!
//! **Variants.** The text holds the operators that stand in a [`Variant`] and no others. `EVERY_CASE` is for
//! renderers that never skip a branch (llvmpipe): all cases are computed and the result is selected. Without it
//! there is a switch.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use super::glsl::fill;
use super::{Instruction, Tape};
use crate::graph::Op;
use crate::limits::LIMITS;

/// Most outputs of a program.
pub const PROGRAM_OUTPUTS_MAX: usize = 12;
/// Most entries of a table that a variant keeps beside its slots; more are fetched one by one.
const KEPT_TABLE_MAX: usize = 256;
/// The same where every thread pays for its own copy.
const KEPT_TABLE_MAX_OF_A_GPU: usize = 16;

/// Whether an operator costs several times an addition: those run in the last place of a texel only.
pub fn is_rare(op: Op) -> bool {
    matches!(
        op,
        Op::Exp
            | Op::Exp2
            | Op::Log
            | Op::Log2
            | Op::Pow
            | Op::Sin
            | Op::Cos
            | Op::Tan
            | Op::Asin
            | Op::Acos
            | Op::Atan
            | Op::Atan2
            | Op::Sinh
            | Op::Cosh
            | Op::Tanh
            | Op::Hash
            | Op::Band
            | Op::Spectrum
            | Op::Waveform
            | Op::History
    )
}

impl Tape {
    /// Appends the tape to `words` as a program of the interpreter: a header texel, then the clauses.
    /// `table_texel` is where its table begins in the buffer of tables, in texels of four entries,
    /// below 2^24.
    ///
    /// Only the first [`PROGRAM_OUTPUTS_MAX`] outputs can be asked of the interpreter.
    pub fn append_program(&self, table_texel: u32, words: &mut Vec<u32>) {
        let mut outputs = [0u8; PROGRAM_OUTPUTS_MAX];
        for (byte, slot) in outputs.iter_mut().zip(self.outputs()) {
            *byte = *slot;
        }
        let (outputs, _) = outputs.as_chunks::<4>();
        let start = words.len();
        let kept = self.table().len().min(KEPT_TABLE_MAX).div_ceil(4) as u32;
        words.push(table_texel & 0xFF_FFFF | kept << 24);
        words.extend(outputs.iter().map(|four| u32::from_le_bytes(*four)));
        for (clause, instruction) in self.program_clauses() {
            if is_last(instruction) {
                while (words.len() - start) % 4 != 3 {
                    words.push(0);
                }
            }
            words.push(clause);
        }
        words.push(0);
        while !(words.len() - start).is_multiple_of(4) {
            words.push(0);
        }
    }

    /// The clauses of the program, without inputs that stand in their slots at the start.
    fn program_clauses(&self) -> impl Iterator<Item = (u32, Instruction)> + '_ {
        self.clauses()
            .iter()
            .filter_map(|clause| clause.decode().map(|instruction| (clause.word(), instruction)))
            .skip_while(|(_, instruction)| {
                matches!(instruction, Instruction::Input { output, place } if output == place)
            })
    }
}

/// Whether an instruction must stand last in its texel.
fn is_last(instruction: Instruction) -> bool {
    match instruction {
        Instruction::Unary { op, .. } | Instruction::Binary { op, .. } => is_rare(op),
        Instruction::Store { .. } | Instruction::Reload { .. } | Instruction::Texture { .. } => true,
        _ => false,
    }
}

/// What an interpreter can run, and how.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Variant {
    /// Operators that stand in the text.
    pub operators: BTreeSet<Op>,
    /// Slots: a power of two, 4 to 256.
    pub slots: usize,
    /// Entries of the table that are kept beside the slots: a power of two, 4 to 256. 0: any number, which are
    /// fetched where they are used.
    pub table: usize,
    /// Values of memory: 0 or a power of two.
    pub memory: usize,
    /// Textures.
    pub textures: usize,
    /// Whether inputs are read again after the start.
    pub inputs: bool,
    /// Whether all cases are computed and one is selected: for renderers that never skip a branch.
    pub every_case: bool,
}

impl Variant {
    /// The variant that runs all of these tapes, its numbers rounded up so that few variants serve many scenes.
    pub fn of<'a>(tapes: impl IntoIterator<Item = &'a Tape>, every_case: bool) -> Self {
        let mut variant = Self {
            operators: BTreeSet::new(),
            slots: 4,
            table: 4,
            memory: 0,
            textures: 0,
            inputs: false,
            every_case,
        };
        for tape in tapes {
            variant.operators.extend(tape.operators());
            variant.slots = variant.slots.max(tape.slots().next_power_of_two());
            variant.table = variant.table.max(tape.table().len().next_power_of_two());
            if tape.memory() > 0 {
                variant.memory = variant.memory.max(tape.memory().next_power_of_two());
            }
            for (_, instruction) in tape.program_clauses() {
                match instruction {
                    Instruction::Input { .. } => variant.inputs = true,
                    Instruction::SelectTexture { texture, .. } => {
                        variant.textures = variant.textures.max(usize::from(texture) + 1);
                    }
                    _ => {}
                }
            }
        }
        let kept_max = if every_case { KEPT_TABLE_MAX } else { KEPT_TABLE_MAX_OF_A_GPU };
        if variant.table > kept_max {
            variant.table = 0;
        }
        variant
    }

    /// Whether what `other` was made for can be run by this one.
    pub fn covers(&self, other: &Self) -> bool {
        let table = self.table == 0 || (other.table > 0 && self.table >= other.table);
        self.operators.is_superset(&other.operators)
            && self.slots >= other.slots
            && table
            && self.memory >= other.memory
            && self.textures >= other.textures
            && (self.inputs || !other.inputs)
            && self.every_case == other.every_case
    }

    /// The text of `operators.glsl`: the defines and the operators of the variant. It relies on what
    /// [`super::glsl`] lists, as far as its operators use it.
    pub fn text(&self) -> String {
        let mut text = String::with_capacity(8192);
        self.write(&mut text);
        text
    }

    fn write(&self, text: &mut String) {
        // Writing to a String cannot fail.
        let silent = self.table == 0 || self.memory > 0 || self.textures > 0;
        let numbers = [("SLOTS", self.slots), ("TABLE", self.table), ("MEMORY", self.memory)];
        for (name, number) in numbers {
            let _ = writeln!(text, "#define {name} {number}");
        }
        let _ = writeln!(text, "#ifndef TEXTURES\n#define TEXTURES {}\n#endif", self.textures);
        let flags =
            [("INPUT_CLAUSES", self.inputs), ("SILENT_CLAUSES", silent), ("EVERY_CASE", self.every_case)];
        for (name, _) in flags.iter().filter(|(_, set)| *set) {
            let _ = writeln!(text, "#define {name}");
        }
        // A texel may hold a single clause.
        let _ = writeln!(text, "const int TEXELS_MAX = {};", LIMITS.tape_clauses_max + 1);
        for &op in self.operators.iter().filter(|op| needs_scalars(**op)) {
            write_scalar_function(text, op);
        }
        let (rare, common): (Vec<Op>, Vec<Op>) =
            self.operators.iter().partition(|op| self.every_case && is_rare(**op));
        for (vector, lanes) in [("float", false), ("vec4", true)] {
            let _ = writeln!(text, "{vector} common_operator(int number, {vector} a, {vector} b) {{");
            let _ = writeln!(text, "    {vector} r = a;");
            self.write_cases(text, &common, lanes);
            let _ = writeln!(text, "}}");
            let _ =
                writeln!(text, "{vector} rare_operator(int number, {vector} r, {vector} a, {vector} b) {{");
            self.write_cases(text, &rare, lanes);
            let _ = writeln!(text, "}}");
        }
    }

    fn write_cases(&self, text: &mut String, operators: &[Op], lanes: bool) {
        if !self.every_case {
            text.push_str("    switch (number) {\n");
        }
        for &op in operators {
            let number = op.number();
            let value = expression(op, lanes);
            let _ = if self.every_case {
                writeln!(text, "    r = number == {number} ? {value} : r;")
            } else {
                writeln!(text, "    case {number}: r = {value}; break;")
            };
        }
        if !self.every_case {
            text.push_str("    default: break;\n    }\n");
        }
        text.push_str("    return r;\n");
    }
}

/// Whether an operator's template works on single numbers only.
fn needs_scalars(op: Op) -> bool {
    ["?", "float(", "cell_hash", "table_"].iter().any(|word| op.glsl().contains(word))
}

/// `float op_67(float a, float b) { return ..; }`
fn write_scalar_function(text: &mut String, op: Op) {
    let operands = if op.arity() == 1 { "float a" } else { "float a, float b" };
    let _ = write!(text, "float op_{}({operands}) {{ return ", op.number());
    fill(text, op.glsl(), "a", "b");
    text.push_str("; }\n");
}

/// The operator on `a` and `b`, single numbers or four at once.
fn expression(op: Op, lanes: bool) -> String {
    let mut text = String::new();
    if lanes && needs_scalars(op) {
        let calls = ["x", "y", "z", "w"].map(|lane| {
            let b = if op.arity() == 1 { String::new() } else { format!(", b.{lane}") };
            format!("op_{}(a.{lane}{b})", op.number())
        });
        let _ = write!(text, "vec4({})", calls.join(", "));
    } else {
        text.push('(');
        fill(&mut text, op.glsl(), "a", "b");
        text.push(')');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::{Graph, Input};
    use crate::tape::TapeOptions;

    /// The program of a tape, as texels.
    fn texels(tape: &Tape) -> Vec<[u32; 4]> {
        let mut words = vec![7; 8];
        tape.append_program(5, &mut words);
        let (texels, rest) = words.as_chunks::<4>();
        assert!(rest.is_empty());
        assert_eq!(texels[..2], [[7; 4]; 2]);
        texels[2..].to_vec()
    }

    #[test]
    fn a_program_is_a_header_and_the_clauses_after_the_inputs() {
        let mut graph = Graph::new();
        let (x, y, two) = (graph.input(Input::X), graph.input(Input::Y), graph.constant(2.0));
        let sum = graph.add(x, y);
        let double = graph.mul(sum, two);
        let tape = Tape::build(&graph, &[double, sum], &TapeOptions::default()).unwrap();
        let clauses: Vec<u32> = tape.clauses().iter().map(|clause| clause.word()).collect();
        let [first, second] = [tape.outputs()[0], tape.outputs()[1]].map(u32::from);
        let header = [5 | 1 << 24, first | second << 8, 0, 0];
        assert_eq!(texels(&tape), [header, [clauses[2], clauses[3], 0, 0]]);
    }

    #[test]
    fn an_input_in_another_slot_than_its_own_is_read() {
        let mut graph = Graph::new();
        let (x, z) = (graph.input(Input::X), graph.input(Input::Z));
        let sum = graph.add(x, z);
        let tape = Tape::build(&graph, &[sum], &TapeOptions::default()).unwrap();
        let clauses: Vec<u32> = tape.clauses().iter().map(|clause| clause.word()).collect();
        assert_eq!(texels(&tape)[1..], [[clauses[1], clauses[2], 0, 0]]);
        assert!(Variant::of([&tape], true).inputs);
    }

    #[test]
    fn rare_operators_stand_last_in_their_texels_and_only_the_last_texel_ends() {
        let mut graph = Graph::new();
        let mut value = graph.input(Input::X);
        for op in [Op::Sin, Op::Cos, Op::Abs, Op::Exp, Op::Ceil, Op::Abs, Op::Floor, Op::Not, Op::Log] {
            value = graph.raw(crate::graph::Node::Unary(op, value));
        }
        let tape = Tape::build(&graph, &[value], &TapeOptions::default()).unwrap();
        let opcodes: Vec<[u32; 4]> = texels(&tape)[1..].iter().map(|texel| texel.map(|w| w & 255)).collect();
        let expected =
            [[0, 0, 0, 30], [0, 0, 0, 31], [17, 0, 0, 26], [20, 17, 19, 39], [0, 0, 0, 28], [0, 0, 0, 0]];
        assert_eq!(opcodes, expected);
    }

    #[test]
    fn a_variant_has_the_operators_of_its_tapes_and_no_others() {
        let mut graph = Graph::new();
        let (x, y) = (graph.input(Input::X), graph.input(Input::Y));
        let (quotient, sine) = (graph.div(x, y), graph.unary(Op::Sin, x));
        let tapes =
            [quotient, sine].map(|root| Tape::build(&graph, &[root], &TapeOptions::default()).unwrap());
        let variant = Variant::of(&tapes, false);
        assert_eq!(variant.operators, BTreeSet::from([Op::Div, Op::Sin]));
        assert_eq!((variant.slots, variant.table, variant.memory, variant.textures), (4, 4, 0, 0));
        let text = variant.text();
        let cases: Vec<&str> = text.lines().map(str::trim).filter(|line| line.starts_with("case ")).collect();
        let vector =
            "case 67: r = vec4(op_67(a.x, b.x), op_67(a.y, b.y), op_67(a.z, b.z), op_67(a.w, b.w)); break;";
        let expected = [
            "case 30: r = (sin(a)); break;",
            "case 67: r = ((b == 0.0 ? 0.0 : a / b)); break;",
            "case 30: r = (sin(a)); break;",
            vector,
        ];
        assert_eq!(cases, expected);
    }

    #[test]
    fn large_tables_are_fetched_and_on_a_gpu_small_ones_too() {
        let mut graph = Graph::new();
        let x = graph.input(Input::X);
        let tape_of = |count: usize, graph: &mut Graph| {
            let mut sum = x;
            for i in 0..count {
                let number = graph.constant(i as f32 + 0.5);
                sum = graph.mul(sum, number);
            }
            Tape::build(graph, &[sum], &TapeOptions::default()).unwrap()
        };
        for (count, kept, kept_of_a_gpu) in [(16, 16, 16), (17, 32, 0), (256, 256, 0), (257, 0, 0)] {
            let tape = tape_of(count, &mut graph);
            assert_eq!(tape.table().len(), count);
            assert_eq!(Variant::of([&tape], true).table, kept, "{count} entries");
            assert_eq!(Variant::of([&tape], false).table, kept_of_a_gpu, "{count} entries on a GPU");
        }
    }
}
