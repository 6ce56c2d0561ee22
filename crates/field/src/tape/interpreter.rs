//! Input of the interpreter in `shaders/interpreter.glsl`: tapes as texels, and the generated text of a variant.
//!
//! **Texels.** `region::encode` writes two clauses into a texel, each followed by its immediate. If an operand is a
//! number, its byte is [`IMMEDIATE`] and the immediate holds the number as float bits. The shader therefore needs no
//! pages and no table. A TEXTURE clause reads a sample that was taken before the tape runs. The inputs of the point are
//! in the first registers from the start. A first clause that is 0 does nothing. The second clause of the last texel is
//! END, with the registers of the first two outputs in bytes 2 and 3. Rare operators ([`is_rare`]) are always second in a
//! texel; the shader computes them between runs of texels. A compound ([`Compound`]) replaces several clauses. A scene's
//! set of compounds is chosen once, for all frames.
//!
//! **Variants.** The text holds only the operators of a [`Variant`]. With `EVERY_CASE`, for renderers that never skip
//! a branch (llvmpipe), all cases are computed and the bits of the operator's number select the result
//! (`tape/select.rs`). Without `EVERY_CASE` a binary search finds the case. **The universal variant**
//! ([`Variant::universal`]) runs nearly every scene, so that on GPUs an edit never waits for a compiler. It has many
//! registers because AMD's compilers put arrays of more than 64 numbers into memory, which hardly slows materials down.
//! With an array of 64 in GPU registers, Mesa's LLVM needs 256 registers, 15 spills and 8 s on Vega.
//!
//! **Points.** The interpreter runs a tape for one point. Only texture coordinates, which take a few clauses, are also
//! computed for the pixels to the right and above. A frame's numbers are immediates of the clauses. A scene's programs
//! are encoded once, and each frame that is interpreted writes its numbers into them, which takes microseconds.

use std::collections::BTreeSet;
use std::fmt::Write as _;

pub(crate) use super::clause::IMMEDIATE;
use super::glsl::{fill, literal};
use super::opcode;
use super::select;
pub(crate) use super::select::rounded_registers;
use crate::graph::{Compound, Compounds, Op, Properties};
use crate::limits::LIMITS;

/// Number of registers without the bit of [`IMMEDIATE`].
pub(super) const REGISTERS_WITHOUT_BIT: usize = IMMEDIATE as usize;

/// Opcodes that are not operators. They give their first operand as the result.
const KEPT: [u8; 2] = [opcode::END, opcode::LOAD];

/// True if an operator costs several times an addition. Such operators are second in a texel.
pub const fn is_rare(op: Op) -> bool {
    op.properties().has(Properties::EXPENSIVE)
}

/// Returns the END clause of a tape whose first two results are in these registers. END assigns `first` to itself.
pub(crate) fn end_of([first, second]: [u8; 2]) -> u32 {
    u32::from_le_bytes([opcode::END, first, first, second])
}

/// The features of an interpreter. They determine its text.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Default)]
pub struct Variant {
    /// Operators that the text contains.
    pub operators: BTreeSet<Op>,
    /// Compounds that the text contains.
    pub compounds: Compounds,
    /// Registers, 8 to 256: a power of two, or a result of [`rounded_registers`] if every case is computed.
    pub registers: usize,
    /// Texture samples that a program can hold.
    pub samples: usize,
    /// Textures of the scene.
    pub textures: usize,
    /// True if all cases are computed and one is selected, for renderers that never skip a branch.
    pub every_case: bool,
}

impl Variant {
    /// Returns the variant that runs nearly every scene: all operators, many registers and textures. It is for GPUs,
    /// because it is slow if every case is computed.
    pub fn universal() -> Self {
        Self {
            operators: Op::ALL.iter().copied().collect(),
            compounds: Compounds::ALL,
            registers: 128,
            // Enough for two images, each projected onto a surface from three sides, and two further samples.
            samples: 8,
            textures: LIMITS.scene_textures_max,
            every_case: false,
        }
    }

    /// True if this variant runs every tape that `other` runs.
    pub fn covers(&self, other: &Self) -> bool {
        self.operators.is_superset(&other.operators)
            && self.compounds.covers(other.compounds)
            && self.registers >= other.registers
            && self.samples >= other.samples
            && self.textures >= other.textures
            && self.every_case == other.every_case
    }

