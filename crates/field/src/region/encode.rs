//! A program as texels of the texture buffer: registers, clauses with their immediates, END.
//!
//! | word | holds |
//! |---|---|
//! | 0, 2 | a clause, as in [`crate::tape`] |
//! | 1, 3 | its immediate, in place of the operand that is not a register |
//!
//! The last texel has END as its second clause, with the registers of the two outputs in its last bytes. Rare
//! operators ([`is_rare`]) come second in a texel; if no other clause precedes one, the first clause does nothing.

use super::program::{Arg, Form, INPUTS, Program, refill};
use crate::tape::interpreter::is_rare;
use crate::tape::{Instruction, opcode};

/// Most registers of a region's tape.
pub(super) const REGISTERS_MAX: usize = 256;

/// Four words.
pub(super) type Texel = [u32; 4];

/// Writes programs.
#[derive(Debug, Default)]
pub(super) struct Encoder {
    /// By value: the last step that reads it; `u32::MAX` for values that are read at the end, 0 for values never
    /// read.
    last_use: Vec<u32>,
    /// By value: its register.
    register: Vec<u8>,
    texels: Vec<Texel>,
    /// Most registers that a program has needed so far.
    pub(super) registers: usize,
    /// Clauses of the last program.
    pub(super) clauses: usize,
}

/// The program needs more registers than there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct TooManyRegisters;

impl Encoder {
    /// The texels of the program that gives two of its roots.
    pub(super) fn encode(
        &mut self,
        program: &Program,
        outputs: [usize; 2],
    ) -> Result<&[Texel], TooManyRegisters> {
        let roots = outputs.map(|root| program.roots.get(root).copied().unwrap_or(Arg::Number(0.0)));
        self.find_last_uses(program, roots);
        self.texels.clear();
        self.clauses = 0;
        self.register.clear();
        self.register.extend(0..INPUTS as u8);
        self.register.resize(program.values(), 0);
        let mut free = FreeRegisters::default();
        for input in 0..INPUTS {
            free.first &= !(u64::from(self.last_use[input] != 0) << input);
        }
        let mut highest = INPUTS;
        let mut half = false;
        for (index, step) in program.steps.iter().enumerate() {
            let at = INPUTS + index;
            if self.last_use[at] == 0 {
                continue;
            }
            let (a, b) = (self.register[step.a as usize], self.register[step.b as usize]);
            for (value, register) in [(step.a, a), (step.b, b)] {
                free.give_if(self.last_use[value as usize] == at as u32, register);
            }
            let output = free.take()?;
            highest = highest.max(usize::from(output) + 1);
            self.register[at] = output;
            let (form, a, b) = match step.form {
                Form::Values => (0, a, b),
                Form::NumberRight => (opcode::REGISTER_IMMEDIATE, a, 0),
                Form::NumberLeft => (opcode::IMMEDIATE_REGISTER, 0, b),
            };
            // A one-operand operator repeats its operand as the second one, which is not read.
            let clause = u32::from_le_bytes([step.op.number() + form, output, a, b]);
            self.write(clause, step.number, is_rare(step.op), &mut half);
        }
        let mut registers = [0; 2];
        for (register, root) in registers.iter_mut().zip(roots) {
            *register = match root {
                Arg::Value(value) => self.register[value as usize],
                Arg::Number(number) => {
                    let output = free.take()?;
                    highest = highest.max(usize::from(output) + 1);
                    self.write(
                        Instruction::Load { output, entry: 0 }.encode().word(),
                        number,
                        false,
                        &mut half,
                    );
                    output
                }
            };
        }
        self.end(registers, half);
        self.registers = self.registers.max(highest);
        Ok(&self.texels)
    }

    /// The texels that were encoded last.
    pub(super) fn texels(&self) -> &[Texel] {
        &self.texels
    }

    fn find_last_uses(&mut self, program: &Program, roots: [Arg; 2]) {
        refill(&mut self.last_use, program.values(), 0);
        for root in roots {
            if let Arg::Value(value) = root {
                self.last_use[value as usize] = u32::MAX;
            }
        }
        for (index, step) in program.steps.iter().enumerate().rev() {
            let at = INPUTS + index;
            if self.last_use[at] == 0 {
                continue;
            }
            for value in [step.a, step.b] {
                let last = &mut self.last_use[value as usize];
                if *last == 0 {
                    *last = at as u32;
                }
            }
        }
    }

    /// `half`: whether the last texel has room for a second clause.
    #[inline(always)]
    fn write(&mut self, word: u32, immediate: f32, second: bool, half: &mut bool) {
        self.clauses += 1;
        let immediate = immediate.to_bits();
        match self.texels.last_mut() {
            Some(last) if *half => (last[2], last[3]) = (word, immediate),
            _ if second => return self.texels.push([0, 0, word, immediate]),
            _ => self.texels.push([word, immediate, 0, 0]),
        }
        *half = !*half;
    }

    fn end(&mut self, [first, second]: [u8; 2], half: bool) {
        let end = u32::from_le_bytes([opcode::END, 0, first, second]);
        match self.texels.last_mut() {
            Some(last) if half => last[2] = end,
            _ => self.texels.push([0, 0, end, 0]),
        }
    }
}

/// Free registers, as bits. Hardly any program needs more than the first 64.
#[derive(Debug)]
struct FreeRegisters {
    first: u64,
    others: [u64; REGISTERS_MAX / 64 - 1],
}

impl Default for FreeRegisters {
    fn default() -> Self {
        Self { first: u64::MAX, others: [u64::MAX; REGISTERS_MAX / 64 - 1] }
    }
}

impl FreeRegisters {
    /// The lowest free register.
    #[inline(always)]
    fn take(&mut self) -> Result<u8, TooManyRegisters> {
        if self.first != 0 {
            let register = self.first.trailing_zeros();
            self.first &= self.first - 1;
            return Ok(register as u8);
        }
        for (part, bits) in self.others.iter_mut().enumerate() {
            if *bits != 0 {
                let register = 64 * (part as u32 + 1) + bits.trailing_zeros();
                *bits &= *bits - 1;
                return Ok(register as u8);
            }
        }
        Err(TooManyRegisters)
    }

    #[inline(always)]
    fn give_if(&mut self, condition: bool, register: u8) {
        let bit = u64::from(condition) << (register & 63);
        match usize::from(register >> 6).checked_sub(1) {
            None => self.first |= bit,
            Some(part) => self.others[part] |= bit,
        }
    }
}
