//! Backups of unsaved texts, which survive a crash.
//!
//! Each backup is a separate file: one line of JSON with the absolute path of the text's file, then the text byte for
//! byte. A user can recover the text with any editor.

use std::ffi::OsStr;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{SystemTime, UNIX_EPOCH};

use crate::{Folders, limits};
use serde::{Deserialize, Serialize};

use super::Bytes;
use crate::atomic_file::AtomicFile;

const ENDING: &str = "unsaved";

/// The backup of an unsaved text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Kept {
    /// The text.
    pub text: Bytes,
    /// Time of the backup, in seconds since 1970.
    pub since: u64,
}

/// The folder of the backups.
#[derive(Debug, Clone)]
pub struct KeptTexts {
    /// `None` if the system has no state folder: unsaved texts are then lost when the program ends.
    folder: Option<PathBuf>,
}

#[derive(Serialize, Deserialize)]
struct Head {
    /// An explanation for a person who finds the file.
    what: String,
    /// The path of the text's file, as bytes of the system's encoding.
    file: Vec<u8>,
    /// The path of the text's file, for people.
    path: String,
    /// Seconds since 1970.
    since: u64,
}

impl KeptTexts {
    /// Returns the user's backups.
    pub fn among(folders: &Folders) -> Self {
        Self { folder: folders.state.as_ref().map(|state| state.join("unsaved")) }
    }

    /// Backs up the text of a file. Does nothing if the system has no state folder.
    ///
    /// # Errors
    /// Fails with a message that has the path and the system's error.
    pub fn keep(&self, file: &Path, text: &[u8]) -> Result<(), String> {
        let file = &absolute(file);
        let Some(place) = self.place(file) else { return Ok(()) };
        let head = Head {
            what: "unsaved text from Mariana; it begins on the next line".to_owned(),
            file: name_of(file).to_vec(),
            path: file.display().to_string(),
            since: SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs()),
        };
        let mut bytes = serde_json::to_vec(&head).map_err(|error| error.to_string())?;
        bytes.push(b'\n');
        bytes.extend_from_slice(text);
        let written = AtomicFile::create_with_folder(&place).and_then(|file| file.write(&bytes));
        written.map_err(|error| error.to_string())
    }

    /// Returns the backup of a file's text, if there is one.
    pub fn of(&self, file: &Path) -> Option<Kept> {
        let file = &absolute(file);
        let place = self.place(file)?;
        let bytes = crate::reading::read_at_most(&place, limits::KEPT_TEXT_BYTES_MAX).ok()??;
        let end = bytes.iter().position(|byte| *byte == b'\n')?;
        let head: Head = serde_json::from_slice(bytes.get(..end)?).ok()?;
        // Two paths may have the same hash.
        let text: Bytes = Arc::from(bytes.get(end + 1..)?);
        (head.file == name_of(file)).then_some(Kept { text, since: head.since })
    }

    /// Removes the backup of a file's text.
    pub fn forget(&self, file: &Path) {
        let removed = self.place(&absolute(file)).map_or(Ok(()), std::fs::remove_file);
        if let Err(error) = removed.or_else(|error| match error.kind() {
            io::ErrorKind::NotFound => Ok(()),
            _ => Err(error),
        }) {
            tracing::warn!("the backup of {} cannot be removed: {error}", file.display());
        }
    }

    /// The path of the backup for the file at this absolute path.
    fn place(&self, file: &Path) -> Option<PathBuf> {
        let name = format!("{:016x}.{ENDING}", short_name(name_of(file)));
        Some(self.folder.as_deref()?.join(name))
    }
}

/// The path from the root, because another run may start in another folder.
fn absolute(file: &Path) -> PathBuf {
    std::path::absolute(file).unwrap_or_else(|_| file.to_owned())
}

fn name_of(file: &Path) -> &[u8] {
    AsRef::<OsStr>::as_ref(file).as_encoded_bytes()
}

/// Returns a hash of a path, from which the backup gets its name (FNV-1a, 64 bits).
fn short_name(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3))
}
