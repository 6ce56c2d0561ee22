//! Bounds of a value and of its gradient over a box, by forward accumulation (Moore, Kearfott and Cloud 2009, section
//! 6.4; Griewank and Walther 2008, chapter 3).

use super::frame_inputs::FrameInputs;
use super::interval::Interval;
use super::op::Op;
use super::rules;

/// Bounds of a value and of its derivatives by x, y and z over a box. At a kink the bounds hold the slopes of both
/// sides. Jumps have no slope (see `slope_rules.rs`).
///
/// **Lengths.** The slope of a square root is unbounded at 0, but the slope of a length is not. With s = Σ aᵢ² and r
/// = √s, ∂r/∂x = Σ (aᵢ/r) ∂aᵢ/∂x. Since Σ (aᵢ/r)² = 1, the Cauchy-Schwarz inequality gives |∂r/∂x| ≤ √(Σ (∂aᵢ/∂x)²).
/// A sum of squares therefore carries Σ (∂aᵢ/∂x)² along until its root is taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GradientInterval {
    /// The value.
    pub value: Interval,
    /// The gradient.
    pub gradient: [Interval; 3],
    /// For each axis, an upper bound of Σ (∂aᵢ)² if the value is known to be Σ aᵢ² or a constant >= 0; else infinite.
    squares: [f32; 3],
}

const ZERO: Interval = Interval { lo: 0.0, hi: 0.0 };
/// A factor greater than all rounding errors together: of a sum of squares, of its root and of both slopes.
const LENGTH_ERROR: f32 = 1.0 + 1e-4;

impl GradientInterval {
    /// Returns bounds of a value that is the same everywhere in the box: a constant or an input of the frame.
    #[inline(always)]
    pub fn flat(value: Interval) -> Self {
        let squares = if value.lo >= 0.0 { [0.0; 3] } else { [f32::INFINITY; 3] };
        Self { value, gradient: [ZERO; 3], squares }
    }

    /// Returns bounds of the coordinate along `axis`, 0..3.
    #[inline(always)]
    pub fn coordinate(axis: usize, value: Interval) -> Self {
        let gradient = [0, 1, 2].map(|each| Interval::point(if each == axis { 1.0 } else { 0.0 }));
        Self { value, gradient, squares: [f32::INFINITY; 3] }
    }

    /// Applies a one-operand operator.
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
                    // `change` may be a NaN where the root's slope is unbounded. Then `max` and `min` return `most`.
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

    /// Applies a two-operand operator.
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

    /// Applies an operator and splits fused ones: sums of squares are recognized only in separate operators.
    pub fn in_parts(op: Op, a: &Self, b: &Self, frame: &FrameInputs) -> Self {
        let one = |op: Op, a: &Self| Self::unary(op, a, frame);
        let two = |op: Op, a: &Self, b: &Self| Self::binary(op, a, b, frame);
        match op {
            Op::SquareAdd => two(Op::Add, &one(Op::Square, a), b),
            Op::OutsideAdd => {
                let outside = two(Op::Max, a, &Self::flat(ZERO));
                two(Op::Add, &one(Op::Square, &outside), b)
            }
            Op::SquareDifference => one(Op::Square, &two(Op::Sub, a, b)),
            Op::AbsDifference => one(Op::Abs, &two(Op::Sub, a, b)),
            Op::AbsSub => two(Op::Sub, &one(Op::Abs, a), b),
            Op::SqrtSub => two(Op::Sub, &one(Op::Sqrt, a), b),
            Op::Length => one(Op::Sqrt, &two(Op::Add, &one(Op::Square, a), b)),
            _ if op.arity() == 1 => one(op, a),
            _ => two(op, a, b),
        }
    }

    /// Returns the slopes of the chosen operand, or the hull of both operands' slopes if the choice is unknown.
    fn chosen(operands: [(&Self, Interval); 2], value: Interval) -> Self {
        let may_be = operands.iter().filter(|(_, fraction)| fraction.hi > 0.0).map(|(operand, _)| **operand);
        let surely = operands.iter().any(|(_, fraction)| fraction.lo > 0.0)
            || operands.iter().all(|(_, fraction)| fraction.hi > 0.0);
        let nothing = (!surely).then(|| Self::flat(ZERO));
        let chosen = may_be.chain(nothing).reduce(|a, b| a.hull(&b)).unwrap_or(Self::flat(ZERO));
        Self { value, ..chosen }
    }