    /// Returns the text of `operators.glsl`: the defines, the operators of the variant and the operators of the
    /// regions' tapes. The operators may use the declarations that [`super::glsl`] lists.
    pub fn text(
        &self,
        region_operators: &BTreeSet<Op>,
        region_compounds: Compounds,
        region_registers: usize,
    ) -> String {
        let mut text = String::with_capacity(8192);
        // The shader masks register numbers, so an array's length must be a power of two.
        let rounded = |count: usize| if self.every_case { count } else { count.next_power_of_two() };
        let (registers, region_registers) = (rounded(self.registers), rounded(region_registers));
        let numbers = [
            ("REGISTERS", registers),
            ("SAMPLES", self.samples),
            ("REGION_REGISTERS", region_registers),
            ("TEXTURE", usize::from(opcode::TEXTURE)),
        ];
        for (name, number) in numbers {
            let _ = writeln!(text, "#define {name} {number}");
        }
        if self.every_case {
            text.push_str("#define EVERY_CASE\n");
        }
        for (name, file, count) in
            [("REGION_", "region_file", region_registers), ("", "tape_file", registers)]
        {
            select::write_registers(&mut text, name, file, count, self.every_case);
        }
        // A texel may hold only one clause.
        let _ = writeln!(text, "const int TEXELS_MAX = {};", LIMITS.graph_nodes_max + 1);
        let region = (region_operators, region_compounds);
        let tape = (&self.operators, self.compounds);
        for (whose, (operators, compounds)) in [("region", region), ("tape", tape)] {
            let (rare, common): (Vec<Op>, Vec<Op>) =
                operators.iter().partition(|op| self.every_case && is_rare(**op));
            let common = common.into_iter().map(Case::of).chain(compounds.iter().map(Case::of_compound));
            self.write_function(&mut text, whose, "common", common);
            if self.every_case {
                self.write_function(&mut text, whose, "rare", rare.iter().copied().map(Case::of));
                let numbers: Vec<String> =
                    rare.iter().map(|op| format!("number == {}", op.number())).collect();
                let test = if numbers.is_empty() { "false".to_owned() } else { numbers.join(" || ") };
                let _ = writeln!(text, "bool {whose}_is_rare(int number) {{\n    return {test};\n}}");
            }
        }
        text
    }

    fn write_function(&self, text: &mut String, whose: &str, which: &str, cases: impl Iterator<Item = Case>) {
        let _ = writeln!(
            text,
            "float {whose}_{which}(uint word, float a, float b, float c) {{\n    float r = a;"
        );
        let cases: Vec<Case> = cases.collect();
        if self.every_case {
            // END and LOAD also give `a`.
            let mut values: Vec<(u8, String)> = KEPT.map(|number| (number, "a".to_owned())).to_vec();
            for Case { number, before, expression } in &cases {
                let _ = writeln!(text, "{before}    float v{number} = {expression};");
                values.push((*number, format!("v{number}")));
            }
            values.sort_unstable_by_key(|(number, _)| *number);
            let values = if which == "rare" { values.split_off(KEPT.len()) } else { values };
            let _ = writeln!(text, "    r = {};", select::operator(&values));
        } else {
            text.push_str("    int number = operator_number(word);\n");
            write_search(text, &cases, true);
        }
        text.push_str("    return r;\n}\n");
    }
}

#[derive(Debug)]
struct Case {
    number: u8,
    /// Declarations of values that the expression reads.
    before: String,
    expression: String,
}

impl Case {
    fn of(op: Op) -> Self {
        Self { number: op.number(), before: String::new(), expression: expression(op) }
    }

    fn of_compound(compound: Compound) -> Self {
        let (before, expression) = compound.glsl(fill, literal);
        Self { number: compound.number(), before, expression }
    }
}

/// Writes a binary search for the operator. A compiler would turn a switch into a chain of comparisons, half of which
/// would run on average. END and LOAD have smaller numbers than all operators, so only the lowest operator needs a test
/// for equality. This saves a comparison and a branch in each clause: 9 % of the code on Xe and on Vega (ACO).
fn write_search(text: &mut String, cases: &[Case], are_lowest: bool) {
    match cases {
        [] => {}
        [Case { number, before, expression }] => {
            let test = if are_lowest { format!("if (number == {number}) ") } else { String::new() };
            let _ = match before.is_empty() {
                true => writeln!(text, "    {test}r = {expression};"),
                false => writeln!(text, "    {test}{{\n{before}    r = {expression};\n    }}"),
            };
        }
        _ => {
            let (low, high) = cases.split_at(cases.len() / 2);
            let border = high.first().map_or(0, |case| case.number);
            let _ = writeln!(text, "    if (number < {border}) {{");
            write_search(text, low, are_lowest);
            text.push_str("    } else {\n");
            write_search(text, high, false);
            text.push_str("    }\n");
        }
    }
}

fn expression(op: Op) -> String {
    let mut text = String::from("(");
    fill(&mut text, op.glsl(), "a", "b");
    text.push(')');
    text
}
