//! The tape: an expression as a list of four-byte clauses (Abt 2022, section 4.3; Keeter 2020, section 3).
//!
//! A clause is an opcode, an output and two inputs, each a byte. Registers hold values. The table holds constants and
//! the inputs that are constant within a frame; clauses take its entries as immediates. [`interpreter`] writes tapes
//! for the GPU.
//!
//! **Words.** A clause is one `u32`, so an RGBA32UI texel holds two clauses and their immediates. The byte of an
//! immediate is 128; a TEXTURE clause's immediate is 4 * texture + channel.
//!
//! | opcode | clause | bits 8..16 | bits 16..24 | bits 24..32 |
//! |---|---|---|---|---|
//! | 0 | END | 0 | 0 | 0 |
//! | 2 | LOAD: register := immediate | register | 128 | 0 |
//! | 3 | STORE: memory := register | register | memory, low byte | memory, high byte |
//! | 4 | RELOAD: register := memory | register | memory, low byte | memory, high byte |
//! | 6 | TEXTURE: register := texture(u, v) | register | register of u | register of v |
//! | 8..=13 | X, Y, Z, NX, NY, NZ: register := input of the point | register | 0 | 0 |
//! | 16..64 | one-operand operator with this number | register | register a | 0 |
//! | 64..96 | two-operand operator with this number: op(register, register) | register | register a | register b |
//! | 128..160 | the operator with the number opcode - 64: op(register, immediate) | register | register a | 128 |
//! | 192..224 | the operator with the number opcode - 128: op(immediate, register) | register | 128 | register b |
//!
//! The opcodes 96..128 are compounds ([`Compound`]), which replace clauses when a tape is written for the
//! interpreter.
//!
//! [`Compound`]: crate::graph::Compound
//!
//! An interpreter finds the form of the operands in the top two bits and fetches the operands. It then switches over
//! 16..64 or `64 + (opcode & 63)`, with one case per operator. A clause reads its operands before it writes its output.
//!
//! **Registers.** The inputs of the point are read first, in the order X, Y, Z, NX, NY, NZ. The other clauses follow
//! the graph's order of evaluation. A register is free after the last use of its value. An output takes the register
//! of operand b if that is free, else the register of operand a, else the lowest free register. If all registers are
//! in use, the value with the farthest next use is spilled (Belady 1966); inputs of the point are read again instead.

use std::collections::BTreeSet;
use std::fmt;

use crate::graph::{FrameInputs, Graph, GraphError, Input, NodeId, Op};
use crate::limits::{LIMITS, Limits};
use clause::input_of_place;

mod allocate;
mod clause;
mod compounds;
mod evaluate;
pub mod glsl;
mod gradients;
pub mod interpreter;
mod rounds;
mod select;

pub use clause::{Instruction, Operand, opcode};
pub use evaluate::{Batch, PointEvaluator, Points};
pub use gradients::{Dual, GradientBatch};

/// A reason for which a tape cannot be built.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum TapeError {
    /// The graph is invalid.
    #[error(transparent)]
    Graph(#[from] GraphError),
    /// The expression needs more clauses than the limit.
    #[error("the tape needs more than {0} clauses; make the scene smaller")]
    TooManyClauses(usize),
    /// There are more outputs than registers. Each output keeps its register until the end of the tape.
    #[error(
        "a tape with {count} outputs was requested, but at most {max} can be kept at once; request fewer"
    )]
    TooManyOutputs {
        /// The requested number of outputs.
        count: usize,
        /// Maximum number of outputs.
        max: usize,
    },
    /// The number of registers is outside 2..=256.
    #[error("a tape cannot work with {0} registers; give it 2 to 256")]
    RegisterCount(usize),
    /// There are more spilled values than the limit.
    #[error(
        "the tape must spill more than {0} values to memory; give it more registers or make the scene smaller"
    )]
    TooMuchMemory(usize),
}

/// Options for building a tape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TapeOptions {
    /// Number of registers, 2 to 256.
    pub registers: usize,
    /// The limits.
    pub limits: Limits,
}

