//! The operand that a minimum, maximum or mask chooses everywhere in an interval. Pruning removes the other operand.

use super::interval::Interval;
use super::op::{Op, Properties};
use super::rules;

/// The operand that an operator chooses everywhere in an interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[repr(u8)]
pub enum Choice {
    /// Unknown: either operand may be the value.
    #[default]
    Both,
    /// The value is operand a everywhere. For MASK, the value is 0 everywhere.
    Left,
    /// The value is operand b everywhere.
    Right,
}

impl Op {
    /// True if [`Op::choice`] can return [`Choice::Left`] or [`Choice::Right`].
    pub const fn chooses(self) -> bool {
        self.properties().has(Properties::CHOOSES)
    }

    /// Returns the operand that the operator chooses for all values in `a` and `b`. Returns [`Choice::Both`] if the
    /// choice depends on the values, or if an operand of a minimum or maximum may be a NaN.
    #[inline]
    pub fn choice(self, a: Interval, b: Interval) -> Choice {
        let (left, right) = match self {
            Op::Min => (a.hi <= b.lo, b.hi <= a.lo),
            Op::Max => (a.lo >= b.hi, b.lo >= a.hi),
            Op::Mask => (rules::is_zero(a), !a.has_zero()),
            _ => (false, false),
        };
        match (left, right) {
            (true, _) => Choice::Left,
            (_, true) => Choice::Right,
            _ => Choice::Both,
        }
    }
}
