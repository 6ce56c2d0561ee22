//! The destination of an image or a video.

use std::fmt;
use std::io::Write;
use std::path::{Path, PathBuf};

use super::error::ExportError;
use super::print::is_open;

/// The name of standard output and standard input on the command line.
pub const STANDARD: &str = "-";

/// A file, a folder or standard output.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Output {
    /// A file, or a folder of files.
    Path(PathBuf),
    /// Standard output.
    Standard,
}

impl<P: Into<PathBuf>> From<P> for Output {
    fn from(path: P) -> Self {
        let path = path.into();
        if path.as_os_str() == STANDARD { Self::Standard } else { Self::Path(path) }
    }
}

impl fmt::Display for Output {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Path(path) => path.display().fmt(f),
            Self::Standard => f.write_str("standard output"),
        }
    }
}

/// The folder of the pieces of an unfinished output.
pub(super) fn pieces_of(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".pieces");
    path.with_file_name(name)
}

/// Writes bytes to standard output. Returns false if the reader has closed it.
///
/// # Errors
/// [`ExportError::Print`] if standard output cannot be written.
pub(super) fn write_standard(bytes: &[u8]) -> Result<bool, ExportError> {
    let mut out = std::io::stdout().lock();
    is_open(out.write_all(bytes).and_then(|()| out.flush()))
}
