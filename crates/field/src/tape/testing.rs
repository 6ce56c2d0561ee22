//! Gradients at single points, and bounds of gradients over boxes, from tapes.

use super::evaluate::{Domain, Machine};
use super::{Dual, GradientBatch, Tape};
use crate::graph::{FrameInputs, GradientInterval, Interval, Op, Pieces};

impl GradientBatch<'_> {
    pub(crate) fn at(&mut self, position: [f32; 3]) -> Dual {
        let mut duals = Vec::new();
        self.run(&[position], &mut duals);
        duals[0]
    }
}

struct Slopes<'a> {
    position: [Interval; 3],
    normal: [Interval; 3],
    frame: &'a FrameInputs,
    jumps: Option<&'a mut Pieces>,
}

impl Domain for Slopes<'_> {
    type Value = GradientInterval;
    fn constant(&self, number: f32) -> GradientInterval {
        GradientInterval::flat(Interval::point(number))
    }
    fn input(&self, place: usize) -> GradientInterval {
        match place {
            0..=2 => GradientInterval::coordinate(place, self.position[place]),
            _ => GradientInterval::flat(self.normal[place - 3]),
        }
    }
    fn operator(&mut self, op: Op, a: &GradientInterval, b: &GradientInterval) -> GradientInterval {
        if let Some(jumps) = &mut self.jumps {
            jumps.add(GradientInterval::jump(op, a, b, self.position));
        }
        match op.arity() == 1 {
            true => GradientInterval::unary(op, a, self.frame),
            false => GradientInterval::binary(op, a, b, self.frame),
        }
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
/// constants. Jumps have no slope ([`GradientInterval`]).
#[derive(Debug, Clone)]
pub(crate) struct GradientIntervals<'a> {
    tape: &'a Tape,
    frame: &'a FrameInputs,
    machine: Machine<'a, GradientInterval>,
    outputs: Vec<GradientInterval>,
    pieces: Pieces,
}

impl<'a> GradientIntervals<'a> {
    /// Creates an evaluator for the inputs of one frame.
    pub(crate) fn new(tape: &'a Tape, frame: &'a FrameInputs) -> Self {
        let nothing = GradientInterval::flat(Interval::point(0.0));
        let machine = Machine::new(tape, frame, nothing);
        Self { tape, frame, machine, outputs: vec![nothing; tape.outputs.len()], pieces: Pieces::default() }
    }

    /// Returns bounds of the outputs and their gradients over a box, which is cut where parts of the tape jump.
    pub(crate) fn over(&mut self, position: [Interval; 3], normal: [Interval; 3]) -> &[GradientInterval] {
        let Self { tape, frame, machine, outputs, pieces } = self;
        pieces.clear();
        let mut domain = Slopes { position, normal, frame, jumps: Some(pieces) };
        machine.run(&mut domain);
        for (bounds, output) in outputs.iter_mut().zip(&tape.outputs) {
            *bounds = machine.output(*output, &domain);
        }
        for (number, &position) in pieces.of(position).iter().enumerate() {
            let mut domain = Slopes { position, normal, frame, jumps: None };
            machine.run(&mut domain);
            for (bounds, output) in outputs.iter_mut().zip(&tape.outputs) {
                let piece = machine.output(*output, &domain);
                // Keep the value's bounds in the whole box: the pieces leave out the jumps themselves.
                let value = bounds.value;
                *bounds = if number == 0 { piece } else { bounds.hull(&piece) };
                bounds.value = value;
            }
        }
        &self.outputs
    }
}
