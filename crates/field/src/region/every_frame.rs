//! Bounds a distance in 64 boxes at once, for all sounds, times and parameters, and shortens its program for the boxes
//! that may contain a surface. The search for the box around a scene (`world::bounds`) thus runs shorter programs in
//! smaller boxes, as in Keeter, "Massively parallel rendering of complex closed-form implicit surfaces" (2020).
//!
//! What depends only on the frame is bounded once. It is an input of the program, like a coordinate.

use std::rc::Rc;

use super::lanes::{CELLS, Lanes, bound, mask};
use super::linear::Linear;
use super::program::{Arg, BOUND, Program, Structure};
use super::prune::{ChoiceTrace, Scratch};
use super::tree::cells_of;
use crate::graph::{FrameInputs, Graph, GraphError, Interval, Node, NodeId, Op};

/// Programs with at most this many steps are not shortened, because that would take longer than it saves.
const SHORT_ENOUGH: usize = 16;
const COORDINATES: usize = 3;
/// Values of textures.
const SAMPLED: Interval = Interval::UNIT;

/// A box: its extent along each axis.
pub(crate) type Box3 = [Interval; 3];

/// A program that gives the distance in some boxes.
#[derive(Debug)]
pub(crate) struct BoxProgram(Program);

impl BoxProgram {
    /// Number of steps.
    pub(crate) fn len(&self) -> usize {
        self.0.steps.len()
    }
}

/// Runs the programs of one distance.
#[derive(Debug)]
pub(crate) struct EveryFrame<'a> {
    any: &'a FrameInputs,
    /// Begins with the coordinates and with the bounds of the frame's values.
    rows: Vec<Lanes>,
    structure: Structure,
    decisions: ChoiceTrace,
    scratch: Scratch,
}

impl<'a> EveryFrame<'a> {
    /// Returns the program of a distance in all frames of `any` ([`FrameInputs::any`]).
    ///
    /// # Errors
    /// Fails if the graph has too many nodes.
    pub(crate) fn new(
        graph: &Graph,
        distance: NodeId,
        any: &'a FrameInputs,
    ) -> Result<(Self, Rc<BoxProgram>), GraphError> {
        let nodes = graph.order(&[distance])?.nodes;
        let of_frame = frame_bounds(graph, &nodes, any);
        let mut rows = vec![Lanes::splat(Interval::point(0.0)); COORDINATES];
        let mut places: Vec<Option<Arg>> = vec![None; graph.len()];
        for id in &nodes {
            if let Some(bounds) = of_frame[id.index()] {
                let place = if bounds.lo == bounds.hi {
                    Arg::Number(bounds.lo + 0.0)
                } else {
                    rows.push(Lanes::splat(bounds));
                    Arg::Value((rows.len() - 1) as u32)
                };
                places[id.index()] = Some(place);
            }
        }
        let forms = Linear::all(graph, &nodes, distance);
        let of_forms = rows.len();
        rows.extend(forms.iter().flatten().flat_map(Linear::intervals).map(Lanes::splat));
        let inputs = rows.len();
        let mut program = Program { inputs, in_registers: inputs, ..Program::default() };
        let starts = (of_forms as u32..).step_by(4);
        for (form, start) in forms.iter().enumerate().filter(|(_, form)| form.is_some()).zip(starts) {
            let scaled = |program: &mut Program, axis: u32| {
                program.push(Op::Mul, Arg::Value(axis), Arg::Value(start + axis), any)
            };
            let mut sum = scaled(&mut program, 0);
            for axis in 1..COORDINATES as u32 {
                let term = scaled(&mut program, axis);
                sum = program.push(Op::Add, sum, term, any);
            }
            places[form.0] = Some(program.push(Op::Add, sum, Arg::Value(start + 3), any));
        }
        for id in &nodes {
            let at = |id: NodeId| places[id.index()].unwrap_or(Arg::Number(f32::NAN));
            let place = match graph.node(*id) {
                _ if of_frame[id.index()].is_some() || forms[id.index()].is_some() => continue,
                Node::Input(input) => match input.of_point() {
                    Some(axis) if axis < COORDINATES => Arg::Value(axis as u32),
                    // There is no penumbra.
                    _ => Arg::Number(0.0),
                },
                Node::Unary(op, a) => program.push(op, at(a), Arg::Number(0.0), any),
                Node::Binary(op, a, b) => program.push(op, at(a), at(b), any),
                Node::Constant(_) | Node::Texture { .. } => continue,
            };
            places[id.index()] = Some(place);
        }
        let root = places[distance.index()].unwrap_or(Arg::Number(f32::NAN));
        program.roots = vec![root, root, Arg::Number(0.0)];
        let (structure, decisions, scratch) = Default::default();
        Ok((Self { any, rows, structure, decisions, scratch }, Rc::new(BoxProgram(program))))
    }

