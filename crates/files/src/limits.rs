//! The limits on user files. Code, error messages and tests read them from here.

/// Maximum size of a text in the editor or in a backup, in bytes, including the backup's first line.
pub const KEPT_TEXT_BYTES_MAX: usize = (1 << 20) + (1 << 16);
