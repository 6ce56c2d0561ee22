//! Bounds of the gradient in a cell, packed into two words, for formulas whose value is not a distance.
//!
//! The lower and upper bound along each axis are integers (-128..=127) in units of scale / 128, rounded outwards. The
//! scale is the upper half of a float's bits, so that its products with these integers are exact in 32 bits, here and
//! in the shaders.
//!
//! | word | bits 0..8 | 8..16 | 16..24 | 24..32 |
//! |---|---|---|---|---|
//! | `z` | lower x | lower y | lower z | upper x |
//! | `w` | upper y | upper z | scale, low byte | scale, high byte |

use super::program::{Arg, BOUND, Program};
use crate::graph::{FrameInputs, GradientInterval, Graph, Input, Interval, Node, NodeId, Op, Pieces};

/// Smallest scale other than 0. It is far above the numbers that GPUs flush to 0, and far below the slopes that matter
/// to a ray.
const SCALE_MIN: f32 = 1e-30;
/// The largest finite float whose lower half is 0. Slopes above it are stored as unbounded.
const SCALE_MAX: f32 = f32::from_bits(0x7F7F_0000);
const FRACTIONS: f32 = 128.0;

/// Packs bounds of a gradient.
pub fn pack(gradient: [Interval; 3]) -> [u32; 2] {
    let most = gradient.iter().map(|side| side.lo.abs().max(side.hi.abs())).fold(0.0, f32::max);
    let known = gradient.iter().all(|side| !side.is_any()) && most < 0.99 * SCALE_MAX;
    if !known {
        return words([-128; 3], [127; 3], SCALE_MAX);
    }
    if most == 0.0 {
        return words([0; 3], [0; 3], 0.0);
    }
    // Divide by 127 instead of 128, because upper bounds have at most 127 units.
    let scale = rounded_up((most * (FRACTIONS / 127.0)).max(SCALE_MIN));
    let fraction =
        |value: f32, round: fn(f32) -> f32| round(value / scale * FRACTIONS).clamp(-128.0, 127.0) as i32;
    let lower = gradient.map(|side| {
        let found = fraction(side.lo, f32::floor);
        if value(found, scale) > side.lo { found - 1 } else { found }
    });
    let upper = gradient.map(|side| {
        let found = fraction(side.hi, f32::ceil);
        if value(found, scale) < side.hi { found + 1 } else { found }
    });
    words(lower, upper, scale)
}

/// Returns the least scale that is not below a positive number.
fn rounded_up(value: f32) -> f32 {
    f32::from_bits((value.to_bits() + 0xFFFF) & 0xFFFF_0000).min(SCALE_MAX)
}

fn value(fraction: i32, scale: f32) -> f32 {
    fraction as f32 * scale * (1.0 / FRACTIONS)
}

fn words(lower: [i32; 3], upper: [i32; 3], scale: f32) -> [u32; 2] {
    let byte = |fraction: i32| u32::from(fraction as u8);
    [
        byte(lower[0]) | byte(lower[1]) << 8 | byte(lower[2]) << 16 | byte(upper[0]) << 24,
        byte(upper[1]) | byte(upper[2]) << 8 | (scale.to_bits() & 0xFFFF_0000),
    ]
}

/// Unpacks bounds. The result contains the packed bounds, except that it is limited to ±3.4e38.
pub fn unpack([z, w]: [u32; 2]) -> [Interval; 3] {
    let scale = f32::from_bits(w & 0xFFFF_0000);
    let fraction = |word: u32, shift: u32| value(i32::from((word >> shift) as u8 as i8), scale);
    let side = |lo: f32, hi: f32| Interval { lo, hi };
    [
        side(fraction(z, 0), fraction(z, 24)),
        side(fraction(z, 8), fraction(w, 0)),
        side(fraction(z, 16), fraction(w, 8)),
    ]
}

/// The fastest fall of a value along a direction: -inf(gradient · direction). Negative if the value certainly rises.
pub fn slope_towards(gradient: [Interval; 3], direction: [f32; 3]) -> f32 {
    let falls = |side: Interval, along: f32| (-side.lo * along).max(-side.hi * along);
    (0..3).map(|axis| falls(gradient[axis], direction[axis])).sum()
}

/// Bounds that exceed the steepest sampled slope by more than this factor are useless: interval arithmetic gives such
/// bounds for quotients and roots even where the value changes as slowly as a distance.
const USELESS: f32 = 32.0;

/// Returns bounds for the steps of rays. Useless bounds are replaced by the steepest sampled slope.
fn useful(gradient: [Interval; 3], steepest: f32) -> [Interval; 3] {
    gradient.map(|side| {
        let widest = side.lo.abs().max(side.hi.abs());
        // The comparison is false for NaN, so NaN is replaced as well.
        if widest <= USELESS * steepest { side } else { Interval::new(-steepest, steepest) }
    })
}

