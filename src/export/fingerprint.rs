//! Hashes of what decides about an export. Unfinished work is continued only if the hashes agree.

use std::fmt::{self, Debug, Write};
use std::hash::{DefaultHasher, Hasher};

use super::error::ExportError;
use mariana_player::song::Song;

/// Hashes the bytes of a song.
///
/// # Errors
/// Fails if the song cannot be read.
pub(super) fn song_hash(song: &Song) -> Result<u64, ExportError> {
    let mut fingerprint = Fingerprint::default();
    let read = song.read(|piece| {
        fingerprint.add_bytes(piece);
        true
    });
    read.map_err(|error| {
        ExportError::Refused(format!("the song cannot be read ({error}): check its path and permissions"))
    })?;
    Ok(fingerprint.number())
}

/// A hash of bytes and values.
#[derive(Default)]
pub(super) struct Fingerprint(DefaultHasher);

impl Fingerprint {
    pub(super) fn add_bytes(&mut self, bytes: &[u8]) {
        self.0.write(bytes);
    }

    /// Adds every field of a value, in the text by which the value is debugged.
    pub(super) fn add(&mut self, value: &dyn Debug) {
        // A hasher takes everything.
        let _ = write!(self, "{value:?};");
    }

    pub(super) fn number(&self) -> u64 {
        self.0.finish()
    }
}

impl Write for Fingerprint {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.add_bytes(text.as_bytes());
        Ok(())
    }
}
