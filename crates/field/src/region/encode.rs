//! Encodes programs as texels: allocates registers, and writes clauses with their immediates, then END.
//!
//! | word | holds |
//! |---|---|
//! | 0, 2 | a clause, as in [`crate::tape`] |
//! | 1, 3 | its immediate: the operand that is not a register, or a compound's third operand |
//!
//! The last texel has END as its second clause, with the registers of the two outputs in its last bytes. Rare operators
//! ([`is_rare`]) are always the second clause of a texel. If no other clause can come first, the first clause of the
//! texel is one that does nothing.
//!
//! Compounds ([`Compound`]) are formed after pruning, so that pruning still sees every minimum and maximum.

use super::program::{Arg, Form, Program, Step, refill};
use crate::graph::{Compound, Compounds, Uses};
use crate::tape::interpreter::{IMMEDIATE, end_of, is_rare};
use crate::tape::opcode;

/// Maximum number of registers.
pub const REGISTERS_MAX: usize = 256;

/// Four words: two clauses with their immediates.
pub type Texel = [u32; 4];

/// A clause before its registers are known.
#[derive(Debug, Clone, Copy)]
struct Clause {
    at: u32,
    opcode: u8,
    rare: bool,
    /// The values that the clause reads. An unused operand repeats the used operand.
    a: u32,
    b: u32,
    /// True for each operand byte that holds a register.
    reads: [bool; 2],
    number: f32,
}

/// Encodes programs, one after the other.
#[derive(Debug, Default)]
pub struct Encoder {
    compounds: Compounds,
    registers_max: usize,
    /// The clauses of the program, last first.
    list: Vec<Clause>,
    /// Number of reads of each value, at most 2.
    uses: Vec<u8>,
    /// For each value, the last step that reads it: `u32::MAX` for outputs, 0 for unread values.
    last_use: Vec<u32>,
    register: Vec<u8>,
    free: FreeRegisters,
    /// For each texture sample, true if it is already in a register.
    sampled: Vec<bool>,
    pub(super) texels: Vec<Texel>,
    /// True if the last texel has only one clause so far.
    half: bool,
    /// The largest number of registers that a program has needed so far.
    pub registers: usize,
    /// Number of clauses of the last program.
    pub(super) clauses: usize,
    /// The registers of the last program's outputs.
    pub outputs: Vec<u8>,
}

impl Clause {
    fn of(at: u32, step: &Step) -> Self {
        let (form, reads) = match step.form {
            // A one-operand operator repeats its operand as the unread second operand.
            Form::Values => (0, [true; 2]),
            Form::NumberRight => (opcode::REGISTER_IMMEDIATE, [true, false]),
            Form::NumberLeft => (opcode::IMMEDIATE_REGISTER, [false, true]),
        };
        let opcode = step.op.number() + form;
        Self { at, opcode, rare: is_rare(step.op), a: step.a, b: step.b, reads, number: step.number }
    }
}

impl Encoder {
    /// Creates an encoder with a limit on registers. Compounds read operands later than separate operators do, so they
    /// may need more registers. A program that exceeds the limit is encoded again without compounds.
    pub fn new(compounds: Compounds, registers_max: usize) -> Self {
        Self { compounds, registers_max, ..Self::default() }
    }

    /// `None` if the program needs too many registers.
    pub(super) fn encode(&mut self, program: &Program, outputs: &[usize]) -> Option<&[Texel]> {
        let root = |root: &usize| program.roots.get(*root).copied().unwrap_or(Arg::Number(0.0));
        let roots: Vec<Arg> = outputs.iter().map(root).collect();
        let mut highest = self.encode_with(self.compounds, program, &roots);
        if self.compounds != Compounds::NONE && highest.is_none_or(|highest| highest > self.registers_max) {
            highest = self.encode_with(Compounds::NONE, program, &roots);
        }
        self.registers = self.registers.max(highest.filter(|highest| *highest <= self.registers_max)?);
        Some(&self.texels)
    }

    pub(super) fn count(&self, uses: &mut Uses) {
        for clause in &self.list {
            uses.add(Compound::from_number(clause.opcode));
        }
    }

    fn encode_with(&mut self, compounds: Compounds, program: &Program, roots: &[Arg]) -> Option<usize> {
        self.list_clauses(compounds, program, roots);
        self.texels.clear();
        self.clauses = 0;
        self.register.clear();
        self.register.extend(0..program.in_registers as u8);
        self.register.resize(program.values(), 0);
        self.half = false;
        self.free = FreeRegisters { highest: program.in_registers, ..FreeRegisters::default() };
        for input in 0..program.in_registers {
            self.free.bits[0] &= !(u64::from(self.last_use[input] != 0) << input);
        }
        refill(&mut self.sampled, program.inputs - program.in_registers, false);
        for place in (0..self.list.len()).rev() {
            let clause = self.list[place];
            for value in [clause.a, clause.b] {
                if (value as usize) < program.inputs {
                    self.sample(value, program)?;
                }
            }
            let [a, b] = [clause.a, clause.b].map(|value| self.register[value as usize]);
            for (value, register) in [(clause.a, a), (clause.b, b)] {
                self.free.give_if(self.last_use[value as usize] == clause.at, register);
            }
            let output = self.free.allocate()?;
            self.register[clause.at as usize] = output;
            let a = if clause.reads[0] { a } else { IMMEDIATE };
            let b = if clause.reads[1] { b } else { IMMEDIATE };
            let word = u32::from_le_bytes([clause.opcode, output, a, b]);
            self.write(word, clause.number, clause.rare);
        }
        self.outputs.clear();
        let mut numbers: Vec<(u32, u8)> = Vec::new();
        for root in roots {
            let output = match *root {
                Arg::Value(value) => {
                    self.sample(value, program)?;
                    self.register[value as usize]
                }
                Arg::Number(number) => match numbers.iter().find(|(bits, _)| *bits == number.to_bits()) {
                    Some((_, output)) => *output,
                    None => {
                        let output = self.free.allocate()?;
                        let load = u32::from_le_bytes([opcode::LOAD, output, IMMEDIATE, 0]);
                        self.write(load, number, false);
                        numbers.push((number.to_bits(), output));
                        output
                    }
                },
            };
            self.outputs.push(output);
        }
        let output = |place: usize| self.outputs.get(place).copied().unwrap_or(0);
        self.end([output(0), output(1)]);
        Some(self.free.highest)
    }

