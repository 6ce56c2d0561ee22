//! Expressions built from bytes. All evaluators must give the same result, bit for bit.
//!
//! The generated GLSL cannot run on the CPU, so naga only validates it (`World::compiled_glsl`).
//! `tests/pictures/agreement.rs` checks that the GLSL gives the same values on drivers.

use mariana_field::graph::SoundInput;
use std::sync::Arc;

use mariana_field::graph::{
    FrameInputs, Graph, Input, Interval, Level, LevelList, Node, NodeId, Op, Point, TableData, TextureReader,
};
use mariana_field::lang;
use mariana_field::tape::{Batch, GradientBatch, PointEvaluator, Points, Tape};
use mariana_field::world::{World, WorldError};

use super::bytes::{Bytes, hash};
use super::random::Random;
use super::regions::{self, same};
use super::text;

/// Maximum number of steps in an expression.
const STEPS_MAX: usize = 600;

const BAND: Level = LevelList::Band.level(7).unwrap();

const INPUTS: [Input; 12] = [
    Input::X,
    Input::Y,
    Input::Z,
    Input::T,
    Input::Sound(SoundInput::VolumeLeft),
    Input::Level(BAND),
    Input::Sound(SoundInput::Bass),
    Input::Sound(SoundInput::Beat),
    Input::Sound(SoundInput::Phase),
    Input::NX,
    Input::NY,
    Input::NZ,
];

/// Operators that are frequent in shapes and that `Graph::fused` looks for.
const COMMON: [Op; 8] = [Op::Add, Op::Sub, Op::Abs, Op::Max, Op::Square, Op::Sqrt, Op::Mul, Op::Min];

/// Operators that only `Graph::fused` creates. Shapes here do not contain them: GLSL is generated from unfused graphs,
/// and naga would compute the square of a constant operand.
const FUSED: [Op; 7] = [
    Op::SquareDifference,
    Op::OutsideAdd,
    Op::AbsDifference,
    Op::Length,
    Op::SquareAdd,
    Op::AbsSub,
    Op::SqrtSub,
];

/// Returns an operand, which is an earlier node.
fn back(built: &[NodeId], byte: u8) -> Option<NodeId> {
    // Choose mostly recent nodes, so that results are used, and some old nodes, so that values must be kept.
    let distance = match byte {
        0..112 => usize::from(byte % 2),
        112..224 => usize::from(byte % 12),
        _ => usize::from(byte - 223) * 9,
    };
    built.len().checked_sub(1 + distance).and_then(|index| built.get(index)).copied()
}

/// The nodes that an expression may contain.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Any,
    /// A distance, which reads neither normals nor textures.
    Distance,
}

/// Builds nodes from bytes, and simplifies them if `simplify` is set. The same bytes give the same steps.
fn build(mut bytes: Bytes, graph: &mut Graph, kind: Kind, simplify: bool) -> Vec<NodeId> {
    let inputs = if kind == Kind::Any { &INPUTS[..] } else { &INPUTS[..9] };
    let mut built = Vec::new();
    while !bytes.0.is_empty() && built.len() < STEPS_MAX {
        let node = match bytes.next() {
            0..24 => Node::Constant(bytes.number()),
            choice @ 24..64 => Node::Input(inputs[usize::from(choice) % inputs.len()]),
            64..72 if kind == Kind::Any => {
                let (which, u, v) = (bytes.next(), back(&built, bytes.next()), back(&built, bytes.next()));
                let (Some(u), Some(v)) = (u, v) else { continue };
                Node::Texture { texture: u16::from(which / 4), channel: which % 4, u, v }
            }
            choice => {
                let ops = if choice < 168 { &COMMON[..] } else { Op::ALL };
                let op = ops[usize::from(choice) % ops.len()];
                let op = if kind == Kind::Distance && FUSED.contains(&op) { Op::Sub } else { op };
                let Some(a) = back(&built, bytes.next()) else { continue };
                if op.arity() == 1 {
                    Node::Unary(op, a)
                } else {
                    let Some(b) = back(&built, bytes.next()) else { continue };
                    Node::Binary(op, a, b)
                }
            }
        };
        built.push(match node {
            Node::Constant(value) if simplify => graph.constant(value),
            Node::Unary(op, a) if simplify => graph.unary(op, a),
            Node::Binary(op, a, b) if simplify => graph.binary(op, a, b),
            node => graph.raw(node),
        });
    }
    if built.is_empty() {
        built.push(graph.input(Input::X));
    }
    built
}

/// The settings of a test, which are read from the start of an input.
struct Head {
    roots: usize,
    points: [Point; 3],
    frame: FrameInputs,
}

impl Head {
    fn read(bytes: &mut Bytes) -> Self {
        let roots = 1 + bytes.below(13);
        let mut frame = super::random::frame();
        frame.time = bytes.number();
        frame.levels[BAND] = bytes.number();
        frame.sound[SoundInput::Bass] = bytes.number();
        frame.history =
            TableData::scrolling(vec![bytes.finite(), 1.0, -1.0, 0.5], 2, bytes.number(), bytes.number());
        frame.textures = Some(Arc::new(Stripes));
        let three = |bytes: &mut Bytes| std::array::from_fn(|_| bytes.number());
        let points = std::array::from_fn(|_| Point { position: three(bytes), normal: three(bytes) });
        Self { roots, points, frame }
    }
}

