//! Every ceiling of this crate, in one place.

use mariana_field::limits::LIMITS as FIELD_LIMITS;

/// Ceilings on what is edited.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Most bytes of a text: what the language takes.
    pub text_bytes_max: usize,
    /// Most bytes that are kept to undo changes; the oldest go first.
    pub undo_bytes_max: usize,
    /// Most changes since a version of the text through which a place of that version is followed.
    pub followed_changes_max: usize,
    /// Most proposals for what may be written at a place.
    pub proposals_max: usize,
}

/// The limits that apply.
pub const LIMITS: Limits = Limits {
    text_bytes_max: FIELD_LIMITS.scene_bytes_max,
    undo_bytes_max: 16 << 20,
    followed_changes_max: 1_024,
    proposals_max: 64,
};
