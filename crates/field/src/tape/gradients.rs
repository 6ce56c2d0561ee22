//! Gradients of tapes by forward-mode dual numbers, at one point or at several points at once.

use super::Tape;
use super::evaluate::{Domain, Machine};
use crate::graph::{DualKernel, FrameInputs, GradientInterval, Interval, Op, Pieces, Point};

/// Points that [`GradientBatch`] computes at once.
const LANES: usize = 8;

/// A value and its derivatives by x, y and z.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Dual {
    /// The value.
    pub value: f32,
    /// The gradient.
    pub gradient: [f32; 3],
}

/// The values and gradients at `N` points.
#[derive(Debug, Clone, Copy)]
struct Duals<const N: usize> {
    value: [f32; N],
    gradient: [[f32; N]; 3],
}

impl<const N: usize> Duals<N> {
    const ZERO: Self = Self { value: [0.0; N], gradient: [[0.0; N]; 3] };

    fn at(&self, lane: usize) -> Dual {
        Dual { value: self.value[lane] + 0.0, gradient: self.gradient.map(|part| part[lane]) }
    }
}

struct Lanes<'a, const N: usize> {
    inputs: [[f32; N]; 6],
    frame: &'a FrameInputs,
}

struct Values<'a, const N: usize> {
    a: &'a [f32; N],
    b: &'a [f32; N],
    frame: &'a FrameInputs,
    value: [f32; N],
    by_a: [f32; N],
    by_b: [f32; N],
}

impl<'a, const N: usize> Values<'a, N> {
    #[inline(always)]
    fn of(op: Op, a: &'a [f32; N], b: &'a [f32; N], frame: &'a FrameInputs) -> Self {
        let mut values = Self { a, b, frame, value: [0.0; N], by_a: [0.0; N], by_b: [0.0; N] };
        op.with_slopes(&mut values);
        values
    }
}

impl<const N: usize> DualKernel for Values<'_, N> {
    #[inline(always)]
    fn run(
        &mut self,
        meaning: impl Fn(f32, f32, &FrameInputs) -> f32,
        slopes: impl Fn(f32, f32, f32, &FrameInputs) -> (f32, f32),
    ) {
        for lane in 0..N {
            let (a, b) = (self.a[lane], self.b[lane]);
            let value = meaning(a, b, self.frame);
            (self.by_a[lane], self.by_b[lane]) = slopes(a, b, value, self.frame);
            self.value[lane] = value;
        }
    }
}

impl<const N: usize> Domain for Lanes<'_, N> {
    type Value = Duals<N>;
    type Entry = f32;
    fn constant(&self, value: f32) -> Duals<N> {
        Duals { value: [value; N], ..Duals::ZERO }
    }
    fn input(&self, place: usize) -> Duals<N> {
        let gradient = std::array::from_fn(|axis| [if axis == place { 1.0 } else { 0.0 }; N]);
        Duals { value: self.inputs[place], gradient }
    }
    fn unary(&mut self, op: Op, a: &Duals<N>) -> Duals<N> {
        let Values { value, by_a, .. } = Values::of(op, &a.value, &[0.0; N], self.frame);
        let mut duals = Duals { value, ..Duals::ZERO };
        for (part, of_a) in duals.gradient.iter_mut().zip(&a.gradient) {
            for lane in 0..N {
                part[lane] = along(by_a[lane], of_a[lane]);
            }
        }
        duals
    }
    fn binary(&mut self, op: Op, a: &Duals<N>, b: &Duals<N>) -> Duals<N> {
        let Values { value, by_a, by_b, .. } = Values::of(op, &a.value, &b.value, self.frame);
        let mut duals = Duals { value, ..Duals::ZERO };
        for ((part, of_a), of_b) in duals.gradient.iter_mut().zip(&a.gradient).zip(&b.gradient) {
            for lane in 0..N {
                part[lane] = along(by_a[lane], of_a[lane]) + along(by_b[lane], of_b[lane]);
            }
        }
        duals
    }
    fn texture(&mut self, texture: u16, channel: u8, u: &Duals<N>, v: &Duals<N>) -> Duals<N> {
        let sample = |lane: usize| self.frame.texture(texture, channel, u.value[lane], v.value[lane]);
        Duals { value: std::array::from_fn(sample), ..Duals::ZERO }
    }
}

/// Applies the chain rule. A constant operand contributes nothing, even if the operator's slope is infinite.
#[inline(always)]
fn along(slope: f32, change: f32) -> f32 {
    if change == 0.0 || slope == 0.0 { 0.0 } else { slope * change }
}

/// Evaluates a tape and its gradient at single points, within one frame. Textures are treated as constants.
#[derive(Debug, Clone)]
pub struct GradientEvaluator<'a> {
    tape: &'a Tape,
    frame: &'a FrameInputs,
    machine: Machine<Duals<1>>,
    outputs: Vec<Dual>,
}

impl<'a> GradientEvaluator<'a> {
    /// Creates an evaluator of the tape with a frame's inputs.
    pub fn new(tape: &'a Tape, frame: &'a FrameInputs) -> Self {
        let outputs = vec![Dual::default(); tape.outputs.len()];
        Self { tape, frame, machine: Machine::new(tape, frame, Duals::ZERO), outputs }
    }

