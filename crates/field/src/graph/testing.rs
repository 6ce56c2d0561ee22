//! Random expressions for property tests.

use super::{Levels, Screen, ScreenInput, SoundInput, SoundInputs};
use std::sync::{Arc, LazyLock};

use proptest::prelude::*;

use super::{
    AtlasShape, FrameInputs, Graph, Input, Node, NodeId, Op, PartInput, ShapeAtlas, ShapeGrid, TableData,
    TextureReader,
};

pub(crate) const SPECIALS: [f32; 24] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    -0.5,
    2.0,
    -3.0,
    31.5,
    0.49999997,
    16_777_216.0,
    8_388_609.0,
    -8_388_609.0,
    1e-20,
    -1e-20,
    1e20,
    f32::MIN_POSITIVE,
    1e-45,
    f32::MAX,
    f32::MIN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
    std::f32::consts::PI,
];

#[derive(Debug, Clone, Copy)]
pub(crate) enum Step {
    Constant(f32),
    Input(u8),
    /// The number of an operator, and its operands: earlier steps, counted backwards from this step.
    Operator(u8, u16, u16),
    Texture(u16, u16),
}

pub(crate) fn number() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => -10.0f32..10.0,
        1 => (-20i32..20).prop_map(|whole| whole as f32 / 2.0),
        2 => proptest::sample::select(&SPECIALS[..]),
        1 => any::<u32>().prop_map(f32::from_bits),
    ]
}

pub(crate) fn steps(size: usize) -> impl Strategy<Value = Vec<Step>> {
    let step = prop_oneof![
        2 => number().prop_map(Step::Constant),
        3 => any::<u8>().prop_map(Step::Input),
        12 => (any::<u8>(), 0u16..12, 0u16..12).prop_map(|(op, a, b)| Step::Operator(op, a, b)),
        1 => (0u16..12, 0u16..12).prop_map(|(u, v)| Step::Texture(u, v)),
    ];
    proptest::collection::vec(step, 1..size)
}

const INPUTS: [Input; 13] = [
    Input::X,
    Input::Y,
    Input::Z,
    Input::NX,
    Input::NY,
    Input::NZ,
    Input::T,
    Input::Sound(SoundInput::VolumeLeft),
    Input::Sound(SoundInput::Bass),
    Input::Param(1),
    Input::Sound(SoundInput::Beat),
    Input::Screen(ScreenInput::MouseY),
    Input::X,
];

/// Builds the steps, with or without simplification. The last step is the root.
pub(crate) fn build(graph: &mut Graph, steps: &[Step], simplify: bool) -> Vec<NodeId> {
    let mut built: Vec<NodeId> = Vec::new();
    for &step in steps {
        let back =
            |distance: u16| built.len().checked_sub(1 + usize::from(distance)).map(|index| built[index]);
        let fallback = Node::Input(Input::X);
        let node = match step {
            Step::Constant(value) => Node::Constant(value),
            Step::Input(number) => Node::Input(INPUTS[usize::from(number) % INPUTS.len()]),
            Step::Operator(number, a, b) => {
                let op = Op::ALL[usize::from(number) % Op::ALL.len()];
                match (back(a), back(b), op.arity()) {
                    (Some(a), _, 1) => Node::Unary(op, a),
                    (Some(a), Some(b), 2) => Node::Binary(op, a, b),
                    _ => fallback,
                }
            }
            Step::Texture(u, v) => match (back(u), back(v)) {
                (Some(first), Some(second)) => {
                    Node::Texture { texture: u % 3, channel: v as u8 % 4, u: first, v: second }
                }
                _ => fallback,
            },
        };
        built.push(match node {
            Node::Constant(value) if simplify => graph.constant(value),
            Node::Unary(op, a) if simplify => graph.unary(op, a),
            Node::Binary(op, a, b) if simplify => graph.binary(op, a, b),
            node => graph.raw(node),
        });
    }
    built
}

#[derive(Debug)]
struct Stripes;

impl TextureReader for Stripes {
    fn read(&self, texture: u16, channel: u8, u: f32, v: f32) -> f32 {
        (u * 3.0 + v * 5.0 + f32::from(texture) + f32::from(channel)).sin().abs()
    }
}

static SHAPES: LazyLock<ShapeAtlas> = LazyLock::new(shapes);

/// Two discs, the second of which may change.
fn shapes() -> ShapeAtlas {
    let disc = |(columns, rows): (usize, usize), per_unit: f32, radius: f32| {
        let distance = |at: usize| {
            let (x, y) = ((at % columns) as f32, (at / columns) as f32);
            let off = |at: f32, count: usize| (at - 0.5 * (count - 1) as f32) / per_unit;
            off(x, columns).hypot(off(y, rows)) - radius
        };
        let values: Vec<f32> = (0..columns * rows).map(distance).collect();
        let grid = ShapeGrid::new(values, columns, per_unit).unwrap();
        assert!(grid.steepest() < 1.5);
        // The tips of cones are steeper in bilinear patches.
        let values: Vec<f32> = grid.values().iter().map(|value| value / grid.steepest().max(1.0)).collect();
        ShapeGrid::new(values, columns, per_unit).unwrap()
    };
    let shapes = [((24, 17), 4.0, 1.0), ((31, 40), 1.5, 7.0)].into_iter().enumerate();
    ShapeAtlas::new(
        shapes
            .map(|(number, (size, per_unit, radius))| AtlasShape {
                grid: disc(size, per_unit, radius),
                changes: number == 1,
            })
            .collect(),
    )
    .unwrap()
}

pub(crate) fn frame() -> FrameInputs {
    let wave = |count: usize, step: f32| (0..count).map(|i| (i as f32 * step).sin()).collect::<Vec<_>>();
    FrameInputs {
        ranges: None,
        motions: Vec::new(),
        hoisted: Vec::new(),
        time: 12.5,
        sound: SoundInputs::each(|input| match input {
            SoundInput::VolumeRight | SoundInput::Phase => 0.75,
            SoundInput::Beat => 0.0,
            SoundInput::Tempo => 120.0,
            SoundInput::BassDrive => 1.5,
            _ => (input as u8 as f32 + 1.0) / 16.0,
        }),
        levels: Levels::each(|list, i| (list as u8 as f32 + i as f32 * 0.7).cos() * 0.5),
        parts: (0..PartInput::COUNT).map(|i| (i as f32 * 0.37).cos().abs()).collect(),
        eye: [1.5, 2.0, -4.0],
        screen: Screen { size: [64.0, 36.0], pointer: [0.25, 0.75], pressed: true },
        params: vec![1.0, -2.5],
        spectrum: TableData::row(wave(64, 0.3)),
        waveform: TableData::row(wave(50, 1.1)),
        history: TableData::scrolling(wave(9 * 16, 0.9), 16, 0.375, 6.5),
        textures: Some(Arc::new(Stripes)),
        shapes: SHAPES.clone(),
    }
}

pub(crate) fn same(a: f32, b: f32) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}
