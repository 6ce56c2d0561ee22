//! The limits of this crate. Code, error messages and tests all read them from here.

/// Maximum number of entries of a folder in the file list. Further entries of the folder are left out.
pub const FOLDER_ENTRIES_MAX: usize = 100_000;
/// Maximum number of folders that are read at the same time. More folders are read when one of them answers.
pub const FOLDERS_READ_MAX: usize = 8;
/// Maximum number of mounted disks in the file list.
pub const MEDIA_PLACES_MAX: usize = 20;
/// Maximum number of marked folders.
pub const FAVOURITE_FOLDERS_MAX: usize = 50;
/// Maximum number of distinct characters to search for in the system's fonts. All other characters show a box.
pub const LETTERS_LOOKED_FOR_MAX: usize = 20_000;
