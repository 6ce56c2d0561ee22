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
    let power = matches!(op, Op::Exp | Op::Exp2 | Op::Log | Op::Log2 | Op::Pow);
    let circular = matches!(op, Op::Sin | Op::Cos | Op::Tan | Op::Asin | Op::Acos | Op::Atan | Op::Atan2);
    let hyperbolic = matches!(op, Op::Sinh | Op::Cosh | Op::Tanh);
    let table = matches!(op, Op::Hash | Op::Band | Op::Spectrum | Op::Waveform | Op::History);
    power || circular || hyperbolic || table
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

    /// The text of `operators.glsl`: the defines and the operators of the variant, and those of the regions' tapes. It
    /// relies on what [`super::glsl`] lists, as far as its operators use it.
    pub fn text(&self, region_operators: &BTreeSet<Op>, region_slots: usize) -> String {
        let mut text = String::with_capacity(8192);
        self.write(region_operators, region_slots, &mut text);
        text
    }

    fn write(&self, region_operators: &BTreeSet<Op>, region_slots: usize, text: &mut String) {
        // Writing to a String cannot fail.
        let silent = self.table == 0 || self.memory > 0 || self.textures > 0;
        let numbers = [
            ("SLOTS", self.slots),
            ("TABLE", self.table),
            ("MEMORY", self.memory),
            ("REGION_SLOTS", region_slots),
        ];
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
        for &op in self.operators.union(region_operators).filter(|op| needs_scalars(**op)) {
            write_scalar_function(text, op);
        }
        for (vector, operators, lanes) in
            [("float", region_operators, false), ("vec4", &self.operators, true)]
        {
            let (rare, common): (Vec<Op>, Vec<Op>) =
                operators.iter().partition(|op| self.every_case && is_rare(**op));
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