    /// Loads a texture sample on its first read. (Other values are already in registers.) `None` if registers run out.
    fn sample(&mut self, value: u32, program: &Program) -> Option<()> {
        let Some(sample) = (value as usize).checked_sub(program.in_registers) else { return Some(()) };
        let Some(sampled) = self.sampled.get_mut(sample).filter(|sampled| !**sampled) else {
            return Some(());
        };
        *sampled = true;
        let output = self.free.allocate()?;
        self.register[value as usize] = output;
        let word = u32::from_le_bytes([opcode::TEXTURE, output, 0, 0]);
        self.write(word, f32::from_bits(sample as u32), true);
        Some(())
    }

    /// True if the last program reads a texture.
    pub(super) fn samples(&self) -> bool {
        self.sampled.contains(&true)
    }

    /// Lists the clauses that the roots need, last first, and finds the last use of each value.
    fn list_clauses(&mut self, compounds: Compounds, program: &Program, roots: &[Arg]) {
        if compounds != Compounds::NONE {
            self.count_uses(program, roots);
        }
        self.list.clear();
        refill(&mut self.last_use, program.values(), 0);
        for root in roots {
            if let Arg::Value(value) = root {
                self.last_use[*value as usize] = u32::MAX;
            }
        }
        for (index, step) in program.steps.iter().enumerate().rev() {
            let at = (program.inputs + index) as u32;
            if self.last_use[at as usize] == 0 {
                continue;
            }
            let own = |value: u32| program.step(value).filter(|_| self.uses[value as usize] == 1);
            let found = compounds.find(|value| own(value).map(|step| step.operation()), step.operation());
            let clause = match found {
                Some(found) => Clause {
                    at,
                    opcode: found.compound.number(),
                    rare: false,
                    a: found.registers[0],
                    b: found.registers[1],
                    reads: [true; 2],
                    number: found.number,
                },
                None => Clause::of(at, step),
            };
            for value in [clause.a, clause.b] {
                let last = &mut self.last_use[value as usize];
                if *last == 0 {
                    *last = at;
                }
            }
            self.list.push(clause);
        }
    }

    fn count_uses(&mut self, program: &Program, roots: &[Arg]) {
        refill(&mut self.uses, program.values(), 0);
        for root in roots {
            if let Arg::Value(value) = root {
                self.uses[*value as usize] = 2;
            }
        }
        for (index, step) in program.steps.iter().enumerate().rev() {
            if self.uses[program.inputs + index] == 0 {
                continue;
            }
            self.uses[step.a as usize] = (self.uses[step.a as usize] + 1).min(2);
            if step.form == Form::Values && step.op.arity() == 2 {
                self.uses[step.b as usize] = (self.uses[step.b as usize] + 1).min(2);
            }
        }
    }

    /// Appends a clause, which some operators need to be `second` in its texel.
    #[inline(always)]
    fn write(&mut self, word: u32, immediate: f32, second: bool) {
        self.clauses += 1;
        let immediate = immediate.to_bits();
        match self.texels.last_mut() {
            Some(last) if self.half => (last[2], last[3]) = (word, immediate),
            _ if second => return self.texels.push([0, 0, word, immediate]),
            _ => self.texels.push([word, immediate, 0, 0]),
        }
        self.half = !self.half;
    }

    fn end(&mut self, outputs: [u8; 2]) {
        let end = end_of(outputs);
        match self.texels.last_mut() {
            Some(last) if self.half => last[2] = end,
            _ => self.texels.push([0, 0, end, 0]),
        }
    }
}

#[derive(Debug)]
struct FreeRegisters {
    /// One bit per register: 1 if the register is free. Hardly any program needs more than the first 64 registers.
    bits: [u64; REGISTERS_MAX / 64],
    /// The largest number of a register that was taken so far, plus 1.
    highest: usize,
}

impl Default for FreeRegisters {
    fn default() -> Self {
        Self { bits: [u64::MAX; REGISTERS_MAX / 64], highest: 0 }
    }
}

impl FreeRegisters {
    #[inline(always)]
    fn allocate(&mut self) -> Option<u8> {
        let (part, bits) = self.bits.iter_mut().enumerate().find(|(_, bits)| **bits != 0)?;
        let register = 64 * part + bits.trailing_zeros() as usize;
        *bits &= *bits - 1;
        self.highest = self.highest.max(register + 1);
        Some(register as u8)
    }

    #[inline(always)]
    fn give_if(&mut self, condition: bool, register: u8) {
        self.bits[usize::from(register >> 6)] |= u64::from(condition) << (register & 63);
    }
}
