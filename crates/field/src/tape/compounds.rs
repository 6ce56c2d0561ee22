//! Replaces clauses by compounds after register allocation.

use super::interpreter::is_second;
use super::{Instruction, Operand, Tape};
use crate::graph::{Arg, Compounds, Found, Operation, Values};

/// Values 0..256 are the contents of the registers when a tape starts. The values of clauses follow.
const INITIAL: usize = 256;
/// Clauses farther apart than this do not form a compound. The limit keeps the search linear in the tape's length.
const REACH: usize = 64;

#[derive(Debug, Clone, Copy)]
pub(super) struct Clause {
    pub(super) word: u32,
    pub(super) immediate: u32,
    /// True if the clause must be the second clause of its texel.
    pub(super) second: bool,
    output: Option<u8>,
    operation: Option<Operation>,
    /// True if a later compound contains this clause.
    absorbed: bool,
}

#[derive(Debug, Clone)]
pub(super) struct RunClauses {
    clauses: Vec<Clause>,
    /// Number of reads (at most 2) of each register at the start, then of each clause's value.
    uses: Vec<u8>,
    held: [u32; INITIAL],
}

impl RunClauses {
    pub(super) fn of(tape: &Tape, table: &[f32]) -> Self {
        let count = tape.clauses().len();
        let mut uses = Vec::with_capacity(INITIAL + count);
        uses.resize(INITIAL, 0);
        let mut run = Self {
            clauses: Vec::with_capacity(count),
            uses,
            held: std::array::from_fn(|register| register as u32),
        };
        let number = |entry: u32| table.get(entry as usize).copied().unwrap_or(0.0);
        for instruction in tape.run_clauses() {
            let (mut immediate, mut operation) = (0, None);
            let output = match instruction {
                Instruction::Texture { output, texture, channel, u, v } => {
                    immediate = 4 * u32::from(texture) + u32::from(channel);
                    run.read(u);
                    run.read(v);
                    Some(output)
                }
                Instruction::Load { output, entry } => {
                    immediate = number(entry).to_bits();
                    Some(output)
                }
                Instruction::Store { register, .. } => {
                    run.read(register);
                    None
                }
                Instruction::Reload { output, .. } | Instruction::Input { output, .. } => Some(output),
                Instruction::Unary { op, output, a } => {
                    let a = Arg::Value(run.read(a));
                    operation = Some(Operation { op, a, b: a });
                    Some(output)
                }
                Instruction::Binary { op, output, a, b } => {
                    let mut arg = |operand: Operand| match operand {
                        Operand::Register(register) => Arg::Value(run.read(register)),
                        Operand::Immediate(entry) => {
                            immediate = number(entry).to_bits();
                            Arg::Number(number(entry))
                        }
                    };
                    let (a, b) = (arg(a), arg(b));
                    operation = Some(Operation { op, a, b });
                    Some(output)
                }
            };
            if let Some(output) = output {
                run.held[usize::from(output)] = run.uses.len() as u32;
            }
            run.uses.push(0);
            let (word, second) = (instruction.word(), is_second(instruction));
            run.clauses.push(Clause { word, immediate, second, output, operation, absorbed: false });
        }
        run
    }

    #[inline]
    fn read(&mut self, register: u8) -> u32 {
        let value = self.held[usize::from(register)];
        if let Some(uses) = self.uses.get_mut(value as usize) {
            *uses = (*uses + 1).min(2);
        }
        value
    }

    pub(super) fn compound(&mut self, compounds: Compounds, outputs: &[u8]) {
        for output in outputs {
            self.read(*output);
            self.read(*output);
        }
        for last in (0..self.clauses.len()).rev() {
            let Some(clause) = self.clauses.get(last).filter(|clause| !clause.absorbed) else { continue };
            let (Some(operation), Some(output)) = (clause.operation, clause.output) else { continue };
            let Some(found) = compounds.find(self, operation) else { continue };
            let Some([a, b]) = self.registers(&found, last) else { continue };
            for absorbed in found.absorbed() {
                if let Some(clause) = self.clauses.get_mut(*absorbed as usize - INITIAL) {
                    clause.absorbed = true;
                }
            }
            if let Some(clause) = self.clauses.get_mut(last) {
                clause.word = u32::from_le_bytes([found.compound.number(), output, a, b]);
                clause.immediate = found.number.to_bits();
                clause.second = false;
            }
        }
    }

    /// Returns the registers that a compound reads if it replaces the clause `last`; `None` if they no longer hold the
    /// operands of the clauses that the compound combines.
    fn registers(&self, found: &Found, last: usize) -> Option<[u8; 2]> {
        let first = found.absorbed().iter().map(|value| *value as usize - INITIAL).min()?;
        if last - first > REACH {
            return None;
        }
        let register = |value: u32| match (value as usize).checked_sub(INITIAL) {
            None => Some(value as u8),
            Some(clause) => self.clauses.get(clause)?.output,
        };
        let registers = [register(found.registers[0])?, register(found.registers[1])?];
        for (register, value) in registers.iter().zip(found.registers) {
            for (index, clause) in self.clauses.iter().enumerate().take(last).skip(first) {
                let at = (INITIAL + index) as u32;
                let vanishes = clause.absorbed || found.absorbed().contains(&at);
                // Only clauses after the operand's own clause, which may come after `first`, overwrite it.
                if clause.output == Some(*register) && at > value && !vanishes {
                    return None;
                }
            }
        }
        Some(registers)
    }

    pub(super) fn kept(&self) -> impl Iterator<Item = &Clause> {
        self.clauses.iter().filter(|clause| !clause.absorbed)
    }
}

impl Values for RunClauses {
    fn operation(&self, value: u32) -> Option<Operation> {
        self.clauses.get((value as usize).checked_sub(INITIAL)?)?.operation
    }

    fn is_own(&self, value: u32) -> bool {
        self.uses.get(value as usize) == Some(&1)
    }
}
