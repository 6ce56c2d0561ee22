//! A program as texels of the texture buffer: slots, clauses with their immediates, END.
//!
//! | word | holds |
//! |---|---|
//! | 0, 2 | a clause, as in [`crate::tape`] |
//! | 1, 3 | its immediate, which stands for the operand that is none of the slots |
//!
//! The last texel has END as its second clause, with the slots of the two outputs in its last bytes. Rare operators
//! ([`is_rare`]) stand in the second place, after a first clause that does nothing where there is none.

use super::program::{Arg, INPUTS, Program};
use crate::tape::interpreter::is_rare;
use crate::tape::{Instruction, Operand, opcode};

/// Most slots of a region's tape.
pub(super) const SLOTS_MAX: usize = 256;

/// Four words.
pub(super) type Texel = [u32; 4];

/// Writes programs.
#[derive(Debug, Default)]
pub(super) struct Encoder {
    /// By value: the last step that reads it, `u32::MAX` for what is read at the end, 0 for what nothing reads.
    last_use: Vec<u32>,
    /// By value: its slot.
    slot: Vec<u8>,
    texels: Vec<Texel>,
    /// Most slots of a program so far.
    pub(super) slots: usize,
    /// Clauses of the last program.
    pub(super) clauses: usize,
}

/// The program needs more slots than there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct TooManySlots;

impl Encoder {
    /// The texels of the program that gives two of its roots.
    pub(super) fn encode(
        &mut self,
        program: &Program,
        outputs: [usize; 2],
    ) -> Result<&[Texel], TooManySlots> {
        let roots = outputs.map(|root| program.roots.get(root).copied().unwrap_or(Arg::Number(0.0)));
        self.find_last_uses(program, roots);
        self.texels.clear();
        self.clauses = 0;
        self.slot.clear();
        self.slot.extend(0..INPUTS as u8);
        self.slot.resize(program.values(), 0);
        let mut free = [u64::MAX; SLOTS_MAX / 64];
        for input in 0..INPUTS {
            if self.last_use[input] != 0 {
                free[0] &= !(1 << input);
            }
        }
        let mut highest = INPUTS;
        for (index, step) in program.steps.iter().enumerate() {
            let at = INPUTS + index;
            if self.last_use[at] == 0 {
                continue;
            }
            let operand = |arg: Arg| match arg {
                Arg::Value(value) => Operand::Slot(self.slot[value as usize]),
                Arg::Number(_) => Operand::Immediate(0),
            };
            let (a, b) = (operand(step.a), operand(step.b));
            for arg in [step.a, step.b] {
                if let Arg::Value(value) = arg
                    && self.last_use[value as usize] == at as u32
                {
                    let slot = self.slot[value as usize];
                    free[usize::from(slot >> 6)] |= 1 << (slot & 63);
                }
            }
            let output = take(&mut free)?;
            highest = highest.max(usize::from(output) + 1);
            self.slot[at] = output;
            let instruction = match a {
                Operand::Slot(a) if step.op.arity() == 1 => Instruction::Unary { op: step.op, output, a },
                a => Instruction::Binary { op: step.op, output, a, b },
            };
            let immediate = match (step.a, step.b) {
                (Arg::Number(number), _) | (_, Arg::Number(number)) => number,
                _ => 0.0,
            };
            self.write(instruction.encode().word(), immediate, is_rare(step.op));
        }
        let mut slots = [0; 2];
        for (slot, root) in slots.iter_mut().zip(roots) {
            *slot = match root {
                Arg::Value(value) => self.slot[value as usize],
                Arg::Number(number) => {
                    let output = take(&mut free)?;
                    highest = highest.max(usize::from(output) + 1);
                    self.write(Instruction::Load { output, entry: 0 }.encode().word(), number, false);
                    output
                }
            };
        }
        self.end(slots);
        self.slots = self.slots.max(highest);
        Ok(&self.texels)
    }

    fn find_last_uses(&mut self, program: &Program, roots: [Arg; 2]) {
        self.last_use.clear();
        self.last_use.resize(program.values(), 0);
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
            for arg in [step.a, step.b] {
                if let Arg::Value(value) = arg {
                    let last = &mut self.last_use[value as usize];
                    if *last == 0 {
                        *last = at as u32;
                    }
                }
            }
        }
    }

    fn write(&mut self, word: u32, immediate: f32, second: bool) {
        self.clauses += 1;
        let immediate = immediate.to_bits();
        match self.texels.last_mut() {
            Some(last) if last[2] == u32::from(opcode::END) => (last[2], last[3]) = (word, immediate),
            _ if second => self.texels.push([0, 0, word, immediate]),
            _ => self.texels.push([word, immediate, 0, 0]),
        }
    }

    fn end(&mut self, [first, second]: [u8; 2]) {
        let end = u32::from_le_bytes([opcode::END, 0, first, second]);
        match self.texels.last_mut() {
            Some(last) if last[2] == u32::from(opcode::END) => last[2] = end,
            _ => self.texels.push([0, 0, end, 0]),
        }
    }
}

/// The lowest free slot.
fn take(free: &mut [u64; SLOTS_MAX / 64]) -> Result<u8, TooManySlots> {
    for (part, bits) in free.iter_mut().enumerate() {
        if *bits != 0 {
            let slot = 64 * part as u32 + bits.trailing_zeros();
            *bits &= *bits - 1;
            return Ok(slot as u8);
        }
    }
    Err(TooManySlots)
}
