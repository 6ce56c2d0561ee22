//! Every limit on the files of a user.
//!
//! Code, error messages and tests all read the limits from here.

/// Limits on what is read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Most bytes of a text that is edited or kept unsaved, with what is said of it.
    pub kept_text_bytes_max: usize,
}

/// The limits in force.
pub const LIMITS: Limits = Limits { kept_text_bytes_max: (1 << 20) + (1 << 16) };
