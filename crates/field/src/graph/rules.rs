//! The interval rules of the operators: for all values in the operands' intervals, the result holds the value that
//! the CPU computes.
//!
//! Rounding to nearest is monotonic, so ends computed in f32 bound every value computed in f32. Library functions need
//! not be monotonic everywhere where the true function is, so their ends are widened by more than their error
//! ([`super::interval::LIBRARY_ERROR`]). Interval arithmetic: Moore, Kearfott and Cloud, Introduction to Interval
//! Analysis (2009), chapters 2 and 5.

use std::f32::consts::{FRAC_PI_2, PI};

use super::interval::{Interval, LIBRARY_ERROR};
use super::numbers::{self, SMALLEST};

/// Up to this angle in radians, f64 is precise enough to find the position in the period. Beyond it, bounds are -1..1.
const ANGLE_MAX: f32 = 1e5;
/// If an operand or the quotient exceeds this magnitude, MOD may overflow, and its bounds are infinite.
const MODULO_MAX: f32 = 1e30;

#[inline(always)]
pub(super) fn is_zero(a: Interval) -> bool {
    a.lo == 0.0 && a.hi == 0.0
}

#[inline(always)]
pub(super) fn neg(a: Interval) -> Interval {
    Interval { lo: -a.hi, hi: -a.lo }
}

#[inline(always)]
pub(super) fn abs(a: Interval) -> Interval {
    if a.lo >= 0.0 {
        a
    } else if a.hi <= 0.0 {
        neg(a)
    } else if a.is_any() {
        a
    } else {
        Interval { lo: 0.0, hi: a.hi.max(-a.lo) }
    }
}

#[inline(always)]
pub(super) fn sign(a: Interval) -> Interval {
    if a.is_any() {
        return Interval { lo: -1.0, hi: 1.0 };
    }
    let sign = |v: f32| f32::from(i8::from(v > 0.0) - i8::from(v < 0.0));
    a.map_rising(sign)
}

#[inline(always)]
pub(super) fn fract(a: Interval) -> Interval {
    let cell = a.lo.floor();
    if a.is_unbounded() {
        Interval::ANY
    } else if cell == a.hi.floor() {
        Interval { lo: a.lo - cell, hi: a.hi - cell }
    } else {
        Interval::UNIT
    }
}

#[inline(always)]
pub(super) fn square(a: Interval) -> Interval {
    let a = abs(a);
    Interval { lo: a.lo * a.lo, hi: a.hi * a.hi }
}

#[inline(always)]
pub(super) fn sqrt(a: Interval) -> Interval {
    if a.is_any() {
        return Interval { lo: 0.0, hi: f32::INFINITY };
    }
    a.map_rising(numbers::sqrt)
}

/// Returns bounds of a power `f` of a fixed base.
pub(super) fn exponential(a: Interval, f: impl Fn(f32) -> f32) -> Interval {
    a.map_rising(f).widened().clamped(0.0, f32::INFINITY)
}

pub(super) fn logarithm(a: Interval, f: impl Fn(f32) -> f32) -> Interval {
    let a = if a.is_any() { Interval::ALL } else { a };
    a.map_rising(|v| f(v.max(SMALLEST))).widened()
}

pub(super) fn sin(a: Interval) -> Interval {
    wave(a, f32::sin, std::f64::consts::FRAC_PI_2)
}

pub(super) fn cos(a: Interval) -> Interval {
    wave(a, f32::cos, 0.0)
}

/// Returns bounds of a sine or cosine `f` with maxima at `crest` + 2πk and minima half a period after each maximum.
fn wave(a: Interval, f: fn(f32) -> f32, crest: f64) -> Interval {
    use std::f64::consts::{PI, TAU};
    if a.is_any() || a.is_unbounded() {
        return Interval::ANY;
    }
    if a.lo < -ANGLE_MAX || a.hi > ANGLE_MAX {
        return Interval { lo: -1.0, hi: 1.0 };
    }
    let (lo, hi) = (f64::from(a.lo), f64::from(a.hi));
    let reaches = |place: f64| ((lo - place) / TAU).ceil() * TAU + place <= hi;
    let (start, end) = (f(a.lo), f(a.hi));
    let ends = Interval { lo: start.min(end), hi: start.max(end) }.widened().clamped(-1.0, 1.0);
    Interval {
        lo: if reaches(crest + PI) { -1.0 } else { ends.lo },
        hi: if reaches(crest) { 1.0 } else { ends.hi },
    }
}

