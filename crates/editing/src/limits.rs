//! The limits of this crate.

use mariana_field::limits::LIMITS as FIELD_LIMITS;

/// Limits on an edited text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Maximum number of bytes of a text, the same as the language's limit.
    pub text_bytes_max: usize,
    /// Maximum number of bytes of the undo history. The oldest steps are dropped first.
    pub undo_bytes_max: usize,
    /// Maximum number of changes in the log that maps ranges of earlier versions to the present text.
    pub followed_changes_max: usize,
    /// Maximum number of completion candidates. The list shows the best ones.
    pub proposals_max: usize,
}

/// The limits in force.
pub const LIMITS: Limits = Limits {
    text_bytes_max: FIELD_LIMITS.scene_bytes_max,
    undo_bytes_max: 16 << 20,
    followed_changes_max: 1_024,
    proposals_max: 64,
};
