//! Bounds of a value and of its gradient over a box, by forward accumulation (Moore, Kearfott and Cloud 2009, section 6.4;
//! Griewank and Walther 2008, chapter 3).

use super::frame_inputs::FrameInputs;
use super::interval::Interval;
use super::op::Op;
use super::rules;

/// Bounds of a value all over a box, and of its derivatives by x, y and z there; of those on both sides at a kink. Jumps
/// have no slope (see `slope_rules.rs`).
///
/// **Lengths.** The slope of a square root is unbounded at 0, that of a length is not: with s = Σ aᵢ² and r = √s,
/// ∂r/∂x = Σ (aᵢ/r) ∂aᵢ/∂x, and by Cauchy and Schwarz |∂r/∂x| ≤ √(Σ (∂aᵢ/∂x)²), as Σ (aᵢ/r)² = 1. So a sum of squares
/// carries Σ (∂aᵢ/∂x)² until its root is taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sloped {
    /// The value.
    pub value: Interval,
    /// The gradient.
    pub gradient: [Interval; 3],
    /// Where the value is known to be a sum of squares, also of a constant that is not negative: for each axis at least
    /// the sum of the squared derivatives of what is squared. Else infinite.
    squares: [f32; 3],
}

const ZERO: Interval = Interval { lo: 0.0, hi: 0.0 };
/// More than what the roundings of a sum of squares, of its root and of both slopes come to.
const LENGTH_ERROR: f32 = 1.0 + 1e-4;

impl Sloped {
    /// What is the same all over the box: a constant, an input of the frame.
    #[inline(always)]
    pub fn flat(value: Interval) -> Self {
        let squares = if value.lo >= 0.0 { [0.0; 3] } else { [f32::INFINITY; 3] };
        Self { value, gradient: [ZERO; 3], squares }
    }

    /// The coordinate with the number `axis`, 0..3.
    #[inline(always)]
    pub fn coordinate(axis: usize, value: Interval) -> Self {
        let gradient = [0, 1, 2].map(|each| Interval::point(if each == axis { 1.0 } else { 0.0 }));
        Self { value, gradient, squares: [f32::INFINITY; 3] }
    }

    /// A one-operand operator.
    pub fn unary(op: Op, a: &Self, frame: &FrameInputs) -> Self {
        let value = op.bounds(a.value, ZERO, frame);
        let (slope, _) = op.slope_bounds(a.value, ZERO, value, frame);
        let mut gradient = a.gradient.map(|change| along(slope, change));
        let mut squares = [f32::INFINITY; 3];
        match op {
            Op::Square => squares = a.gradient.map(|change| rules::square(change).hi),
            Op::Sqrt => {
                for (change, square) in gradient.iter_mut().zip(a.squares) {
                    let most = (square * LENGTH_ERROR).sqrt();
                    // Nothing is known of the change where the root's slope is unbounded and its operand's a NaN.
                    if most.is_finite() {
                        let (lo, hi) = (change.lo.max(-most), change.hi.min(most));
                        *change = Interval { lo: lo.min(most), hi: hi.max(-most) };
                    }
                }
            }
            _ => {}
        }
        Self { value, gradient, squares }
    }

    /// A two-operand operator.
    pub fn binary(op: Op, a: &Self, b: &Self, frame: &FrameInputs) -> Self {
        let value = op.bounds(a.value, b.value, frame);
        let (by_a, by_b) = op.slope_bounds(a.value, b.value, value, frame);
        if op.chooses() {
            return Self::chosen([(a, by_a), (b, by_b)], value);
        }
        let each = |axis: usize| rules::add(along(by_a, a.gradient[axis]), along(by_b, b.gradient[axis]));
        let squares = match op {
            Op::Add => [0, 1, 2].map(|axis| a.squares[axis] + b.squares[axis]),
            Op::Mul if is_factor(a) => b.squares.map(|square| square * a.value.hi),
            Op::Mul if is_factor(b) => a.squares.map(|square| square * b.value.hi),
            _ => [f32::INFINITY; 3],
        };
        Self { value, gradient: [0, 1, 2].map(each), squares }
    }

    /// A minimum, maximum or mask has the slopes of one operand: where either may be it, of both. (By the chain rule
    /// alone it would have any sum of shares of both.)
    fn chosen(operands: [(&Self, Interval); 2], value: Interval) -> Self {
        let may_be = operands.iter().filter(|(_, share)| share.hi > 0.0).map(|(operand, _)| **operand);
        let surely = operands.iter().any(|(_, share)| share.lo > 0.0)
            || operands.iter().all(|(_, share)| share.hi > 0.0);
        let nothing = (!surely).then(|| Self::flat(ZERO));
        let both = |a: Self, b: Self| Self {
            value,
            gradient: [0, 1, 2].map(|axis| a.gradient[axis].hull(b.gradient[axis])),
            squares: [0, 1, 2].map(|axis| a.squares[axis].max(b.squares[axis])),
        };
        let chosen = may_be.chain(nothing).reduce(both).unwrap_or(Self::flat(ZERO));
        Self { value, ..chosen }
    }
}

/// What a sum of squares may be multiplied by.
fn is_factor(a: &Sloped) -> bool {
    a.gradient == [ZERO; 3] && a.value.lo >= 0.0 && a.value.hi < f32::INFINITY
}

/// The chain rule; what does not change passes no slope on, however steep, and what is not steep none of any change.
#[inline(always)]
fn along(slope: Interval, change: Interval) -> Interval {
    if rules::is_zero(slope) || rules::is_zero(change) {
        return ZERO;
    }
    if slope.is_any() || change.is_any() {
        return Interval::ANY;
    }
    let product = |slope: f32, change: f32| if slope == 0.0 || change == 0.0 { 0.0 } else { slope * change };
    let [a, b, c, d] = [
        product(slope.lo, change.lo),
        product(slope.lo, change.hi),
        product(slope.hi, change.lo),
        product(slope.hi, change.hi),
    ];
    Interval { lo: a.min(b).min(c.min(d)), hi: a.max(b).max(c.max(d)) }
}
