//! Bounds a distance in 64 boxes at once, for all sounds, times and parameters, and shortens its program for the boxes
//! that may contain a surface. The search for the box around a scene (`world::bounds`) thus runs shorter programs in
//! smaller boxes, as in Keeter, "Massively parallel rendering of complex closed-form implicit surfaces" (2020).
//!
//! Values that depend only on the frame are bounded once. They are inputs of the program, like coordinates.

use std::rc::Rc;

use super::gradient::Linear;
use super::lanes::{CELLS, Lanes, bound, bounds_of};
use super::program::{Arg, BOUND, Program, Structure};
use super::prune::{ChoiceTrace, Scratch, decide, of_distance};
use crate::bounds::Bounds;
use crate::graph::{FrameInputs, Graph, Interval, Node, NodeId, Op};

pub(crate) use super::lanes::{cells_of, mask};

/// Programs with at most this many steps are not shortened, because that would take longer than it saves.
const SHORT_ENOUGH: usize = 16;
/// A program that has more than this fraction of the steps is hardly shorter.
const HARDLY_SHORTER: f32 = 0.9;
const COORDINATES: usize = 3;
/// Values of textures.
const SAMPLED: Interval = Interval::UNIT;

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
    /// Lower bounds of the distance in the boxes that have just been bounded.
    low: [f32; CELLS],
}

impl<'a> EveryFrame<'a> {
    /// Returns the program of a distance in all frames of `any` ([`FrameInputs::any`]).
    pub(crate) fn new(graph: &Graph, distance: NodeId, any: &'a FrameInputs) -> (Self, Rc<BoxProgram>) {
        let nodes = graph.order(&[distance]);
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
        (
            Self { any, rows, structure, decisions, scratch, low: [f32::NAN; CELLS] },
            Rc::new(BoxProgram(program)),
        )
    }

    /// Returns the boxes that may contain a surface or a solid, as a mask. If there are fewer than 64 boxes, the last
    /// one is repeated.
    pub(crate) fn open(&mut self, BoxProgram(program): &BoxProgram, boxes: &[Bounds]) -> u64 {
        let Some(last) = boxes.len().checked_sub(1) else { return 0 };
        for (axis, row) in self.rows.iter_mut().take(COORDINATES).enumerate() {
            for lane in 0..CELLS {
                let sides = &boxes[lane.min(last)];
                (row.lo[lane], row.hi[lane]) = (sides.low[axis], sides.high[axis]);
            }
        }
        bound(program, &mut self.rows, self.any);
        self.low = bounds_of(program, BOUND, &self.rows).lo;
        // A lower bound of NaN says nothing, so such a box may contain a surface.
        !mask(|lane| self.low[lane] > 0.0)
    }

    /// Returns the lower bound of the distance in a box that has just been bounded.
    pub(crate) fn low(&self, lane: usize) -> f32 {
        self.low[lane]
    }

    /// Returns a common program for some of the boxes that [`EveryFrame::open`] has just bounded.
    pub(crate) fn shortened_together(&mut self, program: &Rc<BoxProgram>, boxes: u64) -> Rc<BoxProgram> {
        if boxes == 0 {
            return program.clone();
        }
        self.decide(program, boxes, &[boxes]);
        self.shortened(program, boxes)
    }

    /// Decides which steps each group of boxes that [`EveryFrame::open`] has just bounded needs.
    pub(crate) fn decide(&mut self, BoxProgram(program): &BoxProgram, boxes: u64, groups: &[u64]) {
        if program.steps.len() > SHORT_ENOUGH {
            self.structure.analyse(program);
            let roots = of_distance(boxes, 0);
            decide(&mut self.decisions, program, &self.structure, &self.rows, &roots, groups);
        }
    }

