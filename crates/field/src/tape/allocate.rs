//! Register allocation: turns the graph into clauses.

use super::clause::{Instruction, Operand};
use super::{TableEntry, Tape, TapeError, TapeOptions};
use crate::graph::{Graph, Node, NodeId, Op, Properties};

/// Marks a missing register, memory slot, table entry or next use.
const NONE: u32 = u32::MAX;
/// Registers whose next uses are compared at once.
const REGISTERS_AT_ONCE: usize = 32;

pub(super) fn build(graph: &Graph, roots: &[NodeId], options: &TapeOptions) -> Result<Tape, TapeError> {
    if !(2..=256).contains(&options.registers) {
        return Err(TapeError::RegisterCount(options.registers));
    }
    if roots.len() > options.registers {
        return Err(TapeError::TooManyOutputs { count: roots.len(), max: options.registers });
    }
    graph.check()?;
    let order = graph.order(roots);
    let next_uses = next_uses(graph, &order, roots);
    let nodes = roots.iter().max().map_or(0, |last| last.index() + 1);
    let mut allocator = Allocator {
        graph,
        options,
        tape: Tape { clauses: Vec::with_capacity(order.len() + 8), ..Tape::default() },
        places: vec![Place::default(); nodes],
        held: [None; 256],
        next_use: [NONE; 256],
        free: [u64::MAX; 4],
        pinned: [0; 4],
        free_memory: Vec::new(),
    };
    for (&id, &uses) in order.iter().zip(&next_uses) {
        allocator.define(id, uses)?;
        if allocator.tape.clauses.len() > options.limits.tape_clauses_max {
            return Err(TapeError::TooManyClauses(options.limits.tape_clauses_max));
        }
    }
    allocator.finish(roots)?;
    let tape = allocator.tape;
    if tape.clauses.len() > options.limits.tape_clauses_max {
        return Err(TapeError::TooManyClauses(options.limits.tape_clauses_max));
    }
    Ok(tape)
}

/// The next uses of a node's value and of its operands, after the node's position in the order.
#[derive(Debug, Clone, Copy, Default)]
struct NextUses {
    own: u32,
    a: u32,
    b: u32,
}

fn next_uses(graph: &Graph, order: &[NodeId], roots: &[NodeId]) -> Vec<NextUses> {
    let nodes = roots.iter().max().map_or(0, |last| last.index() + 1);
    let mut upcoming = vec![NONE; nodes];
    for root in roots {
        upcoming[root.index()] = order.len() as u32;
    }
    let mut uses = vec![NextUses::default(); order.len()];
    for (position, &id) in order.iter().enumerate().rev() {
        let position_word = position as u32;
        let entry = &mut uses[position];
        entry.own = upcoming[id.index()];
        match graph.node(id) {
            Node::Constant(_) | Node::Input(_) => {}
            Node::Unary(_, a) => entry.a = std::mem::replace(&mut upcoming[a.index()], position_word),
            Node::Binary(_, a, b) | Node::Texture { u: a, v: b, .. } => {
                // Look up both next uses before changing either: both operands may be the same node.
                (entry.a, entry.b) = (upcoming[a.index()], upcoming[b.index()]);
                upcoming[a.index()] = position_word;
                upcoming[b.index()] = position_word;
            }
        }
    }
    uses
}

#[derive(Debug, Clone, Copy)]
struct Place {
    /// The register, or the entry if the table holds the value.
    register_or_entry: u32,
    memory: u32,
}

impl Default for Place {
    fn default() -> Self {
        Self { register_or_entry: NONE, memory: NONE }
    }
}

struct Allocator<'a> {
    graph: &'a Graph,
    options: &'a TapeOptions,
    tape: Tape,
    places: Vec<Place>,
    held: [Option<NodeId>; 256],
    next_use: [u32; 256],
    free: [u64; 4],
    /// One bit per register: 1 if the register must not be spilled now.
    pinned: [u64; 4],
    free_memory: Vec<u16>,
}

