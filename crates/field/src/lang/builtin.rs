//! The names that are built into the language: inputs, and functions that cannot be written in the language.
//!
//! All other functions are in the library, which is written in the language.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use super::shape::{ShapeCall, SongText};
use crate::graph::{Input, LevelList, MotionKind, Op, ScreenInput, SoundInput};

/// Declares and describes the inputs and the built-in functions, in the order of [`INPUTS`] and [`BUILTINS`].
pub(super) const BUILTIN_TEXT: &str = include_str!("library/builtin.txt");

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum InputValue {
    One(Input),
    Many(&'static [Input]),
    Constant(f32),
}

/// Sets of the inputs that an expression may use.
pub(super) mod uses {
    pub(crate) const POINT: u16 = 1;
    pub(crate) const NORMAL: u16 = 2;
    /// The direction of a ray that hits nothing.
    pub(crate) const DIRECTION: u16 = 4;
    pub(crate) const TEXTURE: u16 = 8;
    /// Time, sound and parameters.
    pub(crate) const FRAME: u16 = 16;
    pub(crate) const EYE: u16 = 32;
    /// The pixel that is drawn.
    pub(crate) const PIXEL: u16 = 64;
    /// The size of the picture, and the pointer over it.
    pub(crate) const SCREEN: u16 = 128;
    /// The number of a swarm's point.
    pub(crate) const INDEX: u16 = 256;
    pub(crate) const NOTHING: u16 = 0;
}

/// An input: its name, its value, its set in [`uses`], and its description on the language's page.
#[derive(Clone, Copy)]
pub(super) struct InputRow {
    pub name: &'static str,
    pub value: InputValue,
    pub uses: u16,
    pub doc: &'static str,
}

use InputValue::{Constant, Many, One};
use uses::{DIRECTION, EYE, FRAME, INDEX, NORMAL, NOTHING, PIXEL, POINT, SCREEN};

impl InputRow {
    /// True if a scene may declare a value of the same name, because scenes were written before the input existed.
    pub(super) fn may_be_hidden(&self) -> bool {
        let is_new = self.uses & (PIXEL | SCREEN | INDEX) != 0;
        is_new || matches!(self.value, One(input) if input.may_be_hidden())
    }
}

/// All inputs except numbers of the sound, each with its value and its set in [`uses`]. The direction is stored as the
/// normal, and the pixel and the index as the point, because no expression reads both.
const OTHERS: &[(&str, InputValue, u16)] = &[
    ("p", Many(&[Input::X, Input::Y, Input::Z]), POINT),
    ("x", One(Input::X), POINT),
    ("y", One(Input::Y), POINT),
    ("z", One(Input::Z), POINT),
    ("n", Many(&[Input::NX, Input::NY, Input::NZ]), NORMAL),
    ("direction", Many(&[Input::NX, Input::NY, Input::NZ]), DIRECTION),
    ("t", One(Input::T), FRAME),
    ("volume", Many(&[Input::Sound(SoundInput::VolumeLeft), Input::Sound(SoundInput::VolumeRight)]), FRAME),
    ("eye", Many(&[Input::EyeX, Input::EyeY, Input::EyeZ]), EYE),
    ("pixel", Many(&[Input::X, Input::Y]), PIXEL),
    ("resolution", Many(&[Input::Screen(ScreenInput::Width), Input::Screen(ScreenInput::Height)]), SCREEN),
    (
        "mouse",
        Many(&[
            Input::Screen(ScreenInput::MouseX),
            Input::Screen(ScreenInput::MouseY),
            Input::Screen(ScreenInput::MousePressed),
        ]),
        SCREEN,
    ),
    ("index", One(Input::X), INDEX),
    ("pi", Constant(std::f32::consts::PI), NOTHING),
    ("tau", Constant(std::f32::consts::TAU), NOTHING),
];

pub(super) static INPUTS: LazyLock<Vec<InputRow>> = LazyLock::new(|| {
    let described = BUILTIN_TEXT
        .lines()
        .zip(BUILTIN_TEXT.lines().skip(1))
        .filter_map(|(doc, declaration)| Some((declaration.strip_prefix("let ")?, doc.strip_prefix("## ")?)));
    let described: BTreeMap<&str, &str> = described.collect();
    let others = OTHERS.iter().map(|&(name, value, uses)| {
        let doc = described.get(name).copied().unwrap_or_default();
        InputRow { name, value, uses, doc }
    });
    let named = SoundInput::ALL.into_iter().filter(|input| !is_component(input.name()));
    let sounds = named.map(|input| {
        let value = One(Input::Sound(input));
        InputRow { name: input.name(), value, uses: FRAME, doc: input.doc() }
    });
    others.chain(sounds).collect()
});

/// True if scenes read a number of the sound as a component of a vector or by a function, not by its own name.
fn is_component(name: &str) -> bool {
    name.ends_with(')') || name.rfind('.').is_some_and(|point| point + 2 == name.len())
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Builtin {
    /// An operator on each component.
    Each(Op),
    /// An operator on the components of two vectors.
    Pair(Op),
    /// The first operator on each component of one vector, or the second one on the components of two vectors.
    OneOrTwo(Op, Op),
    /// A number or, of a condition, 0 or 1.
    Float,
    Pow,
    Mix,
    Clamp,
    Smoothstep,
    Length,
    Dot,
    Construct(u8),
    Levels(LevelList),
    /// A table of the sound, with one or two coordinates.
    Table(Op),
    Texture,
    /// A number with inertia.
    Motion(MotionKind),
    /// The light of the last frame.
    Previous,
    /// The 2D distance to a text or picture.
    Shape(ShapeCall),
    Matrix(MatrixFunction),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum MatrixFunction {
    Construct(u8),
    Transpose,
    Inverse,
    Determinant,
}

/// A function: name, meaning, and minimum and maximum number of arguments.
pub(super) struct BuiltinRow {
    pub name: &'static str,
    pub builtin: Builtin,
    pub arguments: (usize, usize),
}

impl BuiltinRow {
    /// Returns the name and the parameters, as the language's page shows them.
    pub(super) fn signature(&self) -> &'static str {
        let mut heads = BUILTIN_TEXT.lines().filter_map(|line| line.strip_prefix("fn "));
        heads.find(|head| head.split('(').next() == Some(self.name)).unwrap_or_default()
    }
}

const fn function(name: &'static str, builtin: Builtin, arguments: (usize, usize)) -> BuiltinRow {
    BuiltinRow { name, builtin, arguments }
}

const fn each(name: &'static str, op: Op) -> BuiltinRow {
    function(name, Builtin::Each(op), (1, 1))
}

const fn levels(list: LevelList) -> BuiltinRow {
    function(list.name(), Builtin::Levels(list), (1, 1))
}

use Builtin::{
    Clamp, Construct, Dot, Float, Length, Matrix, Mix, Motion, OneOrTwo, Pair, Pow, Previous, Shape,
    Smoothstep, Table, Texture,
};

pub(super) const BUILTINS: &[BuiltinRow] = &[
    each("abs", Op::Abs),
    each("sign", Op::Sign),
    each("floor", Op::Floor),
    each("ceil", Op::Ceil),
    function("round", OneOrTwo(Op::Round, Op::Sub), (1, 2)),
    each("trunc", Op::Trunc),
    each("fract", Op::Fract),
    each("sqrt", Op::Sqrt),
    each("exp", Op::Exp),
    each("exp2", Op::Exp2),
    each("log", Op::Log),
    each("log2", Op::Log2),
    each("sin", Op::Sin),
    each("cos", Op::Cos),
    each("tan", Op::Tan),
    each("asin", Op::Asin),
    each("acos", Op::Acos),
    each("sinh", Op::Sinh),
    each("cosh", Op::Cosh),
    each("tanh", Op::Tanh),
    function("atan", OneOrTwo(Op::Atan, Op::Atan2), (1, 2)),
    function("pow", Pow, (2, 2)),
    function("mod", Pair(Op::Mod), (2, 2)),
    function("min", Pair(Op::Min), (2, 2)),
    function("max", Pair(Op::Max), (2, 2)),
    function("sum", Pair(Op::Add), (2, 2)),
    function("product", Pair(Op::Mul), (2, 2)),
    function("step", Pair(Op::Step), (2, 2)),
    function("mix", Mix, (3, 3)),
    function("clamp", Clamp, (3, 3)),
    function("smoothstep", Smoothstep, (3, 3)),
    function("length", Length, (1, 1)),
    function("dot", Dot, (2, 2)),
    function("vec2", Construct(2), (1, 2)),
    function("vec3", Construct(3), (1, 3)),
    function("vec4", Construct(4), (1, 4)),
    function("mat2", Matrix(MatrixFunction::Construct(2)), (1, 4)),
    function("mat3", Matrix(MatrixFunction::Construct(3)), (1, 9)),
    function("transpose", Matrix(MatrixFunction::Transpose), (1, 1)),
    function("inverse", Matrix(MatrixFunction::Inverse), (1, 1)),
    function("determinant", Matrix(MatrixFunction::Determinant), (1, 1)),
    function("float", Float, (1, 1)),
    each("int", Op::Trunc),
    function("cell_hash", Pair(Op::Hash), (2, 2)),
    levels(LevelList::Band),
    levels(LevelList::Note),
    levels(LevelList::Chroma),
    levels(LevelList::Pan),
    levels(LevelList::Width),
    function("spectrum", Table(Op::Spectrum), (1, 1)),
    function("waveform", Table(Op::Waveform), (1, 1)),
    function("history", Table(Op::History), (2, 2)),
    function("follow", Motion(MotionKind::Follow), (2, 3)),
    function("spring", Motion(MotionKind::Spring), (2, 3)),
    function("since", Motion(MotionKind::Since), (1, 1)),
    function("texture", Texture, (2, 2)),
    function("previous", Previous, (1, 1)),
    function("text", Shape(ShapeCall::Text), (2, 3)),
    function("image", Shape(ShapeCall::Image), (2, 2)),
    function("title", Shape(ShapeCall::Song(SongText::Title)), (1, 2)),
    function("artist", Shape(ShapeCall::Song(SongText::Artist)), (1, 2)),
    function("lyrics", Shape(ShapeCall::Song(SongText::Lyrics)), (1, 2)),
];

/// Functions that combine any number of values: the name, and how many final arguments (a radius) are not values.
pub(super) const FOLDS: &[(&str, usize)] = &[
    ("min", 0),
    ("max", 0),
    ("sum", 0),
    ("product", 0),
    ("union", 0),
    ("intersect", 0),
    ("subtract", 0),
    ("smooth_union", 1),
    ("smooth_intersect", 1),
    ("smooth_subtract", 1),
    ("chamfer_union", 1),
];
