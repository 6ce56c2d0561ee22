//! Evaluation of tapes on the CPU. The same generic code computes with numbers, batches of numbers, intervals or dual
//! numbers.

use super::{Clause, Instruction, Operand, Tape};
use crate::graph::{FrameInputs, Kernel, Op, Point, Properties};

/// Points that [`Batch`] computes at once.
const BATCH: usize = 64;

pub(super) trait Domain {
    type Value: Copy;
    fn constant(&self, number: f32) -> Self::Value;
    fn input(&self, place: usize) -> Self::Value;
    /// If the operator takes one operand, `b` is `a`.
    fn operator(&mut self, op: Op, a: &Self::Value, b: &Self::Value) -> Self::Value;
    fn texture(&mut self, texture: u16, channel: u8, u: &Self::Value, v: &Self::Value) -> Self::Value;
}

#[derive(Debug, Clone)]
pub(super) struct Machine<'a, V> {
    pub(super) tape: &'a Tape,
    pub(super) registers: Vec<V>,
    table: Vec<f32>,
}

impl<'a, V: Copy> Machine<'a, V> {
    pub(super) fn new(tape: &'a Tape, frame: &FrameInputs, zero: V) -> Self {
        Self { tape, registers: vec![zero; tape.registers], table: tape.table_values(frame) }
    }

    /// Returns an output after a run.
    pub(super) fn output(&self, output: Operand, domain: &impl Domain<Value = V>) -> V {
        match output {
            Operand::Register(register) => self.registers[register as usize],
            Operand::Immediate(entry) => domain.constant(self.table[entry as usize]),
        }
    }

    #[inline(always)]
    pub(super) fn run(&mut self, domain: &mut impl Domain<Value = V>) {
        let Self { tape, registers, table } = self;
        for Clause { instruction, output, operands: [a, b] } in &tape.clauses {
            let (first, second);
            let a = match *a {
                Operand::Register(register) => &registers[register as usize],
                Operand::Immediate(entry) => {
                    first = domain.constant(table[entry as usize]);
                    &first
                }
            };
            let b = match *b {
                Operand::Register(register) => &registers[register as usize],
                Operand::Immediate(entry) => {
                    second = domain.constant(table[entry as usize]);
                    &second
                }
            };
            registers[*output as usize] = match *instruction {
                Instruction::Input(place) => domain.input(usize::from(place)),
                Instruction::Texture { texture, channel } => domain.texture(texture, channel, a, b),
                Instruction::Operator(op) => domain.operator(op, a, b),
            };
        }
    }
}

/// Evaluates a tape at single points, within one frame.
#[derive(Debug, Clone)]
pub struct PointEvaluator<'a> {
    frame: &'a FrameInputs,
    machine: Machine<'a, [f32; 1]>,
    outputs: Vec<f32>,
}

impl<'a> PointEvaluator<'a> {
    /// Creates an evaluator of the tape with a frame's inputs.
    pub fn new(tape: &'a Tape, frame: &'a FrameInputs) -> Self {
        let outputs = vec![0.0; tape.outputs.len()];
        Self { frame, machine: Machine::new(tape, frame, [0.0]), outputs }
    }

    /// Returns the outputs at `point`, bit for bit equal to the graph's values.
    pub fn at(&mut self, point: &Point) -> &[f32] {
        let [position, normal] =
            [&point.position, &point.normal].map(|v| v.each_ref().map(std::slice::from_ref));
        let points = Points { position, normal: Some(normal) };
        let mut domain = Lanes { points, start: 0, frame: self.frame };
        self.machine.run(&mut domain);
        for (value, output) in self.outputs.iter_mut().zip(&self.machine.tape.outputs) {
            *value = self.machine.output(*output, &domain)[0] + 0.0;
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
    fn lanes<const LANES: usize>(&self, place: usize, start: usize) -> [f32; LANES] {
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

/// Several points at once.
struct Lanes<'a, const LANES: usize> {
    points: Points<'a>,
    start: usize,
    frame: &'a FrameInputs,
}

struct LaneKernel<'a, const LANES: usize> {
    a: &'a [f32; LANES],
    b: &'a [f32; LANES],
    result: [f32; LANES],
    frame: &'a FrameInputs,
}

impl<const LANES: usize> Kernel<f32> for LaneKernel<'_, LANES> {
    #[inline(always)]
    fn run(&mut self, meaning: impl Fn(f32, f32, &FrameInputs) -> f32 + Copy) {
        for lane in 0..LANES {
            self.result[lane] = meaning(self.a[lane], self.b[lane], self.frame);
        }
    }
}

impl<const LANES: usize> Domain for Lanes<'_, LANES> {
    type Value = [f32; LANES];
    #[inline(always)]
    fn constant(&self, value: f32) -> Self::Value {
        [value; LANES]
    }
    fn input(&self, place: usize) -> Self::Value {
        self.points.lanes(place, self.start)
    }
    #[inline(always)]
    fn operator(&mut self, op: Op, a: &Self::Value, b: &Self::Value) -> Self::Value {
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
    frame: &'a FrameInputs,
    machine: Machine<'a, [f32; BATCH]>,
}

impl<'a> Batch<'a> {
    /// Creates an evaluator of the tape with a frame's inputs.
    pub fn new(tape: &'a Tape, frame: &'a FrameInputs) -> Self {
        Self { frame, machine: Machine::new(tape, frame, [0.0; BATCH]) }
    }

    /// Returns the values at `points`, a vector per output, bit for bit equal to the values of [`PointEvaluator`].
    pub fn run(&mut self, points: Points<'_>) -> Vec<Vec<f32>> {
        let count = points.count();
        let tape = self.machine.tape;
        let mut outputs: Vec<Vec<f32>> = tape.outputs.iter().map(|_| Vec::with_capacity(count)).collect();
        for start in (0..count).step_by(BATCH) {
            let mut domain = Lanes { points, start, frame: self.frame };
            self.machine.run(&mut domain);
            let lanes = BATCH.min(count - start);
            for (values, output) in outputs.iter_mut().zip(&tape.outputs) {
                let row = self.machine.output(*output, &domain);
                values.extend(row[..lanes].iter().map(|value| value + 0.0));
            }
        }
        outputs
    }
}