impl Default for TapeOptions {
    fn default() -> Self {
        Self { registers: 256, limits: LIMITS }
    }
}

/// An entry of the table, which immediates index.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TableEntry {
    /// A constant.
    Constant(f32),
    /// An input that is constant within a frame.
    Input(Input),
}

impl TableEntry {
    /// Returns the number of a constant.
    pub fn constant(self) -> Option<f32> {
        match self {
            TableEntry::Constant(value) => Some(value),
            TableEntry::Input(_) => None,
        }
    }
}

/// One or several expressions as clauses. The expressions may share parts.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tape {
    clauses: Vec<Instruction>,
    table: Vec<TableEntry>,
    outputs: Vec<u8>,
    registers: usize,
    memory: usize,
}

impl Tape {
    /// Builds the tape that computes the roots, in their order.
    ///
    /// # Errors
    /// Returns a [`TapeError`] for an invalid graph or an exceeded limit.
    pub fn build(graph: &Graph, roots: &[NodeId], options: &TapeOptions) -> Result<Self, TapeError> {
        allocate::build(graph, roots, options)
    }

    /// Returns the clauses, without END.
    pub fn clauses(&self) -> &[Instruction] {
        &self.clauses
    }

    /// Returns the table that immediates index.
    pub fn table(&self) -> &[TableEntry] {
        &self.table
    }

    /// Returns the table's numbers in a frame.
    pub fn table_values(&self, frame: &FrameInputs) -> Vec<f32> {
        let number = |entry: &TableEntry| match *entry {
            TableEntry::Constant(value) => value,
            TableEntry::Input(input) => frame.value(input),
        };
        self.table.iter().map(number).collect()
    }

    /// Returns the registers that hold the values of the roots at the end.
    pub fn outputs(&self) -> &[u8] {
        &self.outputs
    }

    /// Number of registers used.
    pub fn registers(&self) -> usize {
        self.registers
    }

    /// Number of memory slots used; 0 if nothing was spilled.
    pub fn memory(&self) -> usize {
        self.memory
    }

    /// Returns the operators that occur.
    pub fn operators(&self) -> BTreeSet<Op> {
        let mut occurs = [false; 256];
        for clause in &self.clauses {
            if let Instruction::Unary { op, .. } | Instruction::Binary { op, .. } = *clause {
                occurs[usize::from(op.number())] = true;
            }
        }
        Op::ALL.iter().copied().filter(|op| occurs[usize::from(op.number())]).collect()
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
        // The thesis calls registers slots.
        let register = |register: u8| format!("slot {register}");
        let immediate =
            |entry: u32| self.table.get(entry as usize).map_or_else(|| "?".to_owned(), TableEntry::to_string);
        let operand = |operand: Operand| match operand {
            Operand::Register(number) => register(number),
            Operand::Immediate(entry) => immediate(entry),
        };
        for clause in &self.clauses {
            match *clause {
                Instruction::Load { output, entry } => {
                    row("LOAD", &immediate(entry), "-", &register(output))?
                }
                Instruction::Store { register: from, memory } => {
                    row("STORE", &register(from), "-", &format!("memory {memory}"))?;
                }
                Instruction::Reload { output, memory } => {
                    row("RELOAD", &format!("memory {memory}"), "-", &register(output))?;
                }
                Instruction::Texture { output, texture, channel, u, v } => {
                    let channel = ["red", "green", "blue", "alpha"][usize::from(channel & 3)];
                    let name = format!("{channel} of {texture}");
                    row(&name, &register(u), &register(v), &register(output))?;
                }
                Instruction::Input { output, place } => {
                    row(&input_of_place(place).to_string(), "-", "-", &register(output))?;
                }
                Instruction::Unary { op, output, a } => row(op.name(), &register(a), "-", &register(output))?,
                Instruction::Binary { op, output, a, b } => {
                    row(op.name(), &operand(a), &operand(b), &register(output))?;
                }
            }
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
