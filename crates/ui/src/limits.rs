//! The limits of this crate. Code, error messages and tests all read them from here.

/// Limits on what the panels show.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Maximum number of entries of a folder in the file list. Further entries of the folder are left out.
    pub folder_entries_max: usize,
    /// Maximum number of distinct characters to search for in the system's fonts. All other characters show a box.
    pub letters_looked_for_max: usize,
}

/// The limits in force.
pub const LIMITS: Limits = Limits { folder_entries_max: 20_000, letters_looked_for_max: 20_000 };
