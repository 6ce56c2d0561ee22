//! Reading and writing of the files of settings and of knobs, their errors, and names for damaged files.

use std::fmt::Display;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use mariana_control::limits as control_limits;
use mariana_files::atomic_file::AtomicFile;
use mariana_files::reading::read_at_most;

use crate::limits;

/// The error when a file cannot be read or written completely. The show continues.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum StoredFileError {
    /// The file is damaged.
    #[error("the {what} in {} cannot be understood ({reason}){remedy} renames this file to {}", path.display(), aside.display())]
    Damaged {
        /// The contents of the file: settings or knobs.
        what: &'static str,
        /// The file.
        path: PathBuf,
        /// The mistake in the file.
        reason: String,
        /// The consequence, up to the change that renames the file.
        remedy: &'static str,
        /// The new name of the file.
        aside: PathBuf,
    },
    /// The system refuses to read, write or remove the file.
    #[error("the {what} in {} cannot be {doing} ({reason}); check the folder's permissions", path.display())]
    Refused {
        /// The contents of the file: settings or knobs.
        what: &'static str,
        /// The file.
        path: PathBuf,
        /// The refused operation, such as "read".
        doing: &'static str,
        /// The reason.
        reason: String,
    },
    /// A newer version has written the settings, or an entry is misspelt.
    #[error("the settings in {} have entries that this version does not know ({names}). They are kept; all other settings apply", path.display())]
    Newer {
        /// The file.
        path: PathBuf,
        /// The unknown keys, separated by commas.
        names: String,
    },
}

/// A kind of file.
pub(super) struct StoredFile {
    what: &'static str,
    bytes_max: usize,
    remedy: &'static str,
}

pub(super) const SETTINGS: StoredFile = StoredFile {
    what: "settings",
    bytes_max: limits::SETTINGS_BYTES_MAX,
    remedy: ". The defaults apply; the first change",
};

pub(super) const KNOBS: StoredFile = StoredFile {
    what: "knobs",
    bytes_max: control_limits::MAPPING_BYTES_MAX,
    remedy: "; no mapping is active. Correct the file, or learn new mappings, which",
};

impl StoredFile {
    /// Reads a file. A missing file has the default contents.
    pub(super) fn read<T: Default>(
        &self,
        path: &Path,
        parse: impl FnOnce(&str) -> Result<T, String>,
    ) -> Result<T, StoredFileError> {
        let bytes = match read_at_most(path, self.bytes_max) {
            Ok(bytes) => bytes.ok_or_else(|| format!("it has more than {} bytes", self.bytes_max)),
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(T::default()),
            Err(error) => return Err(self.refused(path, "read", &error)),
        };
        let text = bytes.and_then(|bytes| String::from_utf8(bytes).map_err(|error| error.to_string()));
        text.and_then(|text| parse(&text)).map_err(|reason| StoredFileError::Damaged {
            what: self.what,
            path: path.to_owned(),
            reason,
            remedy: self.remedy,
            aside: aside(path),
        })
    }

    /// Reads a file that is about to be replaced. A damaged file is renamed and gives `None`.
    pub(super) fn read_or_rename<T: Default>(
        &self,
        path: &Path,
        parse: impl FnOnce(&str) -> Result<T, String>,
    ) -> Result<Option<T>, StoredFileError> {
        match self.read(path, parse) {
            Err(StoredFileError::Damaged { aside, .. }) => {
                std::fs::rename(path, aside).map_err(|error| self.refused(path, "written", &error))?;
                Ok(None)
            }
            read => read.map(Some),
        }
    }

    /// Writes a file, and makes its folder if it is missing.
    pub(super) fn write(&self, path: &Path, text: &str) -> Result<(), StoredFileError> {
        let written = AtomicFile::create_with_folder(path).and_then(|file| file.write(text.as_bytes()));
        written.map_err(|error| self.refused(path, "written", &error.reason))
    }

    /// The error of an operation: the file cannot be `doing`, such as "read".
    pub(super) fn refused(&self, path: &Path, doing: &'static str, reason: &dyn Display) -> StoredFileError {
        StoredFileError::Refused { what: self.what, path: path.to_owned(), doing, reason: reason.to_string() }
    }
}

/// Returns a free name for the damaged TOML file at `path`, such as `settings.toml.broken`.
fn aside(path: &Path) -> PathBuf {
    let named = |number: u32| match number {
        1 => path.with_extension("toml.broken"),
        _ => path.with_extension(format!("toml.broken-{number}")),
    };
    (1..100).map(named).find(|path| !path.exists()).unwrap_or_else(|| named(1))
}
