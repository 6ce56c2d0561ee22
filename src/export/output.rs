//! The destination of an image or a video.

use std::fmt;
use std::fs::File;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use super::error::{ExportError, refuse};
use super::print::is_open;
use mariana_player::song::Song;

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

/// True if the output is a folder, or will be a folder because it ends in a slash.
pub fn is_folder(path: &Path) -> bool {
    path.is_dir() || path.to_string_lossy().ends_with(['/', '\\'])
}

/// The folder of the pieces of an unfinished output.
pub(super) fn pieces_of(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".pieces");
    path.with_file_name(name)
}

/// Refuses to write a text over a file that may hold someone's work: any file that does not begin with `own`, the
/// beginning of the files that only Mariana writes.
pub fn refuse_to_replace(path: &Path, own: Option<&str>) -> Result<(), ExportError> {
    let begins = |own: &str| {
        let mut first = vec![0; own.len()];
        File::open(path).and_then(|mut file| file.read_exact(&mut first)).is_ok() && first == own.as_bytes()
    };
    if path.is_file() && !own.is_some_and(begins) {
        return refuse(format!(
            "{} exists: choose another path with -o, or remove this file first",
            path.display()
        ));
    }
    Ok(())
}

pub(super) fn refuse_the_song(song: &Song, output: &Path) -> Result<(), ExportError> {
    match song {
        Song::File(path) if same_file(path, output) => {
            refuse(format!("{} is the song itself: choose another path with -o", output.display()))
        }
        _ => Ok(()),
    }
}

pub(crate) fn same_file(a: &Path, b: &Path) -> bool {
    a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b))
}

/// Writes bytes to standard output. Returns false if the reader has closed it.
///
/// # Errors
/// [`ExportError::Print`] if standard output cannot be written.
pub fn write_standard(bytes: &[u8]) -> Result<bool, ExportError> {
    let mut out = std::io::stdout().lock();
    is_open(out.write_all(bytes).and_then(|()| out.flush()))
}
