//! What the crate's files share: writing them, errors of the system, and names for damaged files.

use std::fmt::Display;
use std::path::{Path, PathBuf};

use mariana_files::atomic_file::AtomicFile;

/// The error when the system refuses to read, write or remove a file. The show continues.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the {what} in {} cannot be {doing} ({reason}); check the folder's permissions", path.display())]
pub struct SystemError {
    /// The contents of the file: settings or knobs.
    what: &'static str,
    path: PathBuf,
    doing: &'static str,
    reason: String,
}

impl SystemError {
    /// The failure of an operation: the file cannot be `doing`, such as "read".
    pub(super) fn new(what: &'static str, path: &Path, doing: &'static str, reason: &dyn Display) -> Self {
        Self { what, path: path.to_owned(), doing, reason: reason.to_string() }
    }
}

/// Writes a file, and makes its folder if there is none.
pub(super) fn write(what: &'static str, path: &Path, text: &str) -> Result<(), SystemError> {
    let failed = |reason: &dyn Display| SystemError::new(what, path, "written", reason);
    let written = AtomicFile::create_with_folder(path).and_then(|file| file.write(text.as_bytes()));
    written.map_err(|error| failed(&error.reason))
}

/// Returns a free name for the damaged TOML file at `path`, such as `settings.toml.broken`.
pub(super) fn aside(path: &Path) -> PathBuf {
    let named = |number: u32| match number {
        1 => path.with_extension("toml.broken"),
        _ => path.with_extension(format!("toml.broken-{number}")),
    };
    (1..100).map(named).find(|path| !path.exists()).unwrap_or_else(|| named(1))
}
