//! Every limit of the panels.
//!
//! Code, error messages and tests all read the limits from here.

/// Limits on what the panels show.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Most entries of a folder that are listed in the window.
    pub folder_entries_max: usize,
    /// Most letters that are looked for among the system's fonts.
    pub letters_looked_for_max: usize,
}

/// The limits in force.
pub const LIMITS: Limits = Limits { folder_entries_max: 20_000, letters_looked_for_max: 20_000 };