impl Allocator<'_> {
    fn emit(&mut self, instruction: Instruction) {
        self.tape.clauses.push(instruction);
    }

    fn in_table(&self, id: NodeId) -> bool {
        match self.graph.node(id) {
            Node::Constant(_) => true,
            Node::Input(input) => input.of_point().is_none(),
            _ => false,
        }
    }

    /// Returns the entry of the table that holds the value.
    fn entry(&mut self, id: NodeId) -> u32 {
        let entry = &mut self.places[id.index()].register_or_entry;
        if *entry == NONE {
            *entry = self.tape.table.len() as u32;
            self.tape.table.push(match self.graph.node(id) {
                Node::Input(input) => TableEntry::Input(input),
                node => TableEntry::Constant(node.as_constant().unwrap_or(0.0)),
            });
        }
        *entry
    }

    fn is_free(&self, register: u8) -> bool {
        self.free[usize::from(register >> 6)] >> (register & 63) & 1 == 1
    }

    fn release(&mut self, register: u8) {
        self.free[usize::from(register >> 6)] |= 1 << (register & 63);
        if let Some(id) = self.held[usize::from(register)].take() {
            let place = &mut self.places[id.index()];
            place.register_or_entry = NONE;
            if place.memory != NONE {
                self.free_memory.push(place.memory as u16);
                place.memory = NONE;
            }
        }
    }

    fn pin(&mut self, register: u8) {
        self.pinned[usize::from(register >> 6)] |= 1 << (register & 63);
    }

    fn allocate_any(&mut self) -> Result<u8, TapeError> {
        let lowest = (0..4)
            .find(|&part| self.free[part] != 0)
            .map(|part| part * 64 + self.free[part].trailing_zeros() as usize);
        let register = match lowest {
            Some(register) if register < self.options.registers => register as u8,
            _ => self.spill()?,
        };
        self.allocate(register);
        Ok(register)
    }

    fn allocate(&mut self, register: u8) {
        self.free[usize::from(register >> 6)] &= !(1 << (register & 63));
        self.tape.registers = self.tape.registers.max(usize::from(register) + 1);
    }

    /// Frees the register whose value has the farthest next use.
    #[cold]
    fn spill(&mut self) -> Result<u8, TapeError> {
        // A tape with many shared values spills at every second clause. The largest next use of several registers is
        // found without branches. Pinned registers count as used at once.
        let mut next_use = self.next_use;
        for (part, pinned) in self.pinned.into_iter().enumerate() {
            let mut left = pinned;
            while left != 0 {
                next_use[part * 64 + left.trailing_zeros() as usize] = 0;
                left &= left - 1;
            }
        }
        let mut farthest = 0;
        let mut first = 0;
        for (number, some) in next_use[..self.options.registers].chunks(REGISTERS_AT_ONCE).enumerate() {
            let most = some.iter().fold(0, |most, next| most.max(*next));
            if most > farthest {
                (farthest, first) = (most, number * REGISTERS_AT_ONCE);
            }
        }
        // At most two operands are pinned, or all outputs except the output that is being fetched.
        if farthest == 0 {
            return Err(TapeError::RegisterCount(self.options.registers));
        }
        let register = (first..).zip(&next_use[first..]).find(|(_, next)| **next == farthest);
        let register = register.map_or(first, |(register, _)| register) as u8;
        if let Some(id) = self.held[usize::from(register)].take() {
            let again = matches!(self.graph.node(id), Node::Input(_)) || self.in_table(id);
            if !again && self.places[id.index()].memory == NONE {
                let memory = self.allocate_memory()?;
                self.places[id.index()].memory = u32::from(memory);
                self.emit(Instruction::Store { register, memory });
            }
            if !self.in_table(id) {
                self.places[id.index()].register_or_entry = NONE;
            }
        }
        Ok(register)
    }

    fn allocate_memory(&mut self) -> Result<u16, TapeError> {
        if let Some(memory) = self.free_memory.pop() {
            return Ok(memory);
        }
        let max = self.options.limits.tape_memory_max.min(1 << 16);
        if self.tape.memory >= max {
            return Err(TapeError::TooMuchMemory(max));
        }
        self.tape.memory += 1;
        Ok((self.tape.memory - 1) as u16)
    }

    fn fetch(&mut self, id: NodeId) -> Result<u8, TapeError> {
        if self.in_table(id) { self.fetch_entry(id) } else { self.fetch_value(id) }
    }

    fn fetch_entry(&mut self, id: NodeId) -> Result<u8, TapeError> {
        let output = self.allocate_any()?;
        let entry = self.entry(id);
        self.emit(Instruction::Load { output, entry });
        self.pin(output);
        Ok(output)
    }

    #[inline]
    fn fetch_value(&mut self, id: NodeId) -> Result<u8, TapeError> {
        let place = self.places[id.index()];
        let register = if place.register_or_entry != NONE {
            place.register_or_entry as u8
        } else {
            let output = self.allocate_any()?;
            match self.graph.node(id) {
                Node::Input(input) => {
                    let place = input.of_point().unwrap_or(0) as u8;
                    self.emit(Instruction::Input { output, place });
                }
                _ => self.emit(Instruction::Reload { output, memory: place.memory as u16 }),
            }
            self.hold(output, id);
            output
        };
        self.pin(register);
        Ok(register)
    }

    fn hold(&mut self, register: u8, id: NodeId) {
        self.held[usize::from(register)] = Some(id);
        self.places[id.index()].register_or_entry = u32::from(register);
    }

    /// Frees the register after its value's last use. Always frees a register that holds a table entry.
    fn used(&mut self, register: u8, next_use: u32) {
        self.next_use[usize::from(register)] = next_use;
        if next_use == NONE || self.held[usize::from(register)].is_none() {
            self.release(register);
        }
    }

    /// Returns a register for a result: the register of operand b or a if it has become free, else another register.
    fn result(&mut self, a: Option<u8>, b: Option<u8>) -> Result<u8, TapeError> {
        self.pinned = [0; 4];
        for register in [b, a].into_iter().flatten() {
            if self.is_free(register) {
                self.allocate(register);
                return Ok(register);
            }
        }
        self.allocate_any()
    }

    fn define(&mut self, id: NodeId, uses: NextUses) -> Result<(), TapeError> {
        let output = match self.graph.node(id) {
            Node::Constant(_) => return Ok(()),
            Node::Input(input) => {
                let Some(place) = input.of_point() else { return Ok(()) };
                let output = self.allocate_any()?;
                self.emit(Instruction::Input { output, place: place as u8 });
                output
            }
            Node::Unary(op, a) => {
                let a = self.fetch(a)?;
                self.used(a, uses.a);
                let output = self.result(Some(a), None)?;
                self.emit(Instruction::Unary { op, output, a });
                output
            }
            Node::Binary(op, a, b) => self.binary(op, a, b, uses)?,
            Node::Texture { texture, channel, u, v } => {
                let first = self.fetch(u)?;
                let second = if u == v { first } else { self.fetch(v)? };
                self.used(first, uses.a);
                self.used(second, uses.b);
                let output = self.result(Some(first), Some(second))?;
                self.emit(Instruction::Texture { output, texture, channel, u: first, v: second });
                output
            }
        };
        self.next_use[usize::from(output)] = uses.own;
        self.hold(output, id);
        Ok(())
    }

    fn binary(&mut self, op: Op, mut a: NodeId, mut b: NodeId, mut uses: NextUses) -> Result<u8, TapeError> {
        let mut in_table = (self.in_table(a), self.in_table(b));
        if in_table == (true, false) && op.properties().has(Properties::COMMUTATIVE) {
            std::mem::swap(&mut a, &mut b);
            std::mem::swap(&mut uses.a, &mut uses.b);
            in_table = (false, true);
        }
        let (left, right) = match in_table {
            (false, false) => {
                let left = self.fetch_value(a)?;
                (Some(left), Some(if a == b { left } else { self.fetch_value(b)? }))
            }
            (false, true) => (Some(self.fetch_value(a)?), None),
            (true, false) => (None, Some(self.fetch_value(b)?)),
            // No clause can read two entries of the table, so load the first value into a register.
            (true, true) => (Some(self.fetch_entry(a)?), None),
        };
        if let Some(register) = left {
            self.used(register, uses.a);
        }
        if let Some(register) = right {
            self.used(register, uses.b);
        }
        let output = self.result(left, right)?;
        let left = left.map_or_else(|| Operand::Immediate(self.entry(a)), Operand::Register);
        let right = right.map_or_else(|| Operand::Immediate(self.entry(b)), Operand::Register);
        self.emit(Instruction::Binary { op, output, a: left, b: right });
        Ok(output)
    }

    fn finish(&mut self, roots: &[NodeId]) -> Result<(), TapeError> {
        self.pinned = [0; 4];
        for (place, &root) in roots.iter().enumerate() {
            let same = roots[..place].iter().position(|&earlier| earlier == root);
            let register = match same {
                Some(earlier) => self.tape.outputs[earlier],
                None => self.fetch(root)?,
            };
            self.tape.outputs.push(register);
        }
        Ok(())
    }
}
