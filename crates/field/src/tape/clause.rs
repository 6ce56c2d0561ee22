//! Clauses, and the opcodes of the interpreter's words.

use crate::graph::Op;

/// Opcodes that are not operators.
pub mod opcode {
    /// Ends the tape.
    pub const END: u8 = 0;
    /// Copies the immediate into a register.
    pub const LOAD: u8 = 2;
    /// Copies a texture sample into a register.
    pub const TEXTURE: u8 = 6;
    /// The opcode of a two-operand operator is its number plus this if operand b is an immediate.
    pub const REGISTER_IMMEDIATE: u8 = 64;
    /// The opcode of a two-operand operator is its number plus this if operand a is an immediate.
    pub const IMMEDIATE_REGISTER: u8 = 128;
}

/// The operand byte of an immediate. Registers with smaller numbers do not have this bit, so in variants without others
/// the byte alone distinguishes immediates from registers.
pub(crate) const IMMEDIATE: u8 = 0x80;

/// An operand of a clause, or an output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operand {
    /// A register.
    Register(u32),
    /// An immediate: an entry of the table.
    Immediate(u32),
}

/// The computation of a clause.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Instruction {
    /// Reads an input of the point, by its position in [`Input::OF_POINT`](crate::graph::Input::OF_POINT).
    Input(u8),
    /// Reads a texture at (a, b).
    Texture {
        /// Number of the texture in the scene.
        texture: u16,
        /// 0 red .. 3 alpha.
        channel: u8,
    },
    /// Applies an operator. If it takes one operand, both operands are the same.
    Operator(Op),
}

/// One clause (Abt 2022, section 4.3). It reads its operands before it writes its output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Clause {
    /// The computation.
    pub instruction: Instruction,
    /// Register written.
    pub output: u32,
    /// The operands; inputs of the point have their own register here.
    pub operands: [Operand; 2],
}