#[derive(Debug)]
pub(super) struct Gradients {
    values: Vec<GradientInterval>,
    jumps: Pieces,
    steepest: f32,
}

impl Gradients {
    /// `steepest` is about the steepest slope of the world ([`crate::world::Slopes::steepest`]).
    pub(super) fn new(steepest: f32) -> Self {
        Self { values: Vec::new(), jumps: Pieces::default(), steepest }
    }

    /// Returns packed bounds of the gradient in the box `sides`, which is cut where the program jumps.
    pub(super) fn words(&mut self, program: &Program, sides: [Interval; 3], frame: &FrameInputs) -> [u32; 2] {
        self.jumps.clear();
        let whole = run(&mut self.values, Some(&mut self.jumps), program, sides, frame);
        let pieces =
            self.jumps.of(sides).iter().map(|piece| run(&mut self.values, None, program, *piece, frame));
        let gradient = pieces.reduce(|all, piece| all.hull(&piece)).unwrap_or(whole).gradient;
        pack(useful(gradient, self.steepest))
    }
}

fn run(
    values: &mut Vec<GradientInterval>,
    mut jumps: Option<&mut Pieces>,
    program: &Program,
    sides: [Interval; 3],
    frame: &FrameInputs,
) -> GradientInterval {
    values.clear();
    values.extend((0..3).map(|axis| GradientInterval::coordinate(axis, sides[axis])));
    // The penumbra does not affect a ray's step.
    values.push(GradientInterval::flat(Interval::point(0.0)));
    let of = |values: &[GradientInterval], arg: Arg| match arg {
        Arg::Number(number) => GradientInterval::flat(Interval::point(number)),
        Arg::Value(at) => values[at as usize],
    };
    for step in &program.steps {
        let (a, b) = (of(values, step.first()), of(values, step.second()));
        if let Some(jumps) = &mut jumps {
            jumps.add(GradientInterval::jump(step.op, &a, &b, sides));
        }
        values.push(GradientInterval::in_parts(step.op, &a, &b, frame));
    }
    of(values, program.roots[BOUND])
}

// Linear forms of the coordinates: a·x + b·y + c·z + d.
//
// A rotation about any axis reads each coordinate several times. Interval arithmetic then takes the reads for
// independent, and the bounds of the rotated coordinates are several times too wide. The linear form reads each
// coordinate once. Its coefficients are intervals that cover the roundings of the original operations and of the form
// itself: after n operations on terms with the sum s of absolute values, the error is at most about n·2⁻²⁴·s
// (Higham, "Accuracy and Stability of Numerical Algorithms", section 3.1).

/// Larger coefficients might overflow at the largest coordinates that are searched.
const COEFFICIENT_MAX: f64 = 1e20;
/// Operations of the form itself, with a margin.
const OPERATIONS_BESIDE: u32 = 16;
/// Rounding error of an operation, relative to the result.
const ROUNDING: f64 = 1.0 / (1 << 24) as f64;
/// Covers underflow.
const TINY: f64 = 1e-30;

/// A linear form, with the coefficients of x, y and z, then the constant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Linear {
    coefficients: [f64; 4],
    /// For each coefficient, the sum of the absolute values of its terms.
    absolute: [f64; 4],
    operations: u32,
    /// How often each coordinate is read.
    reads: [u32; 3],
}

impl Linear {
    fn constant(value: f32) -> Self {
        Self::term(3, f64::from(value), [0; 3])
    }

    fn coordinate(axis: usize) -> Self {
        Self::term(axis, 1.0, std::array::from_fn(|other| u32::from(other == axis)))
    }

    fn term(place: usize, coefficient: f64, reads: [u32; 3]) -> Self {
        let mut coefficients = [0.0; 4];
        coefficients[place] = coefficient;
        Self { coefficients, absolute: coefficients.map(f64::abs), operations: 0, reads }
    }

    fn sum(&self, other: &Self, sign: f64) -> Self {
        Self {
            coefficients: std::array::from_fn(|at| self.coefficients[at] + sign * other.coefficients[at]),
            absolute: std::array::from_fn(|at| self.absolute[at] + other.absolute[at]),
            operations: self.operations.max(other.operations) + 1,
            reads: std::array::from_fn(|axis| self.reads[axis].saturating_add(other.reads[axis])),
        }
    }

    fn scaled(&self, factor: f64) -> Self {
        Self {
            coefficients: self.coefficients.map(|coefficient| factor * coefficient),
            absolute: self.absolute.map(|absolute| factor.abs() * absolute),
            operations: self.operations + 1,
            reads: self.reads,
        }
    }

