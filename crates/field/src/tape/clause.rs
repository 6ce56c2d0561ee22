//! Clauses, their opcodes and their decoded form.

use crate::graph::{FIRST_BINARY, Input, Op};

/// Opcodes that are not operators.
pub mod opcode {
    /// Ends the tape.
    pub const END: u8 = 0;
    /// Selects the page of the table that later immediates index. The page number is in the last two bytes.
    pub const PAGE: u8 = 1;
    /// Copies an entry of the table's page into a register.
    pub const LOAD: u8 = 2;
    /// Copies a register into memory.
    pub const STORE: u8 = 3;
    /// Copies memory into a register.
    pub const RELOAD: u8 = 4;
    /// Selects the texture and the channel that the next TEXTURE clause reads.
    pub const SELECT_TEXTURE: u8 = 5;
    /// Reads a texture.
    pub const TEXTURE: u8 = 6;
    /// The first of the six inputs of the point, X.
    pub const FIRST_INPUT: u8 = 8;
    /// The opcode of a two-operand operator is its number plus this if operand b is an immediate.
    pub const REGISTER_IMMEDIATE: u8 = 64;
    /// The opcode of a two-operand operator is its number plus this if operand a is an immediate.
    pub const IMMEDIATE_REGISTER: u8 = 128;
}

/// One clause (Abt 2022, section 4.3).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[repr(C)]
pub struct Clause {
    /// The operation.
    pub opcode: u8,
    /// The register that is written.
    pub output: u8,
    /// First operand.
    pub input_a: u8,
    /// Second operand.
    pub input_b: u8,
}

/// An operand of a two-operand operator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operand {
    /// A register.
    Register(u8),
    /// An immediate: an entry of the table's current page.
    Immediate(u8),
}

/// A decoded clause.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Instruction {
    /// Ends the tape.
    End,
    /// Selects the page of the table that later immediates index.
    Page(u16),
    /// register := table
    Load {
        /// Register written.
        output: u8,
        /// Entry of the page.
        entry: u8,
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
    /// Selects the texture and channel for the TEXTURE clause that follows.
    SelectTexture {
        /// Number of the texture in the scene.
        texture: u16,
        /// 0 red .. 3 alpha.
        channel: u8,
    },
    /// register := texture at (u, v)
    Texture {
        /// Register written.
        output: u8,
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

impl Clause {
    /// Returns the clause as a word, in the layout of [`crate::tape`].
    #[inline]
    pub const fn word(self) -> u32 {
        u32::from_le_bytes([self.opcode, self.output, self.input_a, self.input_b])
    }

    /// Returns the clause that `word` encodes.
    pub const fn from_word(word: u32) -> Self {
        let [opcode, output, input_a, input_b] = word.to_le_bytes();
        Self { opcode, output, input_a, input_b }
    }

    /// Decodes the clause; `None` for an unknown opcode.
    #[inline]
    pub const fn decode(self) -> Option<Instruction> {
        let Self { opcode, output, input_a, input_b } = self;
        let wide = u16::from_le_bytes([input_a, input_b]);
        Some(match opcode {
            opcode::END => Instruction::End,
            opcode::PAGE => Instruction::Page(wide),
            opcode::LOAD => Instruction::Load { output, entry: input_a },
            opcode::STORE => Instruction::Store { register: output, memory: wide },
            opcode::RELOAD => Instruction::Reload { output, memory: wide },
            opcode::SELECT_TEXTURE => Instruction::SelectTexture { texture: wide, channel: output },
            opcode::TEXTURE => Instruction::Texture { output, u: input_a, v: input_b },
            opcode::FIRST_INPUT..=13 => Instruction::Input { output, place: opcode - opcode::FIRST_INPUT },
            _ => {
                let form = opcode & 0xC0;
                let number = if form == 0 { opcode } else { opcode & 0x3F | FIRST_BINARY };
                let Some(op) = Op::from_number(number) else { return None };
                let (a, b) = (input_a, input_b);
                match form {
                    0 => Instruction::Unary { op, output, a },
                    0x40 => {
                        Instruction::Binary { op, output, a: Operand::Register(a), b: Operand::Register(b) }
                    }
                    0x80 => {
                        Instruction::Binary { op, output, a: Operand::Register(a), b: Operand::Immediate(b) }
                    }
                    _ => {
                        Instruction::Binary { op, output, a: Operand::Immediate(a), b: Operand::Register(b) }
                    }
                }
            }
        })
    }
}

impl Instruction {
    /// Encodes the instruction. No form has two immediates, so a second immediate is encoded as a register.
    #[inline]
    pub const fn encode(self) -> Clause {
        const fn wide(opcode: u8, output: u8, wide: u16) -> Clause {
            let [input_a, input_b] = wide.to_le_bytes();
            Clause { opcode, output, input_a, input_b }
        }
        const fn clause(opcode: u8, output: u8, input_a: u8, input_b: u8) -> Clause {
            Clause { opcode, output, input_a, input_b }
        }
        match self {
            Instruction::End => clause(opcode::END, 0, 0, 0),
            Instruction::Page(page) => wide(opcode::PAGE, 0, page),
            Instruction::Load { output, entry } => clause(opcode::LOAD, output, entry, 0),
            Instruction::Store { register, memory } => wide(opcode::STORE, register, memory),
            Instruction::Reload { output, memory } => wide(opcode::RELOAD, output, memory),
            Instruction::SelectTexture { texture, channel } => wide(opcode::SELECT_TEXTURE, channel, texture),
            Instruction::Texture { output, u, v } => clause(opcode::TEXTURE, output, u, v),
            Instruction::Input { output, place } => clause(opcode::FIRST_INPUT + place, output, 0, 0),
            Instruction::Unary { op, output, a } => clause(op.number(), output, a, 0),
            Instruction::Binary { op, output, a: Operand::Register(a), b: Operand::Register(b) } => {
                clause(op.number(), output, a, b)
            }
            Instruction::Binary { op, output, a: Operand::Register(a), b: Operand::Immediate(b) } => {
                clause(op.number() + opcode::REGISTER_IMMEDIATE, output, a, b)
            }
            Instruction::Binary {
                op,
                output,
                a: Operand::Immediate(a),
                b: Operand::Register(b) | Operand::Immediate(b),
            } => clause(op.number() + opcode::IMMEDIATE_REGISTER, output, a, b),
        }
    }
}

pub(super) fn input_of_place(place: u8) -> Input {
    Input::OF_POINT[usize::from(place) % Input::OF_POINT.len()]
}