pub(super) fn tan(a: Interval) -> Interval {
    use std::f64::consts::{FRAC_PI_2, PI};
    if a.is_any() || a.is_unbounded() {
        return Interval::ANY;
    }
    let (lo, hi) = (f64::from(a.lo), f64::from(a.hi));
    let pole = ((lo - FRAC_PI_2) / PI).ceil() * PI + FRAC_PI_2;
    if a.lo < -ANGLE_MAX || a.hi > ANGLE_MAX || pole <= hi {
        return Interval::ALL;
    }
    a.map_rising(f32::tan).widened()
}

pub(super) fn asin(a: Interval) -> Interval {
    if a.is_any() {
        return Interval { lo: -FRAC_PI_2, hi: FRAC_PI_2 }.widened();
    }
    a.clamped(-1.0, 1.0).map_rising(f32::asin).widened()
}

pub(super) fn acos(a: Interval) -> Interval {
    if a.is_any() {
        return Interval { lo: 0.0, hi: PI }.widened().clamped(0.0, f32::INFINITY);
    }
    let a = a.clamped(-1.0, 1.0);
    Interval { lo: a.hi.acos(), hi: a.lo.acos() }.widened().clamped(0.0, f32::INFINITY)
}

pub(super) fn cosh(a: Interval) -> Interval {
    abs(a).map_rising(f32::cosh).widened()
}

pub(super) fn tanh(a: Interval) -> Interval {
    if a.is_any() {
        return Interval { lo: -1.0, hi: 1.0 };
    }
    a.map_rising(numbers::tanh).widened().clamped(-1.0, 1.0)
}

/// 1 if the condition is always true, 0 if it is never true, else 0..1.
#[inline(always)]
pub(super) fn truth(surely: bool, never: bool) -> Interval {
    if surely {
        Interval::point(1.0)
    } else if never {
        Interval::point(0.0)
    } else {
        Interval::UNIT
    }
}

#[inline(always)]
pub(super) fn not(a: Interval) -> Interval {
    truth(is_zero(a), !a.has_zero())
}

#[inline(always)]
pub(super) fn less(a: Interval, b: Interval) -> Interval {
    truth(a.hi < b.lo, a.lo >= b.hi)
}

#[inline(always)]
pub(super) fn less_equal(a: Interval, b: Interval) -> Interval {
    truth(a.hi <= b.lo, a.lo > b.hi)
}

#[inline(always)]
pub(super) fn equal(a: Interval, b: Interval) -> Interval {
    truth(a.lo == b.hi && a.hi == b.lo, a.hi < b.lo || a.lo > b.hi)
}

#[inline(always)]
pub(super) fn mask(a: Interval, b: Interval) -> Interval {
    if !a.has_zero() {
        b
    } else if is_zero(a) {
        Interval::point(0.0)
    } else {
        b.hull(Interval::point(0.0))
    }
}

#[inline(always)]
pub(super) fn hash(a: Interval, b: Interval) -> Interval {
    if a.lo.floor() == a.hi.floor() && b.lo.floor() == b.hi.floor() {
        Interval::point(numbers::cell_hash(a.lo, b.lo))
    } else {
        Interval::UNIT
    }
}

/// Returns bounds of a + b. The sum of infinities of opposite signs is a NaN.
#[inline(always)]
pub(super) fn add(a: Interval, b: Interval) -> Interval {
    if (a.lo == f32::NEG_INFINITY && b.hi == f32::INFINITY)
        || (a.hi == f32::INFINITY && b.lo == f32::NEG_INFINITY)
    {
        return Interval::ANY;
    }
    Interval { lo: a.lo + b.lo, hi: a.hi + b.hi }
}

#[inline(always)]
pub(super) fn sub(a: Interval, b: Interval) -> Interval {
    add(a, neg(b))
}

#[inline(always)]
fn hull_of(values: [f32; 4]) -> Interval {
    let [a, b, c, d] = values;
    Interval::new(a.min(b).min(c.min(d)), a.max(b).max(c.max(d)))
}

/// Returns bounds of a * b. The product of 0 and an infinity is a NaN.
#[inline(always)]
pub(super) fn mul(a: Interval, b: Interval) -> Interval {
    if (a.is_unbounded() && b.has_zero()) || (b.is_unbounded() && a.has_zero()) {
        return Interval::ANY;
    }
    hull_of([a.lo * b.lo, a.lo * b.hi, a.hi * b.lo, a.hi * b.hi])
}