    /// Returns the boxes that may contain a surface or a solid, as a mask. If there are fewer than 64 boxes, the last
    /// one is repeated.
    pub(crate) fn open(&mut self, BoxProgram(program): &BoxProgram, boxes: &[Box3]) -> u64 {
        let Some(last) = boxes.len().checked_sub(1) else { return 0 };
        for (axis, row) in self.rows.iter_mut().take(COORDINATES).enumerate() {
            for lane in 0..CELLS {
                let side = boxes[lane.min(last)][axis];
                (row.lo[lane], row.hi[lane]) = (side.lo, side.hi);
            }
        }
        bound(program, &mut self.rows, self.any);
        // A NaN may stand for a surface.
        !match program.roots[BOUND] {
            Arg::Value(value) => mask(|lane| self.rows[value as usize].lo[lane] > 0.0),
            Arg::Number(number) => mask(|_| number > 0.0),
        }
    }

    /// Returns a common program for some of the boxes that [`EveryFrame::open`] has just bounded.
    pub(crate) fn shortened(&mut self, program: &Rc<BoxProgram>, boxes: u64) -> Rc<BoxProgram> {
        if boxes == 0 || program.len() <= SHORT_ENOUGH {
            return program.clone();
        }
        self.decide(program, boxes, &[boxes]);
        self.program_of(program, boxes)
    }

    /// Like [`EveryFrame::shortened`], but returns a program for each box.
    pub(crate) fn shortened_each(&mut self, program: &BoxProgram, boxes: u64) -> Vec<Rc<BoxProgram>> {
        self.decide(program, boxes, &[]);
        cells_of(boxes).map(|lane| self.program_of(program, 1 << lane)).collect()
    }

    fn decide(&mut self, BoxProgram(program): &BoxProgram, boxes: u64, together: &[u64]) {
        self.structure.look_at(program);
        self.decisions.decide(program, &self.structure, &self.rows, [boxes, 0], together);
    }

    fn program_of(&mut self, BoxProgram(program): &BoxProgram, boxes: u64) -> Rc<BoxProgram> {
        let mut short = Program::default();
        self.decisions.shortened(program, &self.rows, (boxes, true), self.any, &mut self.scratch, &mut short);
        Rc::new(BoxProgram(short))
    }
}

/// Returns the bounds of the nodes that do not depend on the point.
fn frame_bounds(graph: &Graph, nodes: &[NodeId], any: &FrameInputs) -> Vec<Option<Interval>> {
    let mut bounds: Vec<Option<Interval>> = vec![None; graph.len()];
    for id in nodes {
        let at = |id: NodeId| bounds[id.index()];
        bounds[id.index()] = match graph.node(*id) {
            Node::Constant(value) => Some(Interval::point(value)),
            Node::Input(input) => input.of_point().is_none().then(|| any.bounds(input)),
            Node::Unary(op, a) => at(a).map(|a| op.bounds(a, a, any)),
            Node::Binary(op, a, b) => at(a).zip(at(b)).map(|(a, b)| op.bounds(a, b, any)),
            Node::Texture { .. } => Some(SAMPLED),
        };
    }
    bounds
}
