//! Texts that were typed and not saved, kept from run to run.
//!
//! Each is a file of its own: a line that says whose text it is, then the text byte for byte, so that a hand with any
//! editor finds it, too.

use std::ffi::OsStr;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{SystemTime, UNIX_EPOCH};

use crate::Folders;
use serde::{Deserialize, Serialize};

use super::Bytes;
use crate::atomic_file::AtomicFile;
use crate::limits::LIMITS;

/// The ending of the names of kept texts.
const ENDING: &str = "unsaved";

/// A text that was typed and not saved.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Kept {
    /// The text.
    pub text: Bytes,
    /// When it was kept, in seconds since 1970.
    pub since: u64,
}

/// The folder of kept texts.
#[derive(Debug, Clone)]
pub struct KeptTexts {
    /// None if the system has no place for it: then texts last as long as the program.
    folder: Option<PathBuf>,
}

/// The first line of a kept text.
#[derive(Serialize, Deserialize)]
struct Head {
    /// What the file is for whoever finds it.
    what: String,
    /// Bytes of the file's path, as the system writes them.
    file: Vec<u8>,
    /// The same for readers.
    path: String,
    /// Seconds since 1970.
    since: u64,
}

impl KeptTexts {
    /// Those of the user.
    pub fn among(folders: &Folders) -> Self {
        Self { folder: folders.state.as_ref().map(|state| state.join("unsaved")) }
    }

    /// Keeps the text of a file. Without a place for it nothing happens.
    ///
    /// # Errors
    /// What the system says, with the place.
    pub fn keep(&self, file: &Path, text: &[u8]) -> Result<(), String> {
        let Some(place) = self.place(file) else { return Ok(()) };
        let head = Head {
            what: "text that was typed in Mariana and not saved; it begins in the next line".to_owned(),
            file: name_of(file).to_vec(),
            path: file.display().to_string(),
            since: SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs()),
        };
        let mut bytes = serde_json::to_vec(&head).map_err(|error| error.to_string())?;
        bytes.push(b'\n');
        bytes.extend_from_slice(text);
        if let Some(folder) = place.parent() {
            std::fs::create_dir_all(folder)
                .map_err(|error| format!("{} cannot be made ({error})", folder.display()))?;
        }
        let written = AtomicFile::create(&place).and_then(|file| file.write(&bytes));
        written.map_err(|error| error.to_string())
    }

    /// What was kept of a file's text.
    pub fn of(&self, file: &Path) -> Option<Kept> {
        let place = self.place(file)?;
        let bytes =
            crate::documents::file_thread::read_at_most(&place, LIMITS.kept_text_bytes_max).ok()??;
        let end = bytes.iter().position(|byte| *byte == b'\n')?;
        let head: Head = serde_json::from_slice(bytes.get(..end)?).ok()?;
        // Another file may have the same short name.
        let text: Bytes = Arc::from(bytes.get(end + 1..)?);
        (head.file == name_of(file)).then_some(Kept { text, since: head.since })
    }

    /// Keeps a file's text no longer.
    pub fn forget(&self, file: &Path) {
        let removed = self.place(file).map_or(Ok(()), std::fs::remove_file);
        if let Err(error) = removed.or_else(|error| match error.kind() {
            io::ErrorKind::NotFound => Ok(()),
            _ => Err(error),
        }) {
            tracing::warn!("an unsaved text of {} stays kept: {error}", file.display());
        }
    }

    fn place(&self, file: &Path) -> Option<PathBuf> {
        let name = format!("{:016x}.{ENDING}", short_name(name_of(file)));
        Some(self.folder.as_deref()?.join(name))
    }
}

fn name_of(file: &Path) -> &[u8] {
    AsRef::<OsStr>::as_ref(file).as_encoded_bytes()
}

/// A number by which a file is found again (FNV-1a, 64 bits).
fn short_name(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3))
}
