//! The operators, each defined once by a row of one table.
//!
//! A row gives the number, the printed name, the properties, the value on the CPU, the interval rule (`rules.rs`),
//! the partial derivatives, their interval rule (`slope_rules.rs`) and the GLSL expression. CPU evaluators, the
//! interpreter's switch and compiled source are all generated from the row, so they cannot differ.
//!
//! **Numbers.** One-operand operators have numbers 16..64, two-operand operators 64..128; a tape's opcode is this
//! number plus the form of the operands. Changing a number changes encoded tapes.
//!
//! **Total.** Every operator is defined for all operands, including those for which GLSL leaves the result undefined:
//! square roots of negative numbers are 0, logarithms clamp their operand to at least [`SMALLEST`], operands of arcs
//! are clamped, x / 0 is 0, mod(x, 0) is x, and pow of a negative base is 0. For finite operands an operator never
//! returns a NaN. An overflow gives an infinity, and infinities may combine to a NaN as in IEEE 754. MIN and MAX of a
//! NaN and a number return the number.
//!
//! **One zero.** No operator distinguishes -0 from +0, which makes `x + 0 = x` exact. Evaluators add +0 to the values
//! they return, so that results are equal bit for bit.
//!
//! **Agreement.** Plain arithmetic, rounding, comparisons and HASH are correctly rounded on the CPU and on GPUs that
//! follow IEEE 754. Division, roots and transcendental functions agree to a few units in the last place, and GPUs may
//! fuse a product and a sum.

use super::frame_inputs::FrameInputs;
use super::interval::Interval;
use super::levels::LevelList;
use super::numbers::{
    SMALLEST, arc_slope, atan2, cell_hash, div, length_slopes, modulo, pow, round, sqrt, tanh, truth, unit,
};
use super::{rules, slope_rules as slopes};

/// A set of properties of an operator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Properties(u8);

impl Properties {
    /// No property.
    pub const NONE: Self = Self(0);
    /// The order of the operands does not matter.
    pub const COMMUTATIVE: Self = Self(1);
    /// The result is a NaN or at least 0.
    pub const NEVER_NEGATIVE: Self = Self(2);
    /// The result is a whole number, an infinity or a NaN.
    pub const WHOLE: Self = Self(4);
    /// The result depends on the frame's tables; it cannot be folded.
    pub const READS_FRAME: Self = Self(8);
    /// The operator costs several times as much as an addition. Its clause is always the second of the two in a texel.
    pub const EXPENSIVE: Self = Self(32);
    /// In some boxes the value always equals the same operand, so the other operand can be dropped.
    pub const CHOOSES: Self = Self(64);
    /// The result is 0 or 1.
    pub const TRUTH: Self = Self(16 | 2 | 4);

    const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// True if every property of `other` holds.
    pub const fn has(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }
}

/// A loop that calls an operator's function of numbers or its rule for intervals. It is compiled once per operator, so
/// that the function is inlined.
pub trait Kernel<T> {
    /// Runs with `meaning`, the operator's function of a, b and the frame. One-operand operators ignore b.
    fn run(&mut self, meaning: impl Fn(T, T, &FrameInputs) -> T + Copy);
}

/// Like [`Kernel`], but with the operator's partial derivatives.
pub trait DualKernel {
    /// Runs with `meaning`, as [`Kernel::run`], and with `slopes`, the derivatives for a, b, the value and the frame.
    fn run(
        &mut self,
        meaning: impl Fn(f32, f32, &FrameInputs) -> f32,
        slopes: impl Fn(f32, f32, f32, &FrameInputs) -> (f32, f32),
    );
}

/// Calls an operator's function or rule. The argument types give the closure its types.
#[inline(always)]
fn call<T>(f: impl Fn(T, T, &FrameInputs) -> T, a: T, b: T, frame: &FrameInputs) -> T {
    f(a, b, frame)
}

/// Like [`call`], for slopes, which also depend on the value `r`.
#[inline(always)]
fn call_with_value<T>(
    f: impl Fn(T, T, T, &FrameInputs) -> (T, T),
    a: T,
    b: T,
    r: T,
    frame: &FrameInputs,
) -> (T, T) {
    f(a, b, r, frame)
}

