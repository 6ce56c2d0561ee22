//! Where a picture or a video goes.

use std::fmt;
use std::io::{ErrorKind, Write};
use std::path::PathBuf;

use super::error::ExportError;

/// The name that stands for standard output, and for standard input.
pub const STANDARD: &str = "-";

/// Where a picture or a video goes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Output {
    /// To a file, or to a folder of files.
    Path(PathBuf),
    /// To whoever reads standard output.
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

/// Writes bytes to standard output; false if its reader has read enough and closed it.
///
/// # Errors
/// [`ExportError::Print`] if standard output accepts nothing.
pub(super) fn write_standard(bytes: &[u8]) -> Result<bool, ExportError> {
    let mut out = std::io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(false),
        written => written.map(|()| true).map_err(ExportError::Print),
    }
}