    /// Returns the outputs at `point`, with their derivatives by the position.
    pub fn at(&mut self, point: &Point) -> &[Dual] {
        self.machine.run(&mut Lanes { inputs: point.inputs().map(|input| [input]), frame: self.frame });
        for (dual, &register) in self.outputs.iter_mut().zip(&self.tape.outputs) {
            *dual = self.machine.registers[usize::from(register)].at(0);
        }
        &self.outputs
    }
}

/// Evaluates a tape's first output and its gradient at many points, within one frame.
#[derive(Debug, Clone)]
pub struct GradientBatch<'a> {
    tape: &'a Tape,
    frame: &'a FrameInputs,
    machine: Machine<Duals<LANES>>,
}

impl<'a> GradientBatch<'a> {
    /// Creates an evaluator of the tape with a frame's inputs.
    pub fn new(tape: &'a Tape, frame: &'a FrameInputs) -> Self {
        Self { tape, frame, machine: Machine::new(tape, frame, Duals::ZERO) }
    }

    /// Replaces `duals` by the first output at each position, bit for bit equal to [`GradientEvaluator::at`]. Normals
    /// are zero. A tape without outputs gives no duals.
    pub fn run(&mut self, positions: &[[f32; 3]], duals: &mut Vec<Dual>) {
        duals.clear();
        let Some(&register) = self.tape.outputs.first() else { return };
        for some in positions.chunks(LANES) {
            let mut inputs = [[0.0; LANES]; 6];
            for (lane, position) in some.iter().enumerate() {
                for (input, value) in inputs.iter_mut().zip(position) {
                    input[lane] = *value;
                }
            }
            self.machine.run(&mut Lanes { inputs, frame: self.frame });
            let found = &self.machine.registers[usize::from(register)];
            duals.extend((0..some.len()).map(|lane| found.at(lane)));
        }
    }
}

// Bounds of a tape's gradient over boxes.

struct Slopes<'a> {
    position: [Interval; 3],
    normal: [Interval; 3],
    frame: &'a FrameInputs,
    jumps: Option<&'a mut Pieces>,
}

impl Domain for Slopes<'_> {
    type Value = GradientInterval;
    type Entry = Interval;
    fn constant(&self, entry: Interval) -> GradientInterval {
        GradientInterval::flat(entry)
    }
    fn input(&self, place: usize) -> GradientInterval {
        match place {
            0..=2 => GradientInterval::coordinate(place, self.position[place]),
            _ => GradientInterval::flat(self.normal[place - 3]),
        }
    }
    fn unary(&mut self, op: Op, a: &GradientInterval) -> GradientInterval {
        if let Some(jumps) = &mut self.jumps {
            jumps.add(GradientInterval::jump(op, a, self.position));
        }
        GradientInterval::unary(op, a, self.frame)
    }
    fn binary(&mut self, op: Op, a: &GradientInterval, b: &GradientInterval) -> GradientInterval {
        if let Some(jumps) = &mut self.jumps {
            jumps.add(GradientInterval::jump_of_two(op, a, b, self.position));
        }
        GradientInterval::binary(op, a, b, self.frame)
    }
    fn texture(
        &mut self,
        _texture: u16,
        _channel: u8,
        _u: &GradientInterval,
        _v: &GradientInterval,
    ) -> GradientInterval {
        GradientInterval::flat(Interval::UNIT)
    }
}

/// Computes bounds of a tape's values and of their gradients in boxes, within one frame. Textures are treated as
/// constants, as in [`super::GradientEvaluator`]. Jumps have no slope ([`GradientInterval`]).
#[derive(Debug, Clone)]
pub struct GradientIntervals<'a> {
    tape: &'a Tape,
    frame: &'a FrameInputs,
    machine: Machine<GradientInterval, Interval>,
    outputs: Vec<GradientInterval>,
    pieces: Pieces,
}

impl<'a> GradientIntervals<'a> {
    /// Creates an evaluator for the inputs of one frame, or of all frames ([`FrameInputs::any`]).
    pub fn new(tape: &'a Tape, frame: &'a FrameInputs) -> Self {
        let nothing = GradientInterval::flat(Interval::point(0.0));
        let machine = Machine::with_table(tape, tape.table_bounds(frame), nothing);
        Self { tape, frame, machine, outputs: vec![nothing; tape.outputs.len()], pieces: Pieces::default() }
    }

    /// Returns bounds of the outputs and their gradients over a box, which is cut where parts of the tape jump.
    pub fn over(&mut self, position: [Interval; 3], normal: [Interval; 3]) -> &[GradientInterval] {
        let Self { tape, frame, machine, outputs, pieces } = self;
        pieces.clear();
        machine.run(&mut Slopes { position, normal, frame, jumps: Some(pieces) });
        for (bounds, &register) in outputs.iter_mut().zip(&tape.outputs) {
            *bounds = machine.registers[usize::from(register)];
        }
        for (number, &position) in pieces.of(position).iter().enumerate() {
            machine.run(&mut Slopes { position, normal, frame, jumps: None });
            for (bounds, &register) in outputs.iter_mut().zip(&tape.outputs) {
                let piece = machine.registers[usize::from(register)];
                // Keep the value's bounds in the whole box: the pieces leave out the jumps themselves.
                let value = bounds.value;
                *bounds = if number == 0 { piece } else { bounds.hull(&piece) };
                bounds.value = value;
            }
        }
        &self.outputs
    }
}
