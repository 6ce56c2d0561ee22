//! Bounds of a tape's gradient over boxes.

use super::Tape;
use super::evaluate::{Domain, Machine};
use crate::graph::{FrameInputs, Interval, Op, Sloped};

struct Slopes<'a> {
    position: [Interval; 3],
    normal: [Interval; 3],
    frame: &'a FrameInputs,
}

impl Domain for Slopes<'_> {
    type Value = Sloped;
    type Entry = Interval;
    fn constant(&self, entry: Interval) -> Sloped {
        Sloped::flat(entry)
    }
    fn input(&self, place: usize) -> Sloped {
        match place {
            0..=2 => Sloped::coordinate(place, self.position[place]),
            _ => Sloped::flat(self.normal[place - 3]),
        }
    }
    fn unary(&mut self, op: Op, a: &Sloped) -> Sloped {
        Sloped::unary(op, a, self.frame)
    }
    fn binary(&mut self, op: Op, a: &Sloped, b: &Sloped) -> Sloped {
        Sloped::binary(op, a, b, self.frame)
    }
    fn texture(&mut self, _texture: u16, _channel: u8, _u: &Sloped, _v: &Sloped) -> Sloped {
        Sloped::flat(Interval::UNIT)
    }
}

/// Bounds a tape and its gradient by the position over boxes, within one frame. Textures count as flat, as for
/// [`super::GradientEvaluator`]; jumps have no slope (see [`Sloped`]).
#[derive(Debug, Clone)]
pub struct GradientIntervals<'a> {
    tape: &'a Tape,
    frame: &'a FrameInputs,
    machine: Machine<Sloped, Interval>,
    outputs: Vec<Sloped>,
}

impl<'a> GradientIntervals<'a> {
    /// An evaluator of the tape with a frame's inputs, or those of every frame ([`FrameInputs::any`]).
    pub fn new(tape: &'a Tape, frame: &'a FrameInputs) -> Self {
        let nothing = Sloped::flat(Interval::point(0.0));
        let machine = Machine::with_table(tape, tape.table_bounds(frame), nothing);
        Self { tape, frame, machine, outputs: vec![nothing; tape.outputs.len()] }
    }

    /// Bounds of the outputs and of their gradients over a box of positions and of normals.
    pub fn over(&mut self, position: [Interval; 3], normal: [Interval; 3]) -> &[Sloped] {
        let mut domain = Slopes { position, normal, frame: self.frame };
        self.machine.run(self.tape, &mut domain);
        for (bounds, &slot) in self.outputs.iter_mut().zip(&self.tape.outputs) {
            *bounds = self.machine.slots[usize::from(slot)];
        }
        &self.outputs
    }
}
