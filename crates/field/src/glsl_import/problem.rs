//! A mistake in a GLSL text, with its place in the text as the user wrote it.

use std::ops::Range;

use crate::lang::Fault;

/// A result of reading or executing GLSL.
pub(super) type Result<T, E = Problem> = std::result::Result<T, E>;

/// One problem in a GLSL text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// The kind.
    pub kind: Fault,
    /// The message, one sentence without its full stop.
    pub message: String,
    /// The advice on how to fix the problem; may be empty.
    pub hint: String,
    /// The bytes of the GLSL text that the message is about.
    pub place: Range<u32>,
}

impl Problem {
    pub(super) fn malformed(place: Range<u32>, message: impl Into<String>) -> Self {
        let (message, hint) = (message.into(), String::new());
        Self { kind: Fault::Malformed, message, hint, place }
    }

    pub(super) fn unsupported(place: Range<u32>, message: impl Into<String>) -> Self {
        Self { kind: Fault::Unsupported, ..Self::malformed(place, message) }
    }

    pub(super) fn over_limit(place: Range<u32>, message: impl Into<String>) -> Self {
        Self { kind: Fault::OverLimit, ..Self::malformed(place, message) }
    }

    pub(super) fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = hint.into();
        self
    }
}