/// Returns bounds of a / b. Division by exactly 0 gives 0; near b = 0, quotients are unbounded.
#[inline(always)]
pub(super) fn div(a: Interval, b: Interval) -> Interval {
    if a.is_any() || b.is_any() || (a.is_unbounded() && b.is_unbounded()) {
        return Interval::ANY;
    }
    if !b.has_zero() {
        return hull_of([a.lo / b.lo, a.lo / b.hi, a.hi / b.lo, a.hi / b.hi]);
    }
    if is_zero(b) || is_zero(a) {
        return Interval::point(0.0);
    }
    let (positive, negative) = (b.hi > 0.0, b.lo < 0.0);
    let grows = (a.hi > 0.0 && positive) || (a.lo < 0.0 && negative);
    let falls = (a.lo < 0.0 && positive) || (a.hi > 0.0 && negative);
    Interval { lo: if falls { f32::NEG_INFINITY } else { 0.0 }, hi: if grows { f32::INFINITY } else { 0.0 } }
}

/// Returns bounds of min(a, b). The minimum of a NaN and a number is the number.
#[inline(always)]
pub(super) fn min(a: Interval, b: Interval) -> Interval {
    match (a.is_any(), b.is_any()) {
        (true, true) => Interval::ANY,
        (true, false) => Interval { lo: f32::NEG_INFINITY, hi: b.hi },
        (false, true) => Interval { lo: f32::NEG_INFINITY, hi: a.hi },
        _ => Interval { lo: a.lo.min(b.lo), hi: a.hi.min(b.hi) },
    }
}

#[inline(always)]
pub(super) fn max(a: Interval, b: Interval) -> Interval {
    neg(min(neg(a), neg(b)))
}

/// If both ends of a are in one period, the value increases with a. Otherwise the value is between 0 and b. Rounding
/// may move the value out of this range, by an error proportional to the operands.
pub(super) fn modulo(a: Interval, b: Interval) -> Interval {
    if a.is_unbounded() || b.is_unbounded() {
        return Interval::ANY;
    }
    if is_zero(b) {
        return a;
    }
    let size = a.lo.abs().max(a.hi.abs());
    let step = b.lo.abs().max(b.hi.abs());
    let smallest = b.lo.abs().min(b.hi.abs());
    if b.has_zero() || size.max(step).max(size / smallest) > MODULO_MAX {
        // The quotient may overflow, but it cannot be a NaN because both operands are finite.
        return Interval::ALL;
    }
    if b.lo == b.hi && (a.lo / b.lo).floor() == (a.hi / b.lo).floor() {
        return Interval::new(numbers::modulo(a.lo, b.lo), numbers::modulo(a.hi, b.lo));
    }
    let error = (size + step) * LIBRARY_ERROR + f32::MIN_POSITIVE;
    Interval { lo: b.lo.min(0.0) - error, hi: b.hi.max(0.0) + error }
}

/// For positive bases, the extremes are where both operands are at an end of their intervals.
pub(super) fn pow(a: Interval, b: Interval) -> Interval {
    if b.is_any() {
        return Interval::ANY;
    }
    if a.is_any() {
        return Interval { lo: 0.0, hi: f32::INFINITY };
    }
    let mut hull: Option<Interval> = None;
    let mut include = |part: Interval| hull = Some(hull.map_or(part, |hull| hull.hull(part)));
    if a.hi >= SMALLEST {
        let low = a.lo.max(SMALLEST);
        let corners = [low.powf(b.lo), low.powf(b.hi), a.hi.powf(b.lo), a.hi.powf(b.hi)];
        include(hull_of(corners).widened().clamped(0.0, f32::INFINITY));
    }
    if a.lo < SMALLEST {
        if !is_zero(b) {
            include(Interval::point(0.0));
        }
        if b.has_zero() {
            include(Interval::point(1.0));
        }
    }
    hull.unwrap_or(Interval::ANY)
}

/// Returns bounds of the angle of the point (b, a). It is π where a = 0 and b < 0, and jumps to -π below.
pub(super) fn atan2(a: Interval, b: Interval) -> Interval {
    if a.is_any() || b.is_any() {
        return Interval::ANY;
    }
    if a.lo < 0.0 && a.hi >= 0.0 && b.lo < 0.0 {
        return Interval { lo: -PI, hi: PI }.widened();
    }
    let corner = numbers::atan2;
    let hull = hull_of([corner(a.lo, b.lo), corner(a.lo, b.hi), corner(a.hi, b.lo), corner(a.hi, b.hi)]);
    let hull = if a.has_zero() && b.has_zero() { hull.hull(Interval::point(0.0)) } else { hull };
    hull.widened()
}
