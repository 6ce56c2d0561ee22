//! Intervals of f32.

/// All f32 from `lo` to `hi`, including infinities but no NaN; or [`Interval::ANY`], which includes NaN.
///
/// An interval bounds the values that the CPU computes with rounding to nearest. In plain arithmetic, the ends are
/// rounded in the same way as the values. In library functions, the ends are widened by [`LIBRARY_ERROR`].
#[derive(Debug, Clone, Copy)]
pub struct Interval {
    /// Lower end.
    pub lo: f32,
    /// Upper end.
    pub hi: f32,
}

/// Relative widening of the results of library functions: 4 units in the last place.
pub const LIBRARY_ERROR: f32 = 4.768_371_6e-7;

impl Interval {
    /// Any value, NaN included. Both ends are NaN, so that every comparison with them is false.
    pub const ANY: Self = Self { lo: f32::NAN, hi: f32::NAN };
    /// Any value but a NaN.
    pub const ALL: Self = Self { lo: f32::NEG_INFINITY, hi: f32::INFINITY };
    /// From 0 to 1.
    pub const UNIT: Self = Self { lo: 0.0, hi: 1.0 };

    /// Returns the interval from `lo` to `hi`; [`Interval::ANY`] unless `lo <= hi`.
    #[inline(always)]
    pub fn new(lo: f32, hi: f32) -> Self {
        if lo <= hi { Self { lo, hi } } else { Self::ANY }
    }

    /// One value; [`Interval::ANY`] for a NaN.
    #[inline(always)]
    pub fn point(value: f32) -> Self {
        Self { lo: value, hi: value }
    }

    /// True if this is [`Interval::ANY`].
    #[inline(always)]
    pub fn is_any(self) -> bool {
        self.lo.is_nan()
    }

    /// True if the interval holds a value.
    #[inline(always)]
    pub fn contains(self, value: f32) -> bool {
        self.is_any() || (self.lo <= value && value <= self.hi)
    }

    /// True if an end is infinite, or if this is [`Interval::ANY`].
    #[inline(always)]
    pub fn is_unbounded(self) -> bool {
        !(self.lo > f32::NEG_INFINITY && self.hi < f32::INFINITY)
    }

    /// True if the interval holds 0.
    #[inline(always)]
    pub fn has_zero(self) -> bool {
        self.contains(0.0)
    }

    /// Returns the smallest interval that holds both intervals.
    #[inline(always)]
    pub fn hull(self, other: Self) -> Self {
        if self.is_any() || other.is_any() {
            return Self::ANY;
        }
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// Returns bounds of `f`, a non-decreasing and correctly rounded function.
    #[inline(always)]
    pub fn map_rising(self, f: impl Fn(f32) -> f32) -> Self {
        Self { lo: f(self.lo), hi: f(self.hi) }
    }

    /// This interval, widened by [`LIBRARY_ERROR`] on both sides.
    #[inline(always)]
    pub(super) fn widened(self) -> Self {
        if self.is_any() {
            return self;
        }
        // If an end overflowed to infinity, the true value may still be the largest finite number.
        let (lo, hi) = (self.lo.min(f32::MAX), self.hi.max(f32::MIN));
        let below = lo - (lo.abs() * LIBRARY_ERROR + f32::MIN_POSITIVE);
        let above = hi + (hi.abs() * LIBRARY_ERROR + f32::MIN_POSITIVE);
        Self::new(below, above)
    }

    #[inline(always)]
    pub(super) fn clamped(self, low: f32, high: f32) -> Self {
        if self.is_any() { self } else { Self { lo: self.lo.clamp(low, high), hi: self.hi.clamp(low, high) } }
    }
}

impl PartialEq for Interval {
    /// True if both ends are equal. [`Interval::ANY`] equals itself.
    fn eq(&self, other: &Self) -> bool {
        (self.is_any() && other.is_any()) || (self.lo == other.lo && self.hi == other.hi)
    }
}
