//! Reads files that may be something else, or larger than expected.

use std::fs::{self, File};
use std::io::{self, Read as _};
use std::path::Path;

/// Reads a file; `None` if it has more than `max` bytes. Never reads more, even if the file reports a smaller size.
///
/// # Errors
/// Fails with the system's error, and if `path` is a folder, a pipe or a device: opening a pipe would wait for its
/// other end.
pub fn read_at_most(path: &Path, max: usize) -> io::Result<Option<Vec<u8>>> {
    if !fs::metadata(path)?.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is not a file"));
    }
    let mut bytes = Vec::new();
    File::open(path)?.take((max as u64).saturating_add(1)).read_to_end(&mut bytes)?;
    Ok((bytes.len() <= max).then_some(bytes))
}

/// The reason why a text cannot be read. Each message follows the name of the file.
#[derive(Debug, thiserror::Error)]
pub enum TextError {
    /// The system refuses to read the file.
    #[error("cannot be read ({0}): check the path")]
    Unreadable(io::Error),
    /// The file has more bytes than this limit.
    #[error("is larger than {0} bytes: split it")]
    TooLarge(usize),
    /// This byte, counted from 0, is not UTF-8.
    #[error("is not text: byte {0} is not UTF-8; save it as UTF-8")]
    NotText(usize),
}

/// How many bytes of a file that is too large are read to see whether it is a text.
const HEAD_BYTES: u64 = 4096;

/// Reads a text of at most `max` bytes.
///
/// # Errors
/// Fails like [`read_at_most`], and for a file that is too large or is not UTF-8.
pub fn read_text(path: &Path, max: usize) -> Result<String, TextError> {
    let Some(bytes) = read_at_most(path, max).map_err(TextError::Unreadable)? else {
        // The advice to split the file would be wrong for a file that is no text, such as a song.
        let mut head = Vec::new();
        let read = File::open(path).and_then(|file| file.take(HEAD_BYTES).read_to_end(&mut head));
        read.map_err(TextError::Unreadable)?;
        return Err(match std::str::from_utf8(&head) {
            Err(error) if error.error_len().is_some() => TextError::NotText(error.valid_up_to()),
            _ => TextError::TooLarge(max),
        });
    };
    String::from_utf8(bytes).map_err(|error| TextError::NotText(error.utf8_error().valid_up_to()))
}

#[cfg(test)]
#[cfg(target_os = "linux")]
mod tests {
    use super::*;

    #[test]
    fn reading_ends_at_the_limit_and_pipes_are_refused() {
        // The kernel reports that this file is empty.
        let path = Path::new("/proc/self/status");
        assert_eq!(read_at_most(path, 9).unwrap(), None);
        assert!(read_at_most(path, 1 << 20).unwrap().is_some_and(|bytes| bytes.len() > 9));
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        for no_file in [&pipe, folder.path(), Path::new("/dev/zero")] {
            assert_eq!(read_at_most(no_file, 9).unwrap_err().kind(), io::ErrorKind::InvalidInput);
        }
    }
}
