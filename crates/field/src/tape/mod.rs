//! The tape: an expression as a list of clauses (Abt 2022, section 4.3; Keeter 2020, section 3), for evaluation on the
//! CPU. `region::encode` writes the interpreter's tapes.
//!
//! A clause is an instruction, an output and two operands. Registers hold values. The table holds constants and the
//! inputs that are constant within a frame; clauses take its entries as immediates.
//!
//! **Registers.** The inputs of the point are read first, in the order X, Y, Z, NX, NY, NZ. The other clauses follow
//! the graph's order of evaluation. A register is free after the last use of its value. An output takes the register
//! that was freed last.
//!
//! **The interpreter's words.** There a clause is one `u32`, so an RGBA32UI texel holds two clauses and their
//! immediates. The byte of an immediate is 128; a TEXTURE clause's immediate is 4 * texture + channel.
//!
//! | opcode | clause | bits 8..16 | bits 16..24 | bits 24..32 |
//! |---|---|---|---|---|
//! | 0 | END | 0 | 0 | 0 |
//! | 2 | LOAD: register := immediate | register | 128 | 0 |
//! | 6 | TEXTURE: register := sample | register | 0 | 0 |
//! | 16..64 | one-operand operator with this number | register | register a | register a |
//! | 64..96 | two-operand operator with this number: op(register, register) | register | register a | register b |
//! | 96..128 | compound with this number ([`Compound`](crate::graph::Compound)) | register | register a | register b |
//! | 128..160 | the operator with the number opcode - 64: op(register, immediate) | register | register a | 128 |
//! | 192..224 | the operator with the number opcode - 128: op(immediate, register) | register | 128 | register b |
//!
//! An interpreter finds the form of the operands in the top two bits and fetches the operands. It then switches over
//! 16..64 or `64 + (opcode & 63)`, with one case per operator. A clause reads its operands before it writes its output.

use std::fmt;

use crate::graph::{FrameInputs, Graph, Input, NodeId};

mod allocate;
mod clause;
mod evaluate;
pub mod glsl;
mod gradients;
pub mod interpreter;
mod rounds;
mod select;

pub use clause::{Clause, Instruction, Operand, opcode};
pub use evaluate::{Batch, PointEvaluator, Points};
pub use gradients::{Dual, GradientBatch};

/// An entry of the table, which immediates index.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TableEntry {
    /// A constant.
    Constant(f32),
    /// An input that is constant within a frame.
    Input(Input),
}

/// One or several expressions as clauses. The expressions may share parts.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tape {
    /// The clauses.
    pub clauses: Vec<Clause>,
    /// The table that immediates index.
    pub table: Vec<TableEntry>,
    /// The registers or entries of the table that hold the values of the roots at the end.
    pub outputs: Vec<Operand>,
    /// Number of registers used.
    pub registers: usize,
}

impl Tape {
    /// Builds the tape that computes the roots, in their order.
    pub fn new(graph: &Graph, roots: &[NodeId]) -> Self {
        allocate::build(graph, roots)
    }

    /// Returns the table's numbers in a frame.
    pub fn table_values(&self, frame: &FrameInputs) -> Vec<f32> {
        let number = |entry: &TableEntry| match *entry {
            TableEntry::Constant(value) => value,
            TableEntry::Input(input) => frame.value(input),
        };
        self.table.iter().map(number).collect()
    }
}

// A tape as text, in the form of Table 1 (Abt 2022, section 4.3).

impl fmt::Display for TableEntry {
    /// Writes a constant as `1.0f` and an input as its name.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            TableEntry::Constant(value) => write!(f, "{value:?}f"),
            TableEntry::Input(input) => write!(f, "{input}"),
        }
    }
}

impl fmt::Display for Tape {
    /// Writes a header, then a line per clause: opcode, input_A, input_B, output.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut row = |opcode: &str, a: &str, b: &str, output: &str| {
            writeln!(f, "{opcode:<14} {a:<14} {b:<14} {output}")
        };
        row("opcode", "input_A", "input_B", "output")?;
        let operand = |operand: Operand| match operand {
            // The thesis calls registers slots.
            Operand::Register(number) => format!("slot {number}"),
            Operand::Immediate(entry) => {
                self.table.get(entry as usize).map_or_else(String::new, TableEntry::to_string)
            }
        };
        for Clause { instruction, output, operands } in &self.clauses {
            let (name, count) = match *instruction {
                Instruction::Input(place) => (Input::OF_POINT[usize::from(place) % 6].to_string(), 0),
                Instruction::Texture { texture, channel } => {
                    let channel = ["red", "green", "blue", "alpha"][usize::from(channel & 3)];
                    (format!("{channel} of {texture}"), 2)
                }
                Instruction::Operator(op) => (op.name().to_owned(), op.arity()),
            };
            let mut shown = operands.iter().take(count).map(|one| operand(*one));
            let [a, b] = [(); 2].map(|()| shown.next().unwrap_or_else(|| "-".to_owned()));
            row(&name, &a, &b, &format!("slot {output}"))?;
        }
        for output in self.outputs.iter().filter(|output| matches!(output, Operand::Immediate(_))) {
            row("LOAD", &operand(*output), "-", "output")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod rounds_tests;

#[cfg(test)]
mod non_lipschitz_tests;

#[cfg(test)]
mod slope_tests;

#[cfg(test)]
pub(crate) mod testing;

#[cfg(test)]
mod tests;
