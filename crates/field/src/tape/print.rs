//! A tape as text, in the form of Table 1 (Abt 2022, section 4.3).

use std::fmt;

use super::clause::{Instruction, Operand, input_of_place};
use super::{TableEntry, Tape};

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
        let mut page = 0;
        // The thesis calls registers slots.
        let register = |register: u8| format!("slot {register}");
        for instruction in self.instructions() {
            let immediate = |entry: u8| {
                self.table
                    .get(page + usize::from(entry))
                    .map_or_else(|| "?".to_owned(), TableEntry::to_string)
            };
            let operand = |operand: Operand| match operand {
                Operand::Register(number) => register(number),
                Operand::Immediate(entry) => immediate(entry),
            };
            match instruction {
                Instruction::End => row("END", "-", "-", "-")?,
                Instruction::Page(number) => {
                    page = usize::from(number) * 256;
                    row("PAGE", &number.to_string(), "-", "-")?;
                }
                Instruction::Load { output, entry } => {
                    row("LOAD", &immediate(entry), "-", &register(output))?
                }
                Instruction::Store { register: from, memory } => {
                    row("STORE", &register(from), "-", &format!("memory {memory}"))?;
                }
                Instruction::Reload { output, memory } => {
                    row("RELOAD", &format!("memory {memory}"), "-", &register(output))?;
                }
                Instruction::SelectTexture { texture, channel } => {
                    let channel = ["red", "green", "blue", "alpha"][usize::from(channel & 3)];
                    row("SELECT_TEXTURE", &texture.to_string(), channel, "-")?;
                }
                Instruction::Texture { output, u, v } => {
                    row("TEXTURE", &register(u), &register(v), &register(output))?
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
