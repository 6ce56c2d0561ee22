//! Interval rules of the partial derivatives: for all values in the operands' intervals, the result holds the slopes
//! that [`super::Op::slopes`] returns, and at a kink the slopes of both sides.
//!
//! **Jumps.** FLOOR, LESS, HASH and similar operators have slope 0 here, although nothing bounds the change across a
//! jump. In noise and repeated shapes, parts of a formula jump but their combination does not. The change of such a
//! combination is limited by the slopes on all pieces (the mean value theorem). The change of a value that jumps is
//! limited only between two jumps.
//!
//! **Rounding.** The ends of slopes are computed by the operations of [`super::Op::slopes`], in the same order.
//! Rounding to nearest is monotonic. Library functions are widened.

use super::interval::Interval;
use super::numbers::SMALLEST;
use super::rules;

const ZERO: Interval = Interval { lo: 0.0, hi: 0.0 };
pub(super) const ONE: Interval = Interval { lo: 1.0, hi: 1.0 };
/// The slopes near a vertical tangent: from 0 to infinity.
const NON_LIPSCHITZ: Interval = Interval { lo: 0.0, hi: f32::INFINITY };

#[inline(always)]
pub(super) const fn constant(by_a: f32, by_b: f32) -> (Interval, Interval) {
    (Interval { lo: by_a, hi: by_a }, Interval { lo: by_b, hi: by_b })
}

#[inline(always)]
pub(super) const fn first(by_a: Interval) -> (Interval, Interval) {
    (by_a, ZERO)
}

/// Returns the intersection of two intervals; `a` if rounding makes the intersection empty.
fn meet(a: Interval, b: Interval) -> Interval {
    if a.is_any() || b.is_any() {
        return if a.is_any() { b } else { a };
    }
    let both = Interval::new(a.lo.max(b.lo), a.hi.min(b.hi));
    if both.is_any() { a } else { both }
}

fn map_falling(a: Interval, f: impl Fn(f32) -> f32) -> Interval {
    Interval { lo: f(a.hi), hi: f(a.lo) }
}

#[inline(always)]
pub(super) fn abs(a: Interval) -> (Interval, Interval) {
    first(Interval { lo: if a.lo >= 0.0 { 1.0 } else { -1.0 }, hi: if a.hi < 0.0 { -1.0 } else { 1.0 } })
}

#[inline(always)]
pub(super) fn square(a: Interval) -> (Interval, Interval) {
    first(a.map_rising(|v| 2.0 * v))
}

pub(super) fn sqrt(r: Interval) -> (Interval, Interval) {
    if r.is_any() {
        return first(NON_LIPSCHITZ);
    }
    let slope = |r: f32| if r > 0.0 { 0.5 / r } else { f32::INFINITY };
    first(if rules::is_zero(r) {
        ZERO
    } else if r.lo > 0.0 {
        map_falling(r, slope)
    } else {
        NON_LIPSCHITZ
    })
}

/// Returns the slopes by a and by b of a function of a - b, whose slope by a is given.
#[inline(always)]
pub(super) fn opposite(by_a: Interval) -> (Interval, Interval) {
    (by_a, rules::neg(by_a))
}

/// Returns the slopes of sqrt(a * a + b), whose value is `r`.
pub(super) fn length(a: Interval, r: Interval) -> (Interval, Interval) {
    let by_sum = sqrt(r).0;
    let by_a = rules::mul(square(a).0, by_sum);
    (if by_a.is_any() { Interval::ALL } else { by_a }, by_sum)
}

pub(super) fn exp2(r: Interval) -> (Interval, Interval) {
    first(r.map_rising(|r| r * std::f32::consts::LN_2))
}

/// Returns the slope of a logarithm whose slope at 1 is `scale`.
pub(super) fn log(a: Interval, scale: f32) -> (Interval, Interval) {
    if a.lo > SMALLEST {
        return first(map_falling(a, |v| scale / v));
    }
    first(if a.hi <= SMALLEST { ZERO } else { Interval { lo: 0.0, hi: scale / SMALLEST } })
}

pub(super) fn tan(r: Interval) -> (Interval, Interval) {
    first(rules::add(ONE, rules::square(r)))
}

pub(super) fn tanh(r: Interval) -> (Interval, Interval) {
    first(rules::sub(ONE, rules::square(r)))
}

