//! Evaluation of tapes on the CPU. The same generic code computes with numbers, batches of numbers, intervals or dual
//! numbers.

use super::Tape;
use super::clause::{Instruction, Operand};
use crate::graph::{FrameInputs, Kernel, Op, Point, Properties};

const LANES: usize = 64;

pub(super) trait Domain {
    type Value: Copy;
    fn constant(&self, number: f32) -> Self::Value;
    fn input(&self, place: usize) -> Self::Value;
    fn unary(&mut self, op: Op, a: &Self::Value) -> Self::Value;
    fn binary(&mut self, op: Op, a: &Self::Value, b: &Self::Value) -> Self::Value;
    fn texture(&mut self, texture: u16, channel: u8, u: &Self::Value, v: &Self::Value) -> Self::Value;
}

#[derive(Debug, Clone)]
pub(super) struct Machine<V> {
    /// The decoded clauses. They are decoded once, because a tape runs at many points.
    instructions: Vec<Instruction>,
    pub(super) registers: Vec<V>,
    memory: Vec<V>,
    table: Vec<f32>,
}

impl<V: Copy> Machine<V> {
    pub(super) fn new(tape: &Tape, frame: &FrameInputs, zero: V) -> Self {
        let mut table = Vec::new();
        tape.table_values(frame, &mut table);
        Self {
            instructions: tape.clauses.iter().filter_map(|clause| clause.decode()).collect(),
            registers: vec![zero; tape.registers.max(1)],
            memory: vec![zero; tape.memory],
            table,
        }
    }

    #[inline(always)]
    pub(super) fn run(&mut self, domain: &mut impl Domain<Value = V>) {
        let Self { instructions, registers, memory, table } = self;
        let mut page = 0;
        let mut selected = (0, 0);
        for instruction in instructions.iter() {
            match *instruction {
                Instruction::End => break,
                Instruction::Page(number) => page = usize::from(number) * 256,
                Instruction::Load { output, entry } => {
                    registers[usize::from(output)] = domain.constant(table[page + usize::from(entry)]);
                }
                Instruction::Store { register, memory: to } => {
                    memory[usize::from(to)] = registers[usize::from(register)]
                }
                Instruction::Reload { output, memory: from } => {
                    registers[usize::from(output)] = memory[usize::from(from)];
                }
                Instruction::SelectTexture { texture, channel } => selected = (texture, channel),
                Instruction::Texture { output, u, v } => {
                    let value = domain.texture(
                        selected.0,
                        selected.1,
                        &registers[usize::from(u)],
                        &registers[usize::from(v)],
                    );
                    registers[usize::from(output)] = value;
                }
                Instruction::Input { output, place } => {
                    registers[usize::from(output)] = domain.input(usize::from(place));
                }
                Instruction::Unary { op, output, a } => {
                    registers[usize::from(output)] = domain.unary(op, &registers[usize::from(a)]);
                }
                Instruction::Binary { op, output, a, b } => {
                    let value = match (a, b) {
                        (Operand::Register(a), Operand::Register(b)) => {
                            domain.binary(op, &registers[usize::from(a)], &registers[usize::from(b)])
                        }
                        (Operand::Register(a), Operand::Immediate(b)) => {
                            let b = domain.constant(table[page + usize::from(b)]);
                            domain.binary(op, &registers[usize::from(a)], &b)
                        }
                        (Operand::Immediate(a), Operand::Register(b)) => {
                            let a = domain.constant(table[page + usize::from(a)]);
                            domain.binary(op, &a, &registers[usize::from(b)])
                        }
                        (Operand::Immediate(_), Operand::Immediate(_)) => continue,
                    };
                    registers[usize::from(output)] = value;
                }
            }
        }
    }
}

struct Numbers<'a> {
    inputs: [f32; 6],
    frame: &'a FrameInputs,
}

impl Domain for Numbers<'_> {
    type Value = f32;
    #[inline(always)]
    fn constant(&self, value: f32) -> f32 {
        value
    }
    #[inline(always)]
    fn input(&self, place: usize) -> f32 {
        self.inputs[place]
    }
    #[inline(always)]
    fn unary(&mut self, op: Op, a: &f32) -> f32 {
        op.value(*a, 0.0, self.frame)
    }
    #[inline(always)]
    fn binary(&mut self, op: Op, a: &f32, b: &f32) -> f32 {
        op.value(*a, *b, self.frame)
    }
    #[inline(always)]
    fn texture(&mut self, texture: u16, channel: u8, u: &f32, v: &f32) -> f32 {
        self.frame.texture(texture, channel, *u, *v)
    }
}

/// Evaluates a tape at single points, within one frame.
#[derive(Debug, Clone)]
pub struct PointEvaluator<'a> {
    tape: &'a Tape,
    frame: &'a FrameInputs,
    machine: Machine<f32>,
    outputs: Vec<f32>,
}

