//! Files of text that are edited: read, saved, never over what another program wrote meanwhile, and what was typed kept
//! until it is saved.
//!
//! All of it happens on the clerk's thread. The editor hands texts over and hears what became of them; whatever a disk is
//! at, the window goes on.
//!
//! **What is saved is what was meant.** A save says what the file is believed to hold. If it holds something else, nothing
//! is written, and the other text is handed over instead.
//!
//! **Nothing that was typed is lost.** Texts that differ from their files are kept in the user's folder for the state of
//! programs, within a third of a second, and until they are saved or given up ([`kept`]).

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

/// What a file holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum OnDisk {
    /// There is no such file.
    Missing,
    /// These bytes.
    Bytes(Bytes),
    /// It cannot be read; why, in words.
    Unreadable(String),
}

/// What the clerk has to tell.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FileEvent {
    /// A file was read.
    Opened {
        /// The file.
        file: PathBuf,
        /// What it holds.
        holds: OnDisk,
        /// What was typed in it in an earlier run and not saved.
        kept: Option<Kept>,
    },
    /// A text was saved.
    Saved {
        /// The file.
        file: PathBuf,
        /// The text.
        text: Bytes,
    },
    /// A text was not saved, because another program wrote the file meanwhile.
    Refused {
        /// The file.
        file: PathBuf,
        /// What it holds.
        holds: OnDisk,
    },
    /// The system did not let a text be saved or kept.
    Failed {
        /// The file.
        file: PathBuf,
        /// Why, and what to do.
        reason: String,
    },
    /// Another program has changed a file.
    Changed {
        /// The file.
        file: PathBuf,
        /// What it holds now.
        holds: OnDisk,
    },
    /// A new file was made.
    Created {
        /// The file.
        file: PathBuf,
    },
}

/// A file's name without its ending, as part of another name.
fn stem_of(name: &str) -> &str {
    Path::new(name)
        .file_stem()
        .and_then(|stem| stem.to_str())
        .filter(|stem| !stem.is_empty())
        .unwrap_or("scene")
}