/// Returns the slope of the arc sine: 0 beyond -1..1, infinite at both ends.
pub(super) fn arc(a: Interval) -> Interval {
    let size = rules::abs(a);
    if size.lo >= 1.0 {
        return ZERO;
    }
    let slope = |v: f32| (1.0 - v * v).sqrt().recip();
    if size.hi < 1.0 { size.map_rising(slope) } else { NON_LIPSCHITZ }
}

pub(super) fn atan(a: Interval) -> (Interval, Interval) {
    first(map_falling(rules::abs(a), |v| (1.0 + v * v).recip()))
}

pub(super) fn div(a: Interval, b: Interval, r: Interval) -> (Interval, Interval) {
    if b.is_any() {
        return (Interval::ANY, Interval::ANY);
    }
    if rules::is_zero(b) {
        return constant(0.0, 0.0);
    }
    if !b.has_zero() {
        return (map_falling(b, f32::recip), rules::neg(rules::div(r, b)));
    }
    let by_a = Interval {
        lo: if b.lo >= 0.0 { 0.0 } else { f32::NEG_INFINITY },
        hi: if b.hi <= 0.0 { 0.0 } else { f32::INFINITY },
    };
    let by_b = if rules::is_zero(a) {
        ZERO
    } else if a.is_any() || a.is_unbounded() {
        Interval::ANY
    } else {
        Interval::ALL
    };
    (by_a, by_b)
}

pub(super) fn modulo(a: Interval, b: Interval) -> (Interval, Interval) {
    (ONE, rules::neg(rules::div(a, b).map_rising(f32::floor)))
}

/// Returns the slopes of the smaller of two operands. They are unknown if either operand may be the smaller one or if
/// the operands' intervals touch.
#[inline(always)]
pub(super) fn min(a: Interval, b: Interval) -> (Interval, Interval) {
    let (a_is_less, b_is_less) = (a.hi < b.lo, b.hi < a.lo);
    (rules::truth(a_is_less, b_is_less), rules::truth(b_is_less, a_is_less))
}

/// Up to this exponent b, the slope of a power is computed in two ways: as b * power / base, and as b * base^(b - 1).
const OWN_POWER_MAX: f32 = 64.0;
/// The second result is ignored below this limit: it may come from denormal numbers, which are rounded coarsely.
const ROUNDED_BADLY: f32 = 1e-3;

pub(super) fn pow(a: Interval, b: Interval, r: Interval) -> (Interval, Interval) {
    if a.hi < SMALLEST {
        return constant(0.0, 0.0);
    }
    if a.is_any() || b.is_any() {
        return (Interval::ANY, Interval::ANY);
    }
    let base = Interval { lo: a.lo.max(SMALLEST), hi: a.hi };
    let mut by_a = rules::div(rules::mul(b, r), base);
    if b.lo >= 0.0 && b.hi <= OWN_POWER_MAX && r.hi < f32::INFINITY {
        // The second way, without a division by a value near 0. Both results differ only by rounding.
        let power = rules::mul(b, rules::pow(base, rules::sub(b, ONE)));
        if power.hi > ROUNDED_BADLY {
            by_a = meet(by_a, Interval { lo: 0.0, hi: power.hi * 1.001 });
        }
    }
    let by_b = rules::mul(r, rules::logarithm(base, f32::ln));
    if a.lo < SMALLEST { (by_a.hull(ZERO), by_b.hull(ZERO)) } else { (by_a, by_b) }
}

pub(super) fn atan2(a: Interval, b: Interval) -> (Interval, Interval) {
    if a.is_any() || b.is_any() || a.is_unbounded() || b.is_unbounded() {
        return (Interval::ANY, Interval::ANY);
    }
    let d = rules::add(rules::square(a), rules::square(b));
    let positive = d.lo > 0.0;
    if !positive {
        return (Interval::ALL, Interval::ALL);
    }
    // The magnitude of the slope is at most 1 divided by the distance from the origin.
    let most = if d.lo > SMALLEST / f32::EPSILON { d.lo.sqrt().recip() * 1.001 } else { f32::INFINITY };
    let most = Interval { lo: -most, hi: most };
    (meet(rules::div(b, d), most), meet(rules::neg(rules::div(a, d)), most))
}
