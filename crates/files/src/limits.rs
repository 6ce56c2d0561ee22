//! Every limit on the files of a user.
//!
//! A limit is data: code that applies one reads it here, an error that reports one gives the number defined here, and
//! a test reaches it.

/// Limits on what is read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Most bytes of a text that is edited or kept unsaved, with what is said of it.
    pub kept_text_bytes_max: usize,
}

/// The limits in force.
pub const LIMITS: Limits = Limits { kept_text_bytes_max: (1 << 20) + (1 << 16) };
