//! The limits on user files. Code, error messages and tests read them from here.

/// Limits on the size of files.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Maximum size of a text in the editor or in a backup, in bytes, including the backup's first line.
    pub kept_text_bytes_max: usize,
}

/// The limits in force.
pub const LIMITS: Limits = Limits { kept_text_bytes_max: (1 << 20) + (1 << 16) };
