//! The limits of this crate.

use mariana_field::limits::LIMITS as FIELD_LIMITS;

/// Maximum number of bytes of a text, the same as the language's limit.
pub const TEXT_BYTES_MAX: usize = FIELD_LIMITS.scene_bytes_max;
/// Maximum number of bytes of the undo history. The oldest steps are dropped first.
pub const UNDO_BYTES_MAX: usize = 16 << 20;
/// Maximum number of changes in the log that maps ranges of earlier versions to the present text.
pub const FOLLOWED_CHANGES_MAX: usize = 1_024;
/// Maximum number of completion candidates. The list shows the best ones.
pub const PROPOSALS_MAX: usize = 64;