impl<'a> PointEvaluator<'a> {
    /// Creates an evaluator of the tape with a frame's inputs.
    pub fn new(tape: &'a Tape, frame: &'a FrameInputs) -> Self {
        let outputs = vec![0.0; tape.outputs.len()];
        Self { tape, frame, machine: Machine::new(tape, frame, 0.0), outputs }
    }

    /// Returns the outputs at `point`, bit for bit equal to the graph's values.
    pub fn at(&mut self, point: &Point) -> &[f32] {
        let mut domain = Numbers { inputs: point.inputs(), frame: self.frame };
        self.machine.run(&mut domain);
        for (value, &register) in self.outputs.iter_mut().zip(&self.tape.outputs) {
            *value = self.machine.registers[usize::from(register)] + 0.0;
        }
        &self.outputs
    }
}

/// Many points, with a slice per coordinate. The shortest slice determines the number of points.
#[derive(Debug, Clone, Copy)]
pub struct Points<'a> {
    /// x, y and z of the positions.
    pub position: [&'a [f32]; 3],
    /// x, y and z of the normals; `None` for zero normals.
    pub normal: Option<[&'a [f32]; 3]>,
}

impl Points<'_> {
    fn count(&self) -> usize {
        let slices = self.position.iter().chain(self.normal.iter().flatten());
        slices.map(|slice| slice.len()).min().unwrap_or(0)
    }

    /// One coordinate of the points from index `start` on, padded with 0.
    fn lanes(&self, place: usize, start: usize) -> [f32; LANES] {
        let slice = match place {
            0..=2 => self.position[place],
            _ => self.normal.map_or(&[][..], |normal| normal[place - 3]),
        };
        let mut lanes = [0.0; LANES];
        let part = slice.get(start..).unwrap_or(&[]);
        for (lane, value) in lanes.iter_mut().zip(part) {
            *lane = *value;
        }
        lanes
    }
}

struct Lanes<'a> {
    points: Points<'a>,
    start: usize,
    frame: &'a FrameInputs,
}

struct LaneKernel<'a> {
    a: &'a [f32; LANES],
    b: &'a [f32; LANES],
    result: [f32; LANES],
    frame: &'a FrameInputs,
}

impl Kernel<f32> for LaneKernel<'_> {
    #[inline(always)]
    fn run(&mut self, meaning: impl Fn(f32, f32, &FrameInputs) -> f32 + Copy) {
        for lane in 0..LANES {
            self.result[lane] = meaning(self.a[lane], self.b[lane], self.frame);
        }
    }
}

impl Domain for Lanes<'_> {
    type Value = [f32; LANES];
    #[inline(always)]
    fn constant(&self, value: f32) -> Self::Value {
        [value; LANES]
    }
    fn input(&self, place: usize) -> Self::Value {
        self.points.lanes(place, self.start)
    }
    #[inline(always)]
    fn unary(&mut self, op: Op, a: &Self::Value) -> Self::Value {
        self.binary(op, a, a)
    }
    #[inline(always)]
    fn binary(&mut self, op: Op, a: &Self::Value, b: &Self::Value) -> Self::Value {
        // Sums over the history read a table many times, often at the same place for all points.
        let is_same = |lanes: &Self::Value| lanes.iter().all(|lane| lane.to_bits() == lanes[0].to_bits());
        if op.properties().has(Properties::READS_FRAME) && is_same(a) && is_same(b) {
            return [op.value(a[0], b[0], self.frame); LANES];
        }
        let mut kernel = LaneKernel { a, b, result: [0.0; LANES], frame: self.frame };
        op.with_value(&mut kernel);
        kernel.result
    }
    fn texture(&mut self, texture: u16, channel: u8, u: &Self::Value, v: &Self::Value) -> Self::Value {
        std::array::from_fn(|lane| self.frame.texture(texture, channel, u[lane], v[lane]))
    }
}

/// Evaluates a tape at many points at once, within one frame.
#[derive(Debug, Clone)]
pub struct Batch<'a> {
    tape: &'a Tape,
    frame: &'a FrameInputs,
    machine: Machine<[f32; LANES]>,
}

impl<'a> Batch<'a> {
    /// Creates an evaluator of the tape with a frame's inputs.
    pub fn new(tape: &'a Tape, frame: &'a FrameInputs) -> Self {
        Self { tape, frame, machine: Machine::new(tape, frame, [0.0; LANES]) }
    }

    /// Returns the values at `points`, a vector per output, bit for bit equal to the values of [`PointEvaluator`].
    pub fn run(&mut self, points: Points<'_>) -> Vec<Vec<f32>> {
        let count = points.count();
        let mut outputs: Vec<Vec<f32>> =
            self.tape.outputs.iter().map(|_| Vec::with_capacity(count)).collect();
        for start in (0..count).step_by(LANES) {
            let mut domain = Lanes { points, start, frame: self.frame };
            self.machine.run(&mut domain);
            let lanes = LANES.min(count - start);
            for (values, &register) in outputs.iter_mut().zip(&self.tape.outputs) {
                let row = &self.machine.registers[usize::from(register)];
                values.extend(row[..lanes].iter().map(|value| value + 0.0));
            }
        }
        outputs
    }
}
