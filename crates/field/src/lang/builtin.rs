//! The names that are built into the language: inputs, and functions that cannot be written in the language.
//!
//! All other functions are in the library, which is written in the language.

use super::shape::{ShapeCall, SongText};
use crate::graph::{Input, LevelList, MotionKind, Op, ScreenInput, SoundInput};

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

const fn row(name: &'static str, value: InputValue, uses: u16, doc: &'static str) -> InputRow {
    InputRow { name, value, uses, doc }
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

/// All inputs except numbers of the sound. The direction is stored as the normal, and the pixel and the index as the
/// point, because no expression reads both.
const OTHERS: &[InputRow] = &[
    row("p", Many(&[Input::X, Input::Y, Input::Z]), POINT, "the point in space"),
    row("x", One(Input::X), POINT, "p.x, to the right"),
    row("y", One(Input::Y), POINT, "p.y, up"),
    row("z", One(Input::Z), POINT, "p.z, forward: away from the default camera"),
    row(
        "n",
        Many(&[Input::NX, Input::NY, Input::NZ]),
        NORMAL,
        "the surface's normal, of length 1; in materials",
    ),
    row(
        "direction",
        Many(&[Input::NX, Input::NY, Input::NZ]),
        DIRECTION,
        "the direction of a ray that hits nothing, of length 1; in the sky",
    ),
    row("t", One(Input::T), FRAME, "time in seconds"),
    row(
        "volume",
        Many(&[Input::Sound(SoundInput::VolumeLeft), Input::Sound(SoundInput::VolumeRight)]),
        FRAME,
        "left and right volume, vec2, 0..1: the mean of abs(sample)",
    ),
    row(
        "eye",
        Many(&[Input::EyeX, Input::EyeY, Input::EyeZ]),
        EYE,
        "the position of the camera in use; in materials and the sky",
    ),
    row(
        "pixel",
        Many(&[Input::X, Input::Y]),
        PIXEL,
        "the place in the picture in pixels, vec2, from the lower left corner; in the sky's colour and in `warp`",
    ),
    row(
        "resolution",
        Many(&[Input::Screen(ScreenInput::Width), Input::Screen(ScreenInput::Height)]),
        SCREEN,
        "width and height of the picture in pixels, vec2; in the sky's colour and in `picture`",
    ),
    row(
        "mouse",
        Many(&[
            Input::Screen(ScreenInput::MouseX),
            Input::Screen(ScreenInput::MouseY),
            Input::Screen(ScreenInput::MousePressed),
        ]),
        SCREEN,
        "the pointer in pixels from the lower left corner, and 1 while its button is held, vec3; the centre in stills \
         and videos; in the sky's colour and in `picture`",
    ),
    row("index", One(Input::X), INDEX, "the number of a point, from 0 to `count` - 1; in swarms"),
    row("pi", Constant(std::f32::consts::PI), NOTHING, "half a turn in radians"),
    row("tau", Constant(std::f32::consts::TAU), NOTHING, "a full turn in radians"),
];

pub(super) const INPUTS: &[InputRow] = &{
    let mut rows = [const { row("", Constant(0.0), NOTHING, "") }; OTHERS.len() + named_sounds()];
    let mut at = 0;
    while at < OTHERS.len() {
        rows[at] = OTHERS[at];
        at += 1;
    }
    let mut number = 0;
    while number < SoundInput::ALL.len() {
        let input = SoundInput::ALL[number];
        if !is_component(input) {
            rows[at] = row(input.name(), One(Input::Sound(input)), FRAME, input.doc());
            at += 1;
        }
        number += 1;
    }
    rows
};

/// True if scenes read the number as a component of a vector or by a function, not by its own name.
const fn is_component(input: SoundInput) -> bool {
    let name = input.name().as_bytes();
    name.len() > 2 && (name[name.len() - 2] == b'.' || name[name.len() - 1] == b')')
}

const fn named_sounds() -> usize {
    let (mut count, mut number) = (0, 0);
    while number < SoundInput::ALL.len() {
        count += !is_component(SoundInput::ALL[number]) as usize;
        number += 1;
    }
    count
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Three {
    Mix,
    Clamp,
    Smoothstep,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Builtin {
    /// An operator on each component.
    Each(Op),
    /// An operator on the components of two vectors.
    Pair(Op),
    Atan,
    /// Rounds a number, or the edges of a shape.
    Round,
    /// A number or, of a condition, 0 or 1.
    Float,
    Pow,
    Three(Three),
    Length,
    Dot,
    Construct(u8),
    Levels(LevelList),
    Table(Op),
    History,
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

/// A function: name, parameters on the language's page, meaning, minimum and maximum number of arguments, and
/// description.
pub(super) struct BuiltinRow {
    pub name: &'static str,
    pub parameters: &'static str,
    pub builtin: Builtin,
    pub arguments: (usize, usize),
    pub doc: &'static str,
}

const fn function(
    name: &'static str,
    parameters: &'static str,
    builtin: Builtin,
    arguments: (usize, usize),
    doc: &'static str,
) -> BuiltinRow {
    BuiltinRow { name, parameters, builtin, arguments, doc }
}

const fn each(name: &'static str, op: Op, doc: &'static str) -> BuiltinRow {
    function(name, "a", Builtin::Each(op), (1, 1), doc)
}

const fn levels(list: LevelList) -> BuiltinRow {
    function(list.name(), "i", Builtin::Levels(list), (1, 1), list.doc())
}

use Builtin::{
    Atan, Construct, Dot, History, Length, Matrix, Motion, Pair, Pow, Previous, Round, Table, Texture,
};

pub(super) const BUILTINS: &[BuiltinRow] = &[
    each("abs", Op::Abs, "the magnitude"),
    each("sign", Op::Sign, "-1, 0 or 1"),
    each("floor", Op::Floor, "the largest whole number that is not above a"),
    each("ceil", Op::Ceil, "the smallest whole number that is not below a"),
    function(
        "round",
        "a, radius",
        Round,
        (1, 2),
        "the nearest whole number, halves rounded up; with a radius, a shape that is rounded by it and grows by it",
    ),
    each("trunc", Op::Trunc, "the whole part, rounded towards 0"),
    each("fract", Op::Fract, "a - floor(a)"),
    each("sqrt", Op::Sqrt, "the square root; 0 for negative a"),
    each("exp", Op::Exp, "e to the power of a"),
    each("exp2", Op::Exp2, "2 to the power of a"),
    each("log", Op::Log, "the natural logarithm"),
    each("log2", Op::Log2, "the binary logarithm"),
    each("sin", Op::Sin, "the sine of an angle in radians"),
    each("cos", Op::Cos, "the cosine of an angle in radians"),
    each("tan", Op::Tan, "the tangent of an angle in radians"),
    each("asin", Op::Asin, "the angle whose sine is a"),
    each("acos", Op::Acos, "the angle whose cosine is a"),
    each("sinh", Op::Sinh, "the hyperbolic sine"),
    each("cosh", Op::Cosh, "the hyperbolic cosine"),
    each("tanh", Op::Tanh, "the hyperbolic tangent"),
    function("atan", "y, x", Atan, (1, 2), "the angle of the vector (x, y), or the angle whose tangent is y"),
    function(
        "pow",
        "a, b",
        Pow,
        (2, 2),
        "a to the power of b, the same as a ^ b; 0 for negative a unless b is a whole number",
    ),
    function("mod", "a, b", Pair(Op::Mod), (2, 2), "a - b * floor(a / b), the same as a % b"),
    function("min", "a, b, …", Pair(Op::Min), (2, 2), "the smallest of any number of values"),
    function("max", "a, b, …", Pair(Op::Max), (2, 2), "the largest of any number of values"),
    function("sum", "a, b, …", Pair(Op::Add), (2, 2), "the sum of any number of values"),
    function("product", "a, b, …", Pair(Op::Mul), (2, 2), "the product of any number of values"),
    function("step", "edge, a", Pair(Op::Step), (2, 2), "0 where a is below the edge, else 1"),
    function(
        "mix",
        "a, b, share",
        Builtin::Three(Three::Mix),
        (3, 3),
        "a where share is 0, b where it is 1, linear in between",
    ),
    function("clamp", "a, low, high", Builtin::Three(Three::Clamp), (3, 3), "a limited to low..high"),
    function(
        "smoothstep",
        "low, high, a",
        Builtin::Three(Three::Smoothstep),
        (3, 3),
        "0 up to low, 1 from high on, a smooth curve in between",
    ),
    function("length", "v", Length, (1, 1), "the length of a vector"),
    function("dot", "a, b", Dot, (2, 2), "the scalar product"),
    function("vec2", "x, y", Construct(2), (1, 2), "a vector of two numbers"),
    function("vec3", "x, y, z", Construct(3), (1, 3), "a vector of three numbers"),
    function("vec4", "x, y, z, w", Construct(4), (1, 4), "a vector of four numbers"),
    function(
        "mat2",
        "a, b",
        Matrix(MatrixFunction::Construct(2)),
        (1, 4),
        "a matrix of two columns, from vectors or from four numbers by columns; one number fills the diagonal",
    ),
    function(
        "mat3",
        "a, b, c",
        Matrix(MatrixFunction::Construct(3)),
        (1, 9),
        "a matrix of three columns, from vectors or from nine numbers by columns; one number fills the diagonal",
    ),
    function(
        "transpose",
        "m",
        Matrix(MatrixFunction::Transpose),
        (1, 1),
        "the matrix with rows and columns exchanged",
    ),
    function(
        "inverse",
        "m",
        Matrix(MatrixFunction::Inverse),
        (1, 1),
        "the matrix that undoes m; zeros if its determinant is 0",
    ),
    function(
        "determinant",
        "m",
        Matrix(MatrixFunction::Determinant),
        (1, 1),
        "the factor by which m scales volumes",
    ),
    function("float", "a", Builtin::Float, (1, 1), "the number itself; 1 for a condition that holds, else 0"),
    function("int", "a", Builtin::Each(Op::Trunc), (1, 1), "the whole part, the same as trunc(a)"),
    function(
        "cell_hash",
        "a, b",
        Pair(Op::Hash),
        (2, 2),
        "a pseudo-random number in 0..1 for the cell (floor(a), floor(b))",
    ),
    levels(LevelList::Band),
    levels(LevelList::Note),
    levels(LevelList::Chroma),
    levels(LevelList::Pan),
    levels(LevelList::Width),
    function(
        "spectrum",
        "u",
        Table(Op::Spectrum),
        (1, 1),
        "the spectrum at u in 0..1: 30 Hz to 16 kHz on a logarithmic scale, 512 points",
    ),
    function(
        "waveform",
        "u",
        Table(Op::Waveform),
        (1, 1),
        "the waveform at u in 0..1, from old to new: values -1..1, 512 points, 43 ms around the current moment",
    ),
    function(
        "history",
        "u, age",
        History,
        (2, 2),
        "an earlier spectrum at u; age is 0 for now and 1 for 10 s ago",
    ),
    function(
        "follow",
        "a, rise, fall",
        Motion(MotionKind::Follow),
        (2, 3),
        "a number that follows a with inertia: rise and fall are the time constants in seconds; without fall, rise is both",
    ),
    function(
        "spring",
        "a, stiffness, damping",
        Motion(MotionKind::Spring),
        (2, 3),
        "a number that a damped spring pulls to a, with stiffness * (a - spring) - damping * speed; without damping it does not overshoot",
    ),
    function(
        "since",
        "event",
        Motion(MotionKind::Since),
        (1, 1),
        "seconds since a condition last began to hold, such as `kick > 0.3`, or since a number last rose above 0.5; 6 at most",
    ),
    function(
        "texture",
        "file, uv",
        Texture,
        (2, 2),
        "colour and alpha of an image, a video, a camera or the cover at uv, repeated beyond 0..1; in materials and the sky",
    ),
    function(
        "previous",
        "uv",
        Previous,
        (1, 1),
        "the light of the last frame at uv, vec3, 0..16: uv is 0..1 from the lower left corner, `pixel / resolution` is the same place, the edge goes on beyond; black in the first frame; in materials and the sky",
    ),
    function(
        "text",
        "words, p, font",
        Builtin::Shape(ShapeCall::Text),
        (2, 3),
        "the 2D distance to a text at p, a vec2: capital letters are 1 high, and the text is centred; in the program's font, or in the font of that name or file",
    ),
    function(
        "image",
        "file, p",
        Builtin::Shape(ShapeCall::Image),
        (2, 2),
        "the 2D distance to the opaque parts of a picture at p, or to its bright parts if it is opaque everywhere: PNG, JPEG or SVG, 1 high and centred",
    ),
    function(
        "title",
        "p, font",
        Builtin::Shape(ShapeCall::Song(SongText::Title)),
        (1, 2),
        "the 2D distance to the title of the song, like a text",
    ),
    function(
        "artist",
        "p, font",
        Builtin::Shape(ShapeCall::Song(SongText::Artist)),
        (1, 2),
        "the 2D distance to the name of the song's artist, like a text",
    ),
    function(
        "lyrics",
        "p, font",
        Builtin::Shape(ShapeCall::Song(SongText::Lyrics)),
        (1, 2),
        "the 2D distance to the line of the lyrics that is sung now, like a text",
    ),
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
