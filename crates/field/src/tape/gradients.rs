//! Gradients of tapes by forward-mode dual numbers, at several points at once.

use super::Tape;
use super::evaluate::{Domain, Machine};
use crate::graph::{DualKernel, FrameInputs, Op};

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

/// The values and gradients at several points.
#[derive(Debug, Clone, Copy)]
struct Duals {
    value: [f32; LANES],
    gradient: [[f32; LANES]; 3],
}

impl Duals {
    const ZERO: Self = Self { value: [0.0; LANES], gradient: [[0.0; LANES]; 3] };

    fn at(&self, lane: usize) -> Dual {
        Dual { value: self.value[lane] + 0.0, gradient: self.gradient.map(|part| part[lane]) }
    }
}

struct Lanes<'a> {
    inputs: [[f32; LANES]; 6],
    frame: &'a FrameInputs,
}

struct Values<'a> {
    a: &'a [f32; LANES],
    b: &'a [f32; LANES],
    frame: &'a FrameInputs,
    value: [f32; LANES],
    by_a: [f32; LANES],
    by_b: [f32; LANES],
}

impl DualKernel for Values<'_> {
    #[inline(always)]
    fn run(
        &mut self,
        meaning: impl Fn(f32, f32, &FrameInputs) -> f32,
        slopes: impl Fn(f32, f32, f32, &FrameInputs) -> (f32, f32),
    ) {
        for lane in 0..LANES {
            let (a, b) = (self.a[lane], self.b[lane]);
            let value = meaning(a, b, self.frame);
            (self.by_a[lane], self.by_b[lane]) = slopes(a, b, value, self.frame);
            self.value[lane] = value;
        }
    }
}

impl Domain for Lanes<'_> {
    type Value = Duals;
    fn constant(&self, value: f32) -> Duals {
        Duals { value: [value; LANES], ..Duals::ZERO }
    }
    fn input(&self, place: usize) -> Duals {
        let gradient = std::array::from_fn(|axis| [if axis == place { 1.0 } else { 0.0 }; LANES]);
        Duals { value: self.inputs[place], gradient }
    }
    fn operator(&mut self, op: Op, a: &Duals, b: &Duals) -> Duals {
        let (frame, zero) = (self.frame, [0.0; LANES]);
        let mut values = Values { a: &a.value, b: &b.value, frame, value: zero, by_a: zero, by_b: zero };
        op.with_slopes(&mut values);
        let Values { value, by_a, by_b, .. } = values;
        let mut duals = Duals { value, ..Duals::ZERO };
        for ((part, of_a), of_b) in duals.gradient.iter_mut().zip(&a.gradient).zip(&b.gradient) {
            for lane in 0..LANES {
                part[lane] = along(by_a[lane], of_a[lane]) + along(by_b[lane], of_b[lane]);
            }
        }
        duals
    }
    fn texture(&mut self, texture: u16, channel: u8, u: &Duals, v: &Duals) -> Duals {
        let sample = |lane: usize| self.frame.texture(texture, channel, u.value[lane], v.value[lane]);
        Duals { value: std::array::from_fn(sample), ..Duals::ZERO }
    }
}

/// Applies the chain rule. A constant operand contributes nothing, even if the operator's slope is infinite.
#[inline(always)]
fn along(slope: f32, change: f32) -> f32 {
    if change == 0.0 || slope == 0.0 { 0.0 } else { slope * change }
}

/// Evaluates a tape's first output and its gradient at many points, within one frame.
#[derive(Debug, Clone)]
pub struct GradientBatch<'a> {
    frame: &'a FrameInputs,
    machine: Machine<'a, Duals>,
}

impl<'a> GradientBatch<'a> {
    /// Creates an evaluator of the tape with a frame's inputs.
    pub fn new(tape: &'a Tape, frame: &'a FrameInputs) -> Self {
        Self { frame, machine: Machine::new(tape, frame, Duals::ZERO) }
    }

    /// Replaces `duals` by the first output at each position. Normals are zero, and textures count as constants. A tape
    /// without outputs gives no duals.
    pub fn run(&mut self, positions: &[[f32; 3]], duals: &mut Vec<Dual>) {
        duals.clear();
        let Some(&output) = self.machine.tape.outputs.first() else { return };
        for some in positions.chunks(LANES) {
            let mut inputs = [[0.0; LANES]; 6];
            for (lane, position) in some.iter().enumerate() {
                for (input, value) in inputs.iter_mut().zip(position) {
                    input[lane] = *value;
                }
            }
            let mut domain = Lanes { inputs, frame: self.frame };
            self.machine.run(&mut domain);
            let found = self.machine.output(output, &domain);
            duals.extend((0..some.len()).map(|lane| found.at(lane)));
        }
    }
}