macro_rules! operators {
    ($(
        $(#[doc = $doc:literal])+
        $id:ident = $number:literal $name:literal $properties:expr,
            value $value:expr, bounds $bounds:expr,
            $(slopes $slopes:expr, slope_bounds $slope_bounds:expr,)? $(constant_slopes $by_a:expr, $by_b:expr,)?
            glsl $glsl:literal;
    )+) => {
        /// An operator of the expression graph.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[repr(u8)]
        pub enum Op { $( $(#[doc = $doc])+ $id = $number, )+ }

        impl Op {
            /// Every operator, in the order of their numbers.
            pub const ALL: &'static [Op] = &[$( Op::$id, )+];

            /// Returns the name as printed in a tape, such as `SQRT`.
            pub const fn name(self) -> &'static str {
                match self { $( Op::$id => $name, )+ }
            }

            /// Returns the operator's properties.
            #[inline]
            pub const fn properties(self) -> Properties {
                match self { $( Op::$id => $properties, )+ }
            }

            /// Returns GLSL with `$a` and `$b` for the operands. Each may occur twice, so replace it by a name or
            /// literal.
            pub const fn glsl(self) -> &'static str {
                match self { $( Op::$id => $glsl, )+ }
            }

            /// Returns the operator with this number.
            #[inline]
            pub const fn from_number(number: u8) -> Option<Op> {
                match number { $( $number => Some(Op::$id), )+ _ => None }
            }

            /// Returns the value for the operands a and b. One-operand operators ignore b.
            #[inline(always)]
            pub fn value(self, a: f32, b: f32, frame: &FrameInputs) -> f32 {
                match self { $( Op::$id => call($value, a, b, frame), )+ }
            }

            /// Runs a kernel with the operator's function.
            #[inline(always)]
            pub fn with_value(self, kernel: &mut impl Kernel<f32>) {
                match self { $( Op::$id => kernel.run($value), )+ }
            }

            /// Returns an interval that holds the value for every a and b of the given intervals.
            #[inline(always)]
            pub fn bounds(self, a: Interval, b: Interval, frame: &FrameInputs) -> Interval {
                match self { $( Op::$id => call($bounds, a, b, frame), )+ }
            }

            /// Runs a kernel with the operator's interval rule.
            #[inline(always)]
            pub fn with_bounds(self, kernel: &mut impl Kernel<Interval>) {
                match self { $( Op::$id => kernel.run($bounds), )+ }
            }

            /// Returns the partial derivatives by a and by b, where `r` is the value. At a jump or a kink, returns the
            /// derivative of one side. Returns 0 for operands that GLSL leaves undefined (see **Total** above).
            #[inline(always)]
            pub fn slopes(self, a: f32, b: f32, r: f32, frame: &FrameInputs) -> (f32, f32) {
                match self {
                    $( Op::$id => call_with_value($($slopes)? $(|_, _, _, _| ($by_a, $by_b))?, a, b, r, frame), )+
                }
            }

            /// Runs a kernel with the operator's function and with its partial derivatives ([`Op::slopes`]).
            #[inline(always)]
            pub fn with_slopes(self, kernel: &mut impl DualKernel) {
                match self { $( Op::$id => kernel.run($value, $($slopes)? $(|_, _, _, _| ($by_a, $by_b))?), )+ }
            }

            /// Returns intervals that hold the partial derivatives by a and by b over the given intervals, where `r`
            /// bounds the value. At kinks the intervals hold the slopes of both sides. Jumps have no slope
            /// (`slope_rules.rs`).
            #[inline(always)]
            pub fn slope_bounds(
                self, a: Interval, b: Interval, r: Interval, frame: &FrameInputs,
            ) -> (Interval, Interval) {
                match self {
                    $( Op::$id => call_with_value(
                        $($slope_bounds)? $(|_, _, _, _| slopes::constant($by_a, $by_b))?, a, b, r, frame,
                    ), )+
                }
            }
        }
    };
}

use Properties as P;

operators! {
    /// -a.
    Neg = 16 "NEG" P::NONE,
        value |a, _, _| -a, bounds |a, _, _| rules::neg(a), constant_slopes -1.0, 0.0,
        glsl "-$a";
    /// |a|.
    Abs = 17 "ABS" P::NEVER_NEGATIVE,
        value |a, _, _| a.abs(), bounds |a, _, _| rules::abs(a),
        slopes |a, _, _, _| (if a < 0.0 { -1.0 } else { 1.0 }, 0.0),
        slope_bounds |a, _, _, _| slopes::abs(a),
        glsl "abs($a)";
    /// -1, 0 or 1; 0 for a NaN.
    Sign = 18 "SIGN" P::WHOLE,
        value |a, _, _| truth(a > 0.0) - truth(a < 0.0), bounds |a, _, _| rules::sign(a),
        constant_slopes 0.0, 0.0, glsl "sign($a)";
    /// The largest whole number that is not above a.
    Floor = 19 "FLOOR" P::WHOLE,
        value |a, _, _| a.floor(), bounds |a, _, _| a.map_rising(f32::floor), constant_slopes 0.0, 0.0,
        glsl "floor($a)";
    /// The smallest whole number that is not below a.
    Ceil = 20 "CEIL" P::WHOLE,
        value |a, _, _| a.ceil(), bounds |a, _, _| a.map_rising(f32::ceil), constant_slopes 0.0, 0.0,
        glsl "ceil($a)";
    /// floor(a + 0.5): halves are rounded up. (In GLSL the direction depends on the driver.)
    Round = 21 "ROUND" P::WHOLE,
        value |a, _, _| round(a), bounds |a, _, _| a.map_rising(round), constant_slopes 0.0, 0.0,
        glsl "floor($a + 0.5)";
    /// The whole part, towards 0.
    Trunc = 22 "TRUNC" P::WHOLE,
        value |a, _, _| a.trunc(), bounds |a, _, _| a.map_rising(f32::trunc), constant_slopes 0.0, 0.0,
        glsl "trunc($a)";
    /// a - floor(a); 1 for tiny negative a, by rounding.
    Fract = 23 "FRACT" P::NEVER_NEGATIVE,
        value |a, _, _| a - a.floor(), bounds |a, _, _| rules::fract(a), constant_slopes 1.0, 0.0,
        glsl "($a - floor($a))";
    /// a * a.
    Square = 24 "SQUARE" P::NEVER_NEGATIVE,
        value |a, _, _| a * a, bounds |a, _, _| rules::square(a), slopes |a, _, _, _| (2.0 * a, 0.0),
        slope_bounds |a, _, _, _| slopes::square(a),
        glsl "($a * $a)";
    /// The square root; 0 for negative a and for a NaN.
    Sqrt = 25 "SQRT" P::NEVER_NEGATIVE,
        value |a, _, _| sqrt(a), bounds |a, _, _| rules::sqrt(a),
        slopes |_, _, r, _| (if r > 0.0 { 0.5 / r } else { 0.0 }, 0.0),
        slope_bounds |_, _, r, _| slopes::sqrt(r),
        glsl "sqrt(max($a, 0.0))";
    /// e^a.
    Exp = 26 "EXP" P::NEVER_NEGATIVE.and(P::EXPENSIVE),
        value |a, _, _| a.exp(), bounds |a, _, _| rules::exponential(a, f32::exp), slopes |_, _, r, _| (r, 0.0),
        slope_bounds |_, _, r, _| slopes::first(r),
        glsl "exp($a)";
    /// 2^a.
    Exp2 = 27 "EXP2" P::NEVER_NEGATIVE.and(P::EXPENSIVE),
        value |a, _, _| a.exp2(), bounds |a, _, _| rules::exponential(a, f32::exp2),
        slopes |_, _, r, _| (r * std::f32::consts::LN_2, 0.0),
        slope_bounds |_, _, r, _| slopes::exp2(r),
        glsl "exp2($a)";
    /// The natural logarithm of max(a, [`SMALLEST`]), so at least -87.34.
    Log = 28 "LOG" P::EXPENSIVE,
        value |a, _, _| a.max(SMALLEST).ln(), bounds |a, _, _| rules::logarithm(a, f32::ln),
        slopes |a, _, _, _| (if a > SMALLEST { a.recip() } else { 0.0 }, 0.0),
        slope_bounds |a, _, _, _| slopes::log(a, 1.0),
        glsl "log(max($a, 1.17549435e-38))";
    /// The binary logarithm of max(a, [`SMALLEST`]), so at least -126.
    Log2 = 29 "LOG2" P::EXPENSIVE,
        value |a, _, _| a.max(SMALLEST).log2(), bounds |a, _, _| rules::logarithm(a, f32::log2),
        slopes |a, _, _, _| (if a > SMALLEST { std::f32::consts::LOG2_E / a } else { 0.0 }, 0.0),
        slope_bounds |a, _, _, _| slopes::log(a, std::f32::consts::LOG2_E),
        glsl "log2(max($a, 1.17549435e-38))";
    /// The sine of a in radians.
    Sin = 30 "SIN" P::EXPENSIVE,
        value |a, _, _| a.sin(), bounds |a, _, _| rules::sin(a), slopes |a, _, _, _| (a.cos(), 0.0),
        slope_bounds |a, _, _, _| slopes::first(rules::cos(a)),
        glsl "sin($a)";
    /// The cosine of a in radians.
    Cos = 31 "COS" P::EXPENSIVE,
        value |a, _, _| a.cos(), bounds |a, _, _| rules::cos(a), slopes |a, _, _, _| (-a.sin(), 0.0),
        slope_bounds |a, _, _, _| slopes::first(rules::neg(rules::sin(a))),
        glsl "cos($a)";
    /// The tangent of a in radians.
    Tan = 32 "TAN" P::EXPENSIVE,
        value |a, _, _| a.tan(), bounds |a, _, _| rules::tan(a), slopes |_, _, r, _| (1.0 + r * r, 0.0),
        slope_bounds |_, _, r, _| slopes::tan(r),
        glsl "tan($a)";
    /// The arc sine of a clamped to -1..1; 0 for a NaN. (GLSL's asin has an error of 4e-4 in Mesa.)
    Asin = 33 "ASIN" P::EXPENSIVE,
        value |a, _, _| unit(a).asin(), bounds |a, _, _| rules::asin(a),
        slopes |a, _, _, _| (arc_slope(a), 0.0),
        slope_bounds |a, _, _, _| slopes::first(slopes::arc(a)),
        glsl "atan(clamp($a, -1.0, 1.0), sqrt(max((1.0 - $a) * (1.0 + $a), 0.0)))";
    /// The arc cosine of a clamped to -1..1; π/2 for a NaN.
    Acos = 34 "ACOS" P::NEVER_NEGATIVE.and(P::EXPENSIVE),
        value |a, _, _| unit(a).acos(), bounds |a, _, _| rules::acos(a),
        slopes |a, _, _, _| (-arc_slope(a), 0.0),
        slope_bounds |a, _, _, _| slopes::first(rules::neg(slopes::arc(a))),
        glsl "atan(sqrt(max((1.0 - $a) * (1.0 + $a), 0.0)), clamp($a, -1.0, 1.0))";
    /// The arc tangent of a.
    Atan = 35 "ATAN" P::EXPENSIVE,
        value |a, _, _| a.atan(), bounds |a, _, _| a.map_rising(f32::atan).widened(),
        slopes |a, _, _, _| ((1.0 + a * a).recip(), 0.0),
        slope_bounds |a, _, _, _| slopes::atan(a),
        glsl "atan($a)";
    /// The hyperbolic sine of a.
    Sinh = 36 "SINH" P::EXPENSIVE,
        value |a, _, _| a.sinh(), bounds |a, _, _| a.map_rising(f32::sinh).widened(), slopes |a, _, _, _| (a.cosh(), 0.0),
        slope_bounds |a, _, _, _| slopes::first(rules::cosh(a)),
        glsl "sinh($a)";
    /// The hyperbolic cosine of a.
    Cosh = 37 "COSH" P::NEVER_NEGATIVE.and(P::EXPENSIVE),
        value |a, _, _| a.cosh(), bounds |a, _, _| rules::cosh(a), slopes |a, _, _, _| (a.sinh(), 0.0),
        slope_bounds |a, _, _, _| slopes::first(a.map_rising(f32::sinh).widened()),
        glsl "cosh($a)";
    /// The hyperbolic tangent of a clamped to ±[`TANH_MAX`](super::TANH_MAX); 0 for a NaN.
    Tanh = 38 "TANH" P::EXPENSIVE,
        value |a, _, _| tanh(a), bounds |a, _, _| rules::tanh(a), slopes |_, _, r, _| (1.0 - r * r, 0.0),
        slope_bounds |_, _, r, _| slopes::tanh(r),
        glsl "tanh(clamp($a, -10.0, 10.0))";
    /// 1 where a is 0, else 0 (also for a NaN).
    Not = 39 "NOT" P::TRUTH,
        value |a, _, _| truth(a == 0.0), bounds |a, _, _| rules::not(a), constant_slopes 0.0, 0.0,
        glsl "float($a == 0.0)";
    /// The band with the number floor(a), clamped to the list ([`LevelList::nearest`]); band 0 for a NaN.
    Band = 40 "BAND" P::READS_FRAME.and(P::EXPENSIVE),
        value |a, _, frame| frame.level(LevelList::Band, a),
        bounds |a, _, frame| frame.level_bounds(LevelList::Band, a),
        constant_slopes 0.0, 0.0, glsl "level_of_band($a)";
    /// The spectrum at a in 0..1, low to high, clamped; a cubic B-spline ([`TableData`](super::TableData)).
    Spectrum = 41 "SPECTRUM" P::READS_FRAME.and(P::EXPENSIVE),
        value |a, _, frame| frame.spectrum.at(a, 0.0),
        bounds |a, _, frame| frame.spectrum.bounds(a, Interval::point(0.0)),
        slopes |a, _, _, frame| frame.spectrum.slopes(a, 0.0),
        slope_bounds |a, _, _, frame| frame.spectrum.slope_bounds(a, Interval::point(0.0)),
        glsl "table_spectrum($a)";
    /// The waveform at a in 0..1, old to new, clamped; a cubic B-spline of the entries.
    Waveform = 42 "WAVEFORM" P::READS_FRAME.and(P::EXPENSIVE),
        value |a, _, frame| frame.waveform.at(a, 0.0),
        bounds |a, _, frame| frame.waveform.bounds(a, Interval::point(0.0)),
        slopes |a, _, _, frame| frame.waveform.slopes(a, 0.0),
        slope_bounds |a, _, _, frame| frame.waveform.slope_bounds(a, Interval::point(0.0)),
        glsl "table_waveform($a)";
    /// The number of the parts of the song with the index floor(a), clamped; the first for a NaN
    /// ([`PartInput`](super::PartInput)).
    Part = 47 "PART" P::READS_FRAME.and(P::EXPENSIVE),
        value |a, _, frame| frame.part(a), bounds |a, _, frame| frame.part_bounds(a),
        constant_slopes 0.0, 0.0, glsl "table_part($a)";

    /// The number of the scene's texts and pictures with the index floor(a), clamped; the first for a NaN
    /// ([`ShapeAtlas`](super::ShapeAtlas)).
    ShapeNumber = 48 "SHAPE_NUMBER" P::READS_FRAME.and(P::EXPENSIVE),
        value |a, _, frame| frame.shapes.number(a), bounds |a, _, frame| frame.shapes.number_bounds(a),
        constant_slopes 0.0, 0.0, glsl "shape_number($a)";
    /// Like [`Op::Band`], for the levels of notes.
    Note = 43 "NOTE" P::READS_FRAME.and(P::EXPENSIVE),
        value |a, _, frame| frame.level(LevelList::Note, a),
        bounds |a, _, frame| frame.level_bounds(LevelList::Note, a),
        constant_slopes 0.0, 0.0, glsl "level_of_note($a)";
    /// The same for the levels of pitch classes.
    Chroma = 44 "CHROMA" P::READS_FRAME.and(P::EXPENSIVE),
        value |a, _, frame| frame.level(LevelList::Chroma, a),
        bounds |a, _, frame| frame.level_bounds(LevelList::Chroma, a),
        constant_slopes 0.0, 0.0, glsl "level_of_chroma($a)";
    /// The same for the stereo positions of the bands.
    Pan = 45 "PAN" P::READS_FRAME.and(P::EXPENSIVE),
        value |a, _, frame| frame.level(LevelList::Pan, a),
        bounds |a, _, frame| frame.level_bounds(LevelList::Pan, a),
        constant_slopes 0.0, 0.0, glsl "level_of_pan($a)";
    /// The same for the difference between the channels in each band.
    Width = 46 "WIDTH" P::READS_FRAME.and(P::EXPENSIVE),
        value |a, _, frame| frame.level(LevelList::Width, a),
        bounds |a, _, frame| frame.level_bounds(LevelList::Width, a),
        constant_slopes 0.0, 0.0, glsl "level_of_width($a)";
    /// a + b.
    Add = 64 "ADD" P::COMMUTATIVE,
        value |a, b, _| a + b, bounds |a, b, _| rules::add(a, b), constant_slopes 1.0, 1.0,
        glsl "($a + $b)";
    /// a - b.
    Sub = 65 "SUB" P::NONE,
        value |a, b, _| a - b, bounds |a, b, _| rules::sub(a, b), constant_slopes 1.0, -1.0,
        glsl "($a - $b)";
    /// a * b.
    Mul = 66 "MUL" P::COMMUTATIVE,
        value |a, b, _| a * b, bounds |a, b, _| rules::mul(a, b), slopes |a, b, _, _| (b, a),
        slope_bounds |a, b, _, _| (b, a),
        glsl "($a * $b)";
    /// a / b; 0 where b is 0, so that the normalized vector of length 0 is 0.
    Div = 67 "DIV" P::NONE,
        value |a, b, _| div(a, b), bounds |a, b, _| rules::div(a, b),
        slopes |_, b, r, _| if b == 0.0 { (0.0, 0.0) } else { (b.recip(), -r / b) },
        slope_bounds |a, b, r, _| slopes::div(a, b, r),
        glsl "($b == 0.0 ? 0.0 : $a / $b)";
    /// The smaller operand.
    Min = 68 "MIN" P::COMMUTATIVE.and(P::CHOOSES),
        value |a, b, _| a.min(b), bounds |a, b, _| rules::min(a, b),
        slopes |a, b, _, _| if b < a { (0.0, 1.0) } else { (1.0, 0.0) },
        slope_bounds |a, b, _, _| slopes::min(a, b),
        glsl "min($a, $b)";
    /// The larger operand.
    Max = 69 "MAX" P::COMMUTATIVE.and(P::CHOOSES),
        value |a, b, _| a.max(b), bounds |a, b, _| rules::max(a, b),
        slopes |a, b, _, _| if b > a { (0.0, 1.0) } else { (1.0, 0.0) },
        slope_bounds |a, b, _, _| slopes::min(b, a),
        glsl "max($a, $b)";
    /// GLSL's mod: a - b * floor(a / b), or a where b is 0. The result has the sign of b.
    Mod = 70 "MOD" P::NONE,
        value |a, b, _| modulo(a, b), bounds |a, b, _| rules::modulo(a, b),
        slopes |a, b, _, _| (1.0, -div(a, b).floor()),
        slope_bounds |a, b, _, _| slopes::modulo(a, b),
        glsl "($b == 0.0 ? $a : $a - $b * floor($a / $b))";
    /// a to the power of b. A base that is 0, negative or below [`SMALLEST`] gives 0, and 1 where b is 0.
    Pow = 71 "POW" P::NEVER_NEGATIVE.and(P::EXPENSIVE),
        value |a, b, _| pow(a, b), bounds |a, b, _| rules::pow(a, b),
        slopes |a, b, r, _| if a >= SMALLEST { (b * r / a, r * a.ln()) } else { (0.0, 0.0) },
        slope_bounds |a, b, r, _| slopes::pow(a, b, r),
        glsl "($a >= 1.17549435e-38 ? pow($a, $b) : float($b == 0.0))";
    /// The angle of (b, a) from the x axis, -π..π: GLSL's atan(a, b). Where a is 0: π for negative b, else 0.
    Atan2 = 72 "ATAN2" P::EXPENSIVE,
        value |a, b, _| atan2(a, b), bounds |a, b, _| rules::atan2(a, b),
        slopes |a, b, _, _| { let d = a * a + b * b; if d > 0.0 { (b / d, -a / d) } else { (0.0, 0.0) } },
        slope_bounds |a, b, _, _| slopes::atan2(a, b),
        glsl "($a == 0.0 ? ($b < 0.0 ? 3.14159274 : 0.0) : atan($a, $b))";
    /// GLSL's step(a, b): 0 where b is below the edge a, else 1 (also for a NaN).
    Step = 73 "STEP" P::TRUTH,
        value |a, b, _| 1.0 - truth(b < a), bounds |a, b, _| rules::not(rules::less(b, a)),
        constant_slopes 0.0, 0.0, glsl "($b < $a ? 0.0 : 1.0)";
    /// 1 where a < b, else 0.
    Less = 74 "LESS" P::TRUTH,
        value |a, b, _| truth(a < b), bounds |a, b, _| rules::less(a, b), constant_slopes 0.0, 0.0,
        glsl "float($a < $b)";
    /// 1 where a <= b, else 0.
    LessEqual = 75 "LESS_EQUAL" P::TRUTH,
        value |a, b, _| truth(a <= b), bounds |a, b, _| rules::less_equal(a, b), constant_slopes 0.0, 0.0,
        glsl "float($a <= $b)";
    /// 1 where a = b, else 0.
    Equal = 76 "EQUAL" P::COMMUTATIVE.and(P::TRUTH),
        value |a, b, _| truth(a == b), bounds |a, b, _| rules::equal(a, b), constant_slopes 0.0, 0.0,
        glsl "float($a == $b)";
    /// b where a is not 0 (also where it is a NaN), else 0.
    Mask = 77 "MASK" P::CHOOSES,
        value |a, b, _| if a == 0.0 { 0.0 } else { b }, bounds |a, b, _| rules::mask(a, b),
        slopes |a, _, _, _| (0.0, truth(a != 0.0)),
        slope_bounds |a, _, _, _| (Interval::point(0.0), rules::truth(!a.has_zero(), rules::is_zero(a))),
        glsl "($a == 0.0 ? 0.0 : $b)";
    /// A pseudo-random number in 0..1, a multiple of 2^-24, for the cell (floor(a), floor(b)); see [`cell_hash`].
    Hash = 78 "HASH" P::NEVER_NEGATIVE.and(P::EXPENSIVE),
        value |a, b, _| cell_hash(a, b), bounds |a, b, _| rules::hash(a, b), constant_slopes 0.0, 0.0,
        glsl "cell_hash($a, $b)";
    /// The history of the spectrum at a (0 low .. 1 high) and age b (0 now .. 1 oldest); a bicubic B-spline.
    History = 79 "HISTORY" P::READS_FRAME.and(P::EXPENSIVE),
        value |a, b, frame| frame.history.at(a, b), bounds |a, b, frame| frame.history.bounds(a, b),
        slopes |a, b, _, frame| frame.history.slopes(a, b),
        slope_bounds |a, b, _, frame| frame.history.slope_bounds(a, b),
        glsl "table_history($a, $b)";

    /// The distance to a text or picture at the coordinates a and b of the grid of all of them, clamped; bilinear.
    Shape = 87 "SHAPE" P::READS_FRAME.and(P::EXPENSIVE),
        value |a, b, frame| frame.shapes.at(a, b), bounds |a, b, frame| frame.shape_bounds(a, b),
        slopes |a, b, _, frame| frame.shapes.slopes(a, b),
        slope_bounds |a, b, _, frame| frame.shapes.slope_bounds(a, b),
        glsl "shape_distance($a, $b)";

    // Fused operators, which only `fuse.rs` makes. Each replaces two operators and rounds after both operations.

    /// a * a + b.
    SquareAdd = 80 "SQUARE_ADD" P::NONE,
        value |a, b, _| a * a + b, bounds |a, b, _| rules::add(rules::square(a), b),
        slopes |a, _, _, _| (2.0 * a, 1.0),
        slope_bounds |a, _, _, _| (slopes::square(a).0, slopes::ONE),
        glsl "($a * $a + $b)";
    /// max(a, 0)^2 + b: one axis's part of the distance to a box's corner.
    OutsideAdd = 81 "OUTSIDE_ADD" P::NONE,
        value |a, b, _| { let a = a.max(0.0); a * a + b },
        bounds |a, b, _| rules::add(rules::square(rules::max(a, Interval::point(0.0))), b),
        slopes |a, _, _, _| (2.0 * a.max(0.0), 1.0),
        slope_bounds |a, _, _, _| (slopes::square(rules::max(a, Interval::point(0.0))).0, slopes::ONE),
        glsl "(max($a, 0.0) * max($a, 0.0) + $b)";
    /// (a - b)^2.
    SquareDifference = 82 "SQUARE_DIFFERENCE" P::COMMUTATIVE.and(P::NEVER_NEGATIVE),
        value |a, b, _| (a - b) * (a - b), bounds |a, b, _| rules::square(rules::sub(a, b)),
        slopes |a, b, _, _| (2.0 * (a - b), -2.0 * (a - b)),
        slope_bounds |a, b, _, _| slopes::opposite(slopes::square(rules::sub(a, b)).0),
        glsl "(($a - $b) * ($a - $b))";
    /// |a - b|.
    AbsDifference = 83 "ABS_DIFFERENCE" P::COMMUTATIVE.and(P::NEVER_NEGATIVE),
        value |a, b, _| (a - b).abs(), bounds |a, b, _| rules::abs(rules::sub(a, b)),
        slopes |a, b, _, _| if a < b { (-1.0, 1.0) } else { (1.0, -1.0) },
        slope_bounds |a, b, _, _| slopes::opposite(slopes::abs(rules::sub(a, b)).0),
        glsl "abs($a - $b)";
    /// |a| - b.
    AbsSub = 84 "ABS_SUB" P::NONE,
        value |a, b, _| a.abs() - b, bounds |a, b, _| rules::sub(rules::abs(a), b),
        slopes |a, _, _, _| (if a < 0.0 { -1.0 } else { 1.0 }, -1.0),
        slope_bounds |a, _, _, _| (slopes::abs(a).0, rules::neg(slopes::ONE)),
        glsl "(abs($a) - $b)";
    /// The square root of a (0 for negative a and for a NaN) minus b.
    SqrtSub = 85 "SQRT_SUB" P::NONE,
        value |a, b, _| sqrt(a) - b, bounds |a, b, _| rules::sub(rules::sqrt(a), b),
        slopes |a, _, _, _| (if a > 0.0 { 0.5 / a.sqrt() } else { 0.0 }, -1.0),
        slope_bounds |a, _, _, _| (slopes::sqrt(rules::sqrt(a)).0, rules::neg(slopes::ONE)),
        glsl "(sqrt(max($a, 0.0)) - $b)";
    /// The square root of a * a + b (0 where this sum is negative or a NaN): the last step of a length.
    Length = 86 "LENGTH" P::NEVER_NEGATIVE,
        value |a, b, _| sqrt(a * a + b), bounds |a, b, _| rules::sqrt(rules::add(rules::square(a), b)),
        slopes |a, _, r, _| if r > 0.0 { length_slopes(a, r) } else { (0.0, 0.0) },
        slope_bounds |a, _, r, _| slopes::length(a, r),
        glsl "sqrt(max($a * $a + $b, 0.0))";
}

/// First number of the two-operand operators.
pub const FIRST_BINARY: u8 = 64;

impl Op {
    /// The operators that read a curve of the sound. Frames hold the curves only if a scene uses these operators.
    pub const CURVES: [Op; 3] = [Op::Spectrum, Op::Waveform, Op::History];
    /// The operator that reads the parts of the song.
    pub const PARTS: [Op; 1] = [Op::Part];

    /// The operators that read texts and pictures as shapes.
    pub const SHAPES: [Op; 2] = [Op::ShapeNumber, Op::Shape];

    /// Returns the operator that reads a level of the list.
    pub const fn of_levels(list: LevelList) -> Self {
        const ALL: [Op; LevelList::ALL.len()] = [Op::Band, Op::Note, Op::Chroma, Op::Pan, Op::Width];
        ALL[list as usize]
    }

    /// Returns the list of levels that the operator reads.
    pub fn level_list(self) -> Option<LevelList> {
        LevelList::ALL.into_iter().find(|list| Self::of_levels(*list) == self)
    }

    /// Returns the operator's number.
    pub const fn number(self) -> u8 {
        self as u8
    }

    /// Number of operands, 1 or 2.
    pub const fn arity(self) -> usize {
        if self.number() < FIRST_BINARY { 1 } else { 2 }
    }

    /// Like [`Op::glsl`], but without the guard against 0, for a second operand that is a constant other than 0.
    pub const fn glsl_by_constant(self) -> &'static str {
        match self {
            Op::Div => "($a / $b)",
            Op::Mod => "($a - $b * floor($a / $b))",
            other => other.glsl(),
        }
    }

    /// True for minima, maxima and masks ([`Properties::CHOOSES`]).
    pub const fn chooses(self) -> bool {
        self.properties().has(Properties::CHOOSES)
    }
}
