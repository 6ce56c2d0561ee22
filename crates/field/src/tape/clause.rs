//! Clauses, their opcodes and their words.

use crate::graph::{FIRST_BINARY, Input, Op};

/// Opcodes that are not operators.
pub mod opcode {
    /// Ends the tape.
    pub const END: u8 = 0;
    /// Copies an entry of the table into a register.
    pub const LOAD: u8 = 2;
    /// Copies a register into memory.
    pub const STORE: u8 = 3;
    /// Copies memory into a register.
    pub const RELOAD: u8 = 4;
    /// Reads a texture.
    pub const TEXTURE: u8 = 6;
    /// The first of the six inputs of the point, X.
    pub const FIRST_INPUT: u8 = 8;
    /// The opcode of a two-operand operator is its number plus this if operand b is an immediate.
    pub const REGISTER_IMMEDIATE: u8 = 64;
    /// The opcode of a two-operand operator is its number plus this if operand a is an immediate.
    pub const IMMEDIATE_REGISTER: u8 = 128;
}

/// The operand byte of an immediate. Registers with smaller numbers do not have this bit, so in variants without others
/// the byte alone distinguishes immediates from registers.
pub(crate) const IMMEDIATE: u8 = 0x80;

/// An operand of a two-operand operator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operand {
    /// A register.
    Register(u8),
    /// An immediate: an entry of the table.
    Immediate(u32),
}

/// One clause (Abt 2022, section 4.3).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Instruction {
    /// register := table
    Load {
        /// Register written.
        output: u8,
        /// Entry of the table.
        entry: u32,
    },
    /// memory := register
    Store {
        /// Register read.
        register: u8,
        /// Memory written.
        memory: u16,
    },
    /// register := memory
    Reload {
        /// Register written.
        output: u8,
        /// Memory read.
        memory: u16,
    },
    /// register := texture at (u, v)
    Texture {
        /// Register written.
        output: u8,
        /// Number of the texture in the scene.
        texture: u16,
        /// 0 red .. 3 alpha.
        channel: u8,
        /// Register of u.
        u: u8,
        /// Register of v.
        v: u8,
    },
    /// register := input of the point, by its position in [`Input::OF_POINT`]
    Input {
        /// Register written.
        output: u8,
        /// Position of the input, 0..6.
        place: u8,
    },
    /// register := op(register)
    Unary {
        /// The operator.
        op: Op,
        /// Register written.
        output: u8,
        /// Register read.
        a: u8,
    },
    /// register := op(a, b); at most one operand is an immediate
    Binary {
        /// The operator.
        op: Op,
        /// Register written.
        output: u8,
        /// First operand.
        a: Operand,
        /// Second operand.
        b: Operand,
    },
}

impl Operand {
    const fn byte(self) -> u8 {
        match self {
            Operand::Register(register) => register,
            Operand::Immediate(_) => IMMEDIATE,
        }
    }
}

impl Instruction {
    /// Returns the clause's word, in the layout of [`crate::tape`]. Immediates follow words, so the word has neither
    /// entries of the table nor textures.
    #[inline]
    pub const fn word(self) -> u32 {
        let (opcode, output, [a, b]) = match self {
            Instruction::Load { output, .. } => (opcode::LOAD, output, [IMMEDIATE, 0]),
            Instruction::Store { register, memory } => (opcode::STORE, register, memory.to_le_bytes()),
            Instruction::Reload { output, memory } => (opcode::RELOAD, output, memory.to_le_bytes()),
            Instruction::Texture { output, u, v, .. } => (opcode::TEXTURE, output, [u, v]),
            Instruction::Input { output, place } => (opcode::FIRST_INPUT + place, output, [0; 2]),
            Instruction::Unary { op, output, a } => (op.number(), output, [a, 0]),
            Instruction::Binary { op, output, a, b } => {
                let form = match (a, b) {
                    (Operand::Register(_), Operand::Register(_)) => 0,
                    (_, Operand::Immediate(_)) => opcode::REGISTER_IMMEDIATE,
                    (Operand::Immediate(_), _) => opcode::IMMEDIATE_REGISTER,
                };
                (op.number() + form, output, [a.byte(), b.byte()])
            }
        };
        u32::from_le_bytes([opcode, output, a, b])
    }

    /// Returns the clause of a word; `None` for END and for an unknown opcode. Entries and textures are 0.
    #[inline]
    pub const fn from_word(word: u32) -> Option<Self> {
        let [opcode, output, a, b] = word.to_le_bytes();
        let memory = u16::from_le_bytes([a, b]);
        Some(match opcode {
            opcode::LOAD => Instruction::Load { output, entry: 0 },
            opcode::STORE => Instruction::Store { register: output, memory },
            opcode::RELOAD => Instruction::Reload { output, memory },
            opcode::TEXTURE => Instruction::Texture { output, texture: 0, channel: 0, u: a, v: b },
            opcode::FIRST_INPUT..=13 => Instruction::Input { output, place: opcode - opcode::FIRST_INPUT },
            _ => {
                let form = opcode & 0xC0;
                let number = if form == 0 { opcode } else { opcode & 0x3F | FIRST_BINARY };
                let Some(op) = Op::from_number(number) else { return None };
                let (left, right) = (Operand::Register(a), Operand::Register(b));
                match form {
                    0 => Instruction::Unary { op, output, a },
                    0x40 => Instruction::Binary { op, output, a: left, b: right },
                    0x80 => Instruction::Binary { op, output, a: left, b: Operand::Immediate(0) },
                    _ => Instruction::Binary { op, output, a: Operand::Immediate(0), b: right },
                }
            }
        })
    }
}

pub(super) fn input_of_place(place: u8) -> Input {
    Input::OF_POINT[usize::from(place) % Input::OF_POINT.len()]
}