    /// Returns the only plane in the box where an operator jumps: its axis and coordinate. Else `None`.
    pub fn jump(op: Op, a: &Self, b: &Self, sides: [Interval; 3]) -> Option<(usize, f32)> {
        let offset = match op {
            Op::Floor | Op::Ceil | Op::Trunc | Op::Fract => 0.0,
            Op::Round => 0.5,
            Op::Less | Op::LessEqual | Op::Step => {
                let gradient = [0, 1, 2].map(|axis| rules::sub(a.gradient[axis], b.gradient[axis]));
                return Self { value: rules::sub(a.value, b.value), gradient, ..*a }.place_of(0.0, sides);
            }
            _ => return None,
        };
        let place = (a.value.lo - offset).floor() + 1.0 + offset;
        a.place_of(place, sides)
    }

    /// Returns the axis and the coordinate inside the box at which the value is `wanted`. Returns `None` unless the
    /// value changes linearly along only one axis and stays below `wanted` + 1, so that the box contains one jump.
    fn place_of(&self, wanted: f32, sides: [Interval; 3]) -> Option<(usize, f32)> {
        let inside = self.value.lo < wanted && wanted < self.value.hi && self.value.hi < wanted + 1.0;
        let mut along = (0..3).filter(|axis| !rules::is_zero(self.gradient[*axis]));
        let axis = along.next().filter(|_| inside && along.next().is_none())?;
        let slope = self.gradient[axis];
        if slope.lo != slope.hi {
            return None;
        }
        let start = if slope.lo > 0.0 { self.value.lo } else { self.value.hi };
        let place = sides[axis].lo + (wanted - start) / slope.lo;
        (sides[axis].lo < place && place < sides[axis].hi).then_some((axis, place))
    }

    /// Returns the smallest bounds that hold the values and gradients of `self` and `other`.
    pub fn hull(&self, other: &Self) -> Self {
        Self {
            value: self.value.hull(other.value),
            gradient: [0, 1, 2].map(|axis| self.gradient[axis].hull(other.gradient[axis])),
            squares: [0, 1, 2].map(|axis| self.squares[axis].max(other.squares[axis])),
        }
    }
}

/// A box that is cut where parts of a formula jump. In each piece the slopes belong to one side of the jump, so their
/// bounds are much tighter than over the whole box. Noise needs such cuts: it is smooth, but its parts jump at the
/// borders of its cells.
#[derive(Debug, Clone, Default)]
pub struct Pieces {
    cuts: Vec<(usize, f32)>,
    boxes: Vec<[Interval; 3]>,
}

/// Maximum number of pieces of a box. Cuts that would make more pieces are ignored.
const PIECES_MAX: usize = 32;
/// The gap on each side of a jump, as a fraction of its coordinate plus the box's side. Wider than rounding errors.
const JUMP_WIDTH: f32 = 2e-6;

impl Pieces {
    /// Removes all jumps.
    pub fn clear(&mut self) {
        self.cuts.clear();
    }

    /// Adds a jump.
    #[inline(always)]
    pub fn add(&mut self, jump: Option<(usize, f32)>) {
        if let Some(jump) = jump.filter(|jump| !self.cuts.contains(jump)) {
            self.cuts.push(jump);
        }
    }

    /// Returns the pieces into which the jumps cut the box; empty if there are no jumps.
    pub fn of(&mut self, sides: [Interval; 3]) -> &[[Interval; 3]] {
        self.boxes.clear();
        if self.cuts.is_empty() {
            return &self.boxes;
        }
        self.boxes.push(sides);
        for &(axis, place) in &self.cuts {
            let width = JUMP_WIDTH * (place.abs() + sides[axis].hi - sides[axis].lo);
            for index in 0..self.boxes.len() {
                let (mut below, mut above) = (self.boxes[index], self.boxes[index]);
                (below[axis].hi, above[axis].lo) = (place - width, place + width);
                let cuts = below[axis].lo < below[axis].hi && above[axis].lo < above[axis].hi;
                if cuts && self.boxes.len() < PIECES_MAX {
                    self.boxes[index] = below;
                    self.boxes.push(above);
                }
            }
        }
        &self.boxes
    }
}

/// True if the product of `a` and a sum of squares is also a sum of squares.
fn is_factor(a: &GradientInterval) -> bool {
    a.gradient == [ZERO; 3] && a.value.lo >= 0.0 && a.value.hi < f32::INFINITY
}

/// Multiplies two slopes by the chain rule. If one slope is exactly 0 (a constant operand or a flat function), the
/// product is 0, even if the other slope is infinite.
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