#[derive(Debug)]
struct Stripes;

impl TextureReader for Stripes {
    fn read(&self, texture: u16, channel: u8, u: f32, v: f32) -> f32 {
        (u * 3.0 + v * 5.0 + f32::from(texture) + f32::from(channel)).sin().abs()
    }
}

#[track_caller]
fn assert_same(found: &[f32], wanted: &[f32], what: &str) {
    assert_eq!(found.len(), wanted.len());
    for (place, (found, wanted)) in found.iter().zip(wanted).enumerate() {
        assert!(same(*found, *wanted), "{what}: output {place} is {found:?}, not {wanted:?}");
    }
}

/// Checks the evaluation of clauses.
pub(crate) fn tape(data: &[u8]) {
    let mut bytes = Bytes(data);
    let head = Head::read(&mut bytes);
    let mut graph = Graph::new();
    let built = build(bytes, &mut graph, Kind::Any, false);
    let roots: Vec<NodeId> = built.iter().rev().take(head.roots).copied().collect();
    check_tape(&graph, &roots, &Tape::new(&graph, &roots), &head);
}

fn check_tape(graph: &Graph, roots: &[NodeId], tape: &Tape, head: &Head) {
    let frame = &head.frame;
    let mut points = PointEvaluator::new(tape, frame);
    let mut rows: Vec<Vec<f32>> = Vec::new();
    for point in &head.points {
        let wanted = graph.evaluate(roots, point, frame);
        assert_same(points.at(point), &wanted, "tape");
        rows.push(wanted);
    }
    let columns: Vec<Vec<f32>> =
        (0..6).map(|place| head.points.iter().map(|p| p.inputs()[place]).collect()).collect();
    let [x, y, z, nx, ny, nz] = std::array::from_fn(|place| &columns[place][..]);
    let many = Points { position: [x, y, z], normal: Some([nx, ny, nz]) };
    for (place, values) in Batch::new(tape, frame).run(many).iter().enumerate() {
        let wanted: Vec<f32> = rows.iter().map(|row| row[place]).collect();
        assert_same(values, &wanted, "batch");
    }
}

/// Compares all evaluators of an expression: the raw, simplified and fused graph, tapes, batches, dual
/// numbers and intervals. Also tests region trees and naga with the expression as the shape of a scene.
pub(crate) fn differential(data: &[u8]) {
    let mut bytes = Bytes(data);
    let head = Head::read(&mut bytes);
    let rest = bytes.0;
    let (mut raw, mut graph) = (Graph::new(), Graph::new());
    let plain = build(Bytes(rest), &mut raw, Kind::Any, false);
    let simple = build(Bytes(rest), &mut graph, Kind::Any, true);
    let last = |built: &[NodeId]| built.iter().rev().take(head.roots.min(4)).copied().collect::<Vec<_>>();
    let (plain, simple) = (last(&plain), last(&simple));
    let mut short = simple.clone();
    let fused = graph.fused(&mut short);
    let frame = &head.frame;
    let [tape, _] = [(&graph, &simple), (&fused, &short)].map(|(graph, roots)| {
        let tape = Tape::new(graph, roots);
        check_tape(graph, roots, &tape, &head);
        tape
    });
    for point in &head.points {
        let wanted = raw.evaluate(&plain, point, frame);
        assert_same(&graph.evaluate(&simple, point, frame), &wanted, "simplified graph");
        assert_same(&fused.evaluate(&short, point, frame), &wanted, "fused graph");
        let (mut duals, [x, y, z]) = (Vec::new(), point.position);
        GradientBatch::new(&tape, frame).run(&[point.position], &mut duals);
        let duals: Vec<f32> = duals.iter().map(|dual| dual.value).collect();
        let first = raw.evaluate(plain.get(..1).unwrap_or_default(), &Point::at(x, y, z), frame);
        assert_same(&duals, &first, "dual numbers");
        // Widen each input to an interval around its value at the point.
        let wide = |value: f32, by: f32| Interval::new(value - by, value + by);
        for by in [0.0, 0.25, 1e10] {
            let around = point.inputs().map(|value| wide(value, by));
            for (graph, roots) in [(&graph, &simple), (&fused, &short)] {
                for (root, wanted) in roots.iter().zip(&wanted) {
                    let bounds = graph.bounds(*root, around, frame);
                    assert!(
                        bounds.contains(*wanted),
                        "{wanted:?} is not within {bounds:?}, {by} around {point:?}"
                    );
                }
            }
        }
    }
    shape(rest, hash(data));
}

/// Checks the expression as the shape of a scene.
fn shape(steps: &[u8], seed: u64) {
    let mut scene = lang::compile("fuzz", "x", &mut lang::no_includes).scene.unwrap();
    let built = build(Bytes(steps), &mut scene.graph, Kind::Distance, true);
    let root = built[built.len() - 1];
    scene.distance = root;
    scene.objects[0].shape = root;
    let world = World::new("fuzz", scene, Vec::new()).unwrap();
    if let Err(error @ WorldError::Refused { .. }) = world.compiled_glsl() {
        panic!("{error}");
    }
    let mut random = Random(seed);
    let inputs = text::frame_of(&world, &mut random);
    regions::check(&world, &inputs, &mut random);
}
