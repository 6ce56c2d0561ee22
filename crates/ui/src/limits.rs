//! The limits of this crate. Code, error messages and tests all read them from here.

/// Limits on what the panels show.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Maximum number of entries of a folder in the file list. Further entries of the folder are left out.
    pub folder_entries_max: usize,
    /// Maximum number of folders that are read at the same time. More folders are read when one of them answers.
    pub folders_read_max: usize,
    /// Maximum number of mounted disks in the file list.
    pub media_places_max: usize,
    /// Maximum number of marked folders.
    pub favourite_folders_max: usize,
    /// Maximum number of distinct characters to search for in the system's fonts. All other characters show a box.
    pub letters_looked_for_max: usize,
}

/// The limits in force.
pub const LIMITS: Limits = Limits {
    folder_entries_max: 100_000,
    folders_read_max: 8,
    media_places_max: 20,
    favourite_folders_max: 50,
    letters_looked_for_max: 20_000,
};