    /// Returns the form of a node, given the forms of its operands.
    fn of(graph: &Graph, node: Node, forms: &[Option<Self>]) -> Option<Self> {
        let at = |id: NodeId| forms[id.index()];
        let form = match node {
            Node::Constant(value) => Self::constant(value),
            Node::Input(Input::X) => Self::coordinate(0),
            Node::Input(Input::Y) => Self::coordinate(1),
            Node::Input(Input::Z) => Self::coordinate(2),
            Node::Unary(Op::Neg, a) => at(a)?.scaled(-1.0),
            Node::Binary(Op::Add, a, b) => at(a)?.sum(&at(b)?, 1.0),
            Node::Binary(Op::Sub, a, b) => at(a)?.sum(&at(b)?, -1.0),
            Node::Binary(Op::Mul, a, b) => match (graph.node(a), graph.node(b)) {
                (_, Node::Constant(b)) => at(a)?.scaled(f64::from(b)),
                (Node::Constant(a), _) => at(b)?.scaled(f64::from(a)),
                _ => return None,
            },
            Node::Binary(Op::Div, a, b) => at(a)?.scaled(1.0 / f64::from(graph.node(b).as_constant()?)),
            _ => return None,
        };
        form.absolute.iter().all(|absolute| *absolute < COEFFICIENT_MAX).then_some(form)
    }

    /// Returns the forms of those nodes that read a coordinate several times and that are operands of other operators,
    /// or the root.
    pub(super) fn all(graph: &Graph, nodes: &[NodeId], root: NodeId) -> Vec<Option<Self>> {
        let mut forms: Vec<Option<Self>> = vec![None; graph.len()];
        let mut read = vec![false; graph.len()];
        read[root.index()] = true;
        for id in nodes {
            let node = graph.node(*id);
            forms[id.index()] = Self::of(graph, node, &forms);
            if forms[id.index()].is_none() {
                node.operands().for_each(|operand| read[operand.index()] = true);
            }
        }
        let repeats = |form: &Self| form.reads.iter().any(|reads| *reads > 1);
        forms.iter().zip(read).map(|(form, read)| form.filter(|form| read && repeats(form))).collect()
    }

    /// Returns the coefficients of x, y and z, then the constant.
    pub(super) fn intervals(&self) -> [Interval; 4] {
        let error = f64::from(2 * self.operations + OPERATIONS_BESIDE) * ROUNDING;
        std::array::from_fn(|at| {
            let error = self.absolute[at] * error + TINY;
            let (lo, hi) = (self.coefficients[at] - error, self.coefficients[at] + error);
            Interval::new(lo as f32, hi as f32)
        })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn number() -> impl Strategy<Value = f32> {
        prop_oneof![
            4 => -3.0f32..3.0,
            1 => any::<f32>(),
            1 => proptest::sample::select(vec![0.0, -0.0, 1.0, -1.0, 1e-45, -1e-38, f32::MAX, f32::MIN, f32::INFINITY]),
        ]
    }

    fn interval(a: f32, b: f32) -> Interval {
        Interval::new(a.min(b), a.max(b))
    }

    fn finite(side: Interval) -> Interval {
        if side.is_any() {
            return Interval { lo: -1e38, hi: 1e38 };
        }
        Interval { lo: side.lo.clamp(-1e38, 1e38), hi: side.hi.clamp(-1e38, 1e38) }
    }

    proptest! {
        #[test]
        fn packed_bounds_hold_what_was_packed(ends in proptest::array::uniform3((number(), number()))) {
            let gradient = ends.map(|(a, b)| interval(a, b));
            let found = unpack(pack(gradient));
            for (found, side) in found.iter().zip(gradient.map(finite)) {
                prop_assert!(found.lo <= side.lo && side.hi <= found.hi, "{found:?} {side:?}");
            }
        }

        #[test]
        fn packed_bounds_are_close(ends in proptest::array::uniform3((-3.0f32..3.0, -3.0f32..3.0))) {
            let gradient = ends.map(|(a, b)| interval(a, b));
            let most = gradient.iter().map(|side| side.lo.abs().max(side.hi.abs())).fold(0.0, f32::max);
            for (found, side) in unpack(pack(gradient)).iter().zip(gradient) {
                prop_assert!(side.lo - found.lo <= most / 60.0 && found.hi - side.hi <= most / 60.0, "{found:?} {side:?}");
            }
        }

        #[test]
        fn no_gradient_within_falls_faster(
            ends in proptest::array::uniform3((-3.0f32..3.0, -3.0f32..3.0)),
            along in proptest::array::uniform3(0.0f32..=1.0),
            direction in proptest::array::uniform3(-1.0f32..1.0),
        ) {
            let gradient = ends.map(|(a, b)| interval(a, b));
            let one = |axis: usize| gradient[axis].lo + along[axis] * (gradient[axis].hi - gradient[axis].lo);
            let change: f32 = (0..3).map(|axis| one(axis) * direction[axis]).sum();
            let bounds = unpack(pack(gradient));
            prop_assert!(-change <= slope_towards(bounds, direction) + 1e-5);
        }
    }

    #[test]
    fn constants_have_no_slope() {
        let flat = [Interval::point(0.0); 3];
        assert_eq!((pack(flat), unpack([0, 0])), ([0, 0], flat));
    }
}