    /// Returns a program for a group of boxes that [`EveryFrame::decide`] has decided for; the whole program if the
    /// other one is hardly shorter.
    pub(crate) fn shortened(&mut self, whole: &Rc<BoxProgram>, boxes: u64) -> Rc<BoxProgram> {
        let program = &whole.0;
        if program.steps.len() <= SHORT_ENOUGH {
            return whole.clone();
        }
        let mut short = Program::default();
        self.decisions.shortened(program, &self.rows, boxes, self.any, &mut self.scratch, &mut short);
        if short.steps.len() as f32 > HARDLY_SHORTER * program.steps.len() as f32 {
            whole.clone()
        } else {
            Rc::new(BoxProgram(short))
        }
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::graph::{Levels, Point, TableData, testing};

    const SIDE: usize = 4;

    /// Divides a box into 4x4x4 boxes.
    fn parts(sides: &Bounds) -> Vec<Bounds> {
        let part = |lane: usize| {
            let place = [lane % SIDE, lane / SIDE % SIDE, lane / (SIDE * SIDE)];
            let at = |axis: usize, place: usize| {
                sides.low[axis] + (sides.high[axis] - sides.low[axis]) * (place as f32 / SIDE as f32)
            };
            let corner = |upper: usize| std::array::from_fn(|axis| at(axis, place[axis] + upper));
            Bounds { low: corner(0), high: corner(1) }
        };
        (0..CELLS).map(part).collect()
    }

    /// Returns the lower corner, the middle and the upper corner.
    fn points(sides: &Bounds) -> [Point; 3] {
        [0.0, 0.5, 1.0].map(|along| {
            let [x, y, z] = [0, 1, 2].map(|axis| {
                let (low, high) = (sides.low[axis], sides.high[axis]);
                (low + along * (high - low)).clamp(low, high)
            });
            Point::at(x, y, z)
        })
    }

    /// Returns a frame whose values are all in the ranges of [`FrameInputs::any`].
    fn frame() -> FrameInputs {
        let frame = testing::frame();
        let spectrum: Vec<f32> = frame.spectrum.values().iter().map(|value| value.abs()).collect();
        FrameInputs {
            levels: Levels::each(|list, number| frame.levels.of(list)[number].abs()),
            spectrum: TableData::row(spectrum),
            history: TableData::EMPTY,
            ..frame
        }
    }

    fn assert_open_boxes_are_kept(graph: &Graph, root: NodeId, sides: &Bounds) {
        let frame = frame();
        let any = FrameInputs::any(graph.ranges([(0.0, 2.0), (-3.0, 0.0)]), &frame.shapes);
        let (mut search, whole) = EveryFrame::new(graph, root, &any);
        let is_kept = |open: u64, boxes: &[Bounds]| {
            for (lane, sides) in boxes.iter().enumerate() {
                for point in points(sides) {
                    let value = graph.evaluate(&[root], &point, &frame)[0];
                    let is_open = open >> lane & 1 == 1;
                    assert!(is_open || value > 0.0, "{value} in a box without a surface, {sides:?}");
                }
            }
        };
        let boxes = parts(sides);
        let open = search.open(&whole, &boxes);
        is_kept(open, &boxes);
        let shared = search.shortened_together(&whole, open);
        search.decide(&whole, open, &[]);
        let own: Vec<_> = cells_of(open).map(|lane| search.shortened(&whole, 1 << lane)).collect();
        for (lane, own) in cells_of(open).zip(own).step_by(7) {
            let boxes = parts(&boxes[lane]);
            for program in [&own, &shared] {
                let open = search.open(program, &boxes);
                is_kept(open, &boxes);
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(192))]
        #[test]
        fn no_box_with_a_surface_is_dropped(
            steps in testing::steps(60),
            corner in prop::array::uniform3(-8.0f32..8.0),
            side in 0.01f32..12.0,
        ) {
            let mut graph = Graph::new();
            let root = testing::build(&mut graph, &steps, true).last().copied().unwrap();
            assert_open_boxes_are_kept(&graph, root, &Bounds { low: corner, high: corner.map(|low| low + side) });
        }

        #[test]
        fn linear_forms_bound_the_sums_that_they_replace(
            terms in prop::collection::vec((0usize..3, -3.0f32..3.0, -3.0f32..3.0), 2..12),
            corner in prop::array::uniform3(-1e4f32..1e4),
            side in 1e-4f32..1.0,
        ) {
            let mut graph = Graph::new();
            let mut sum = graph.constant(0.0);
            for (axis, offset, factor) in &terms {
                let coordinate = graph.input(crate::graph::Input::OF_POINT[*axis]);
                let (offset, factor) = (graph.constant(*offset), graph.constant(*factor));
                let term = graph.sub(coordinate, offset);
                let term = graph.mul(term, factor);
                sum = graph.add(sum, term);
            }
            // The value is 0 at the corner, as computed, and near 0 in the whole box.
            let [x, y, z] = corner;
            let at_corner = graph.evaluate(&[sum], &Point::at(x, y, z), &frame())[0];
            let at_corner = graph.constant(at_corner);
            let difference = graph.sub(sum, at_corner);
            let root = graph.unary(Op::Abs, difference);
            assert_open_boxes_are_kept(&graph, root, &Bounds { low: corner, high: corner.map(|low| low + side) });
        }
    }
}
