//! Bounds of a tape's gradient over boxes.

use super::Tape;
use super::evaluate::{Domain, Machine};
use crate::graph::{FrameInputs, Interval, Op, Pieces, Sloped};

struct Slopes<'a> {
    position: [Interval; 3],
    normal: [Interval; 3],
    frame: &'a FrameInputs,
    jumps: Option<&'a mut Pieces>,
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
        if let Some(jumps) = &mut self.jumps {
            jumps.add(Sloped::jump(op, a, self.position));
        }
        Sloped::unary(op, a, self.frame)
    }
    fn binary(&mut self, op: Op, a: &Sloped, b: &Sloped) -> Sloped {
        if let Some(jumps) = &mut self.jumps {
            jumps.add(Sloped::jump_of_two(op, a, b, self.position));
        }
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
    pieces: Pieces,
}

impl<'a> GradientIntervals<'a> {
    /// An evaluator of the tape with a frame's inputs, or those of every frame ([`FrameInputs::any`]).
    pub fn new(tape: &'a Tape, frame: &'a FrameInputs) -> Self {
        let nothing = Sloped::flat(Interval::point(0.0));
        let machine = Machine::with_table(tape, tape.table_bounds(frame), nothing);
        Self { tape, frame, machine, outputs: vec![nothing; tape.outputs.len()], pieces: Pieces::default() }
    }

    /// Bounds of the outputs and of their gradients over a box of positions and of normals. The box is cut where parts of
    /// the tape jump.
    pub fn over(&mut self, position: [Interval; 3], normal: [Interval; 3]) -> &[Sloped] {
        let Self { tape, frame, machine, outputs, pieces } = self;
        pieces.clear();
        machine.run(tape, &mut Slopes { position, normal, frame, jumps: Some(pieces) });
        for (bounds, &slot) in outputs.iter_mut().zip(&tape.outputs) {
            *bounds = machine.slots[usize::from(slot)];
        }
        for (number, &position) in pieces.of(position).iter().enumerate() {
            machine.run(tape, &mut Slopes { position, normal, frame, jumps: None });
            for (bounds, &slot) in outputs.iter_mut().zip(&tape.outputs) {
                let piece = machine.slots[usize::from(slot)];
                // The value is that of the whole box: the jumps themselves are in no piece.
                let value = bounds.value;
                *bounds = if number == 0 { piece } else { bounds.hull(&piece) };
                bounds.value = value;
            }
        }
        &self.outputs
    }
}
