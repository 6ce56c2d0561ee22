//! Reads, saves and watches the editor's text files, and backs up unsaved text.
//!
//! All file access happens on a [`FileThread`]. The editor sends texts and receives [`FileEvent`]s, so a slow disk
//! never blocks the window.
//!
//! **No foreign change is overwritten.** A save request contains the expected content of the file. If the file has
//! different content, the save is refused, and the event contains the current content.
//!
//! **No typed text is lost.** A text that differs from its file is backed up in the user's state folder within a
//! third of a second. The backup stays until the text is saved or discarded ([`Kept`]).

mod file_thread;
mod kept;
#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};
use std::sync::Arc;

pub use file_thread::FileThread;
pub use kept::{Kept, KeptTexts};

/// The bytes of a text.
pub type Bytes = Arc<[u8]>;

/// The content of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum OnDisk {
    /// The file does not exist.
    Missing,
    /// The bytes of the file.
    Bytes(Bytes),
    /// The file cannot be read, for this reason.
    Unreadable(String),
}

/// An event from the [`FileThread`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FileEvent {
    /// A file was read.
    Opened {
        /// The file.
        file: PathBuf,
        /// Its content.
        holds: OnDisk,
        /// The backup of an unsaved text from an earlier run.
        kept: Option<Kept>,
    },
    /// A text was saved.
    Saved {
        /// The file.
        file: PathBuf,
        /// The text.
        text: Bytes,
    },
    /// A save was refused because another program changed the file.
    Refused {
        /// The file.
        file: PathBuf,
        /// Its current content.
        holds: OnDisk,
    },
    /// A text cannot be saved or backed up, for this reason.
    Failed(String),
    /// Another program has changed a file.
    Changed {
        /// The file.
        file: PathBuf,
        /// Its current content.
        holds: OnDisk,
    },
    /// This new file was created.
    Created(PathBuf),
}

/// Returns a file's name without its extension, for use in another name.
fn stem_of(name: &str) -> &str {
    Path::new(name)
        .file_stem()
        .and_then(|stem| stem.to_str())
        .filter(|stem| !stem.is_empty())
        .unwrap_or("scene")
}
