//! A cache of compiled programs in the driver's binary format, in the user's cache folder, with a record of programs at
//! which a driver failed or crashed.
//!
//! | file | content |
//! |---|---|
//! | `KEY.program` | a checksum, the key again, and the driver's binary ([`sealed`]) |
//! | `KEY.attempt` | a mark while a driver works on it ([`mariana_files::attempt`]) |
//! | `KEY.given-up` | the reason why a program is not tried |
//!
//! **A program is given up only after two crashes.** A process may crash during compilation for reasons that are not the
//! driver's fault, and one that is killed has not crashed. The run after the first crash skips the program, so that a
//! driver that does crash cannot prevent the start. A later run tries the program again; if that succeeds, the crash is
//! forgotten.
//!
//! The key is a hash of everything that determines the result: the driver's name and version, and the sources. All
//! files in the folder may be deleted at any time. A file that is damaged or has another key is removed, a failed write
//! is logged, and the least recently used files are deleted first.

use std::any::Any;
use std::collections::HashSet;
use std::fmt;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use crate::atomic_file::AtomicFile;
use crate::attempt;
use crate::cached_files::{CHECKSUM_LINE, sealed, unsealed};
use crate::caches::{make_room, touch};
use crate::gpu::program_store::{GivenUp, ProgramKey, ProgramStore, Work};
use crate::limits;
use crate::reading::read_at_most;
use mariana_work::lock;

const WORKS: [(Work, &str); 2] = [(Work::Taking, "taking"), (Work::Compiling, "compiling")];

const REASONS: [(GivenUp, &str); 3] =
    [(GivenUp::Refused, "refused"), (GivenUp::DiedOnce, "died once"), (GivenUp::DiedTwice, "died twice")];

/// The cache. Any thread may use it.
#[derive(Debug)]
pub struct ProgramCache {
    folder: PathBuf,
    complained: AtomicBool,
    /// Programs that crashed an earlier run, as this run has found out. This run skips them.
    left_out: Mutex<HashSet<ProgramKey>>,
}

impl ProgramCache {
    /// Returns a cache in a subfolder of `caches`.
    pub fn within(caches: &Path) -> Arc<Self> {
        Arc::new(Self::in_folder(caches.join("programs")))
    }

    /// Returns a cache in this folder, which is created at the first write.
    pub fn in_folder(folder: PathBuf) -> Self {
        Self { folder, complained: AtomicBool::default(), left_out: Mutex::default() }
    }

    fn give_up(&self, key: ProgramKey, why: GivenUp) {
        let word = REASONS.iter().find(|(known, _)| *known == why).map_or("", |(_, word)| word);
        self.write(key, GIVEN_UP, word.as_bytes());
    }

    fn noted(&self, key: ProgramKey) -> Option<(GivenUp, PathBuf)> {
        let path = self.path(key, GIVEN_UP);
        let word = read_at_most(&path, WORD_MAX).ok()??;
        touch(&path);
        let known = REASONS.iter().find(|(_, known)| known.as_bytes() == word);
        Some((known?.0, path))
    }

    fn path(&self, key: ProgramKey, kind: &str) -> PathBuf {
        self.folder.join(format!("{key}.{kind}"))
    }

    fn write(&self, key: ProgramKey, kind: &str, bytes: &[u8]) {
        let file = AtomicFile::create_with_folder(&self.path(key, kind));
        match file.and_then(|file| file.write(bytes)) {
            Ok(()) => self.forget_oldest(limits::PROGRAM_CACHE_BYTES_MAX),
            Err(error) => self.complain(&error.reason),
        }
    }

    fn forget_oldest(&self, bytes_max: u64) {
        make_room(&self.folder, &[PROGRAM, GIVEN_UP], |file| file.len().max(BLOCK), bytes_max);
    }

    fn complain(&self, reason: &dyn fmt::Display) {
        if !self.complained.swap(true, Ordering::Relaxed) {
            tracing::warn!(
                "no programs are kept in {} ({reason}): the driver compiles them at every start",
                self.folder.display()
            );
        }
    }
}

impl ProgramStore for ProgramCache {
    fn load(&self, key: ProgramKey) -> Option<Vec<u8>> {
        let path = self.path(key, PROGRAM);
        let bytes = match read_at_most(
            &path,
            limits::KEPT_PROGRAM_BYTES_MAX + CHECKSUM_LINE + size_of::<ProgramKey>(),
        ) {
            Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::InvalidInput) => {
                return None;
            }
            read => read.ok().flatten().unwrap_or_default(),
        };
        let Some(content) = unsealed(&bytes).and_then(|bytes| bytes.strip_prefix(key.bytes())) else {
            tracing::info!("{} was damaged and has been removed", path.display());
            self.discard(key);
            return None;
        };
        touch(&path);
        Some(content.to_owned())
    }

    fn save(&self, key: ProgramKey, content: &[u8]) {
        if content.len() <= limits::KEPT_PROGRAM_BYTES_MAX {
            self.write(key, PROGRAM, &sealed(&[key.bytes(), content].concat()));
        }
    }

    fn discard(&self, key: ProgramKey) {
        let _ = fs::remove_file(self.path(key, PROGRAM));
    }

    fn attempt(&self, key: ProgramKey, work: Work) -> Option<Box<dyn Any>> {
        fs::create_dir_all(&self.folder).map_err(|error| self.complain(&error)).ok()?;
        let word = WORKS.iter().find(|(known, _)| *known == work).map_or("", |(_, word)| word);
        Some(Box::new(attempt::begin(&self.path(key, ATTEMPT), word)?))
    }

    fn death(&self, key: ProgramKey) -> Option<Work> {
        let death = attempt::death(&self.path(key, ATTEMPT)).filter(|death| death.crashed)?;
        WORKS.iter().find(|(_, word)| *word == death.word).map(|(work, _)| *work)
    }

    fn record_refused(&self, key: ProgramKey) {
        self.give_up(key, GivenUp::Refused);
    }

    fn record_crash(&self, key: ProgramKey) {
        lock(&self.left_out).insert(key);
        let died_before = matches!(self.noted(key), Some((GivenUp::DiedOnce | GivenUp::DiedTwice, _)));
        self.give_up(key, if died_before { GivenUp::DiedTwice } else { GivenUp::DiedOnce });
    }

    fn record_compiled(&self, key: ProgramKey) {
        let _ = fs::remove_file(self.path(key, GIVEN_UP));
    }

    /// Returns the reason why the program must not be tried in this run, and the file that records the reason.
    fn given_up(&self, key: ProgramKey) -> Option<(GivenUp, PathBuf)> {
        let is_retried = |why| why == GivenUp::DiedOnce && !lock(&self.left_out).contains(&key);
        self.noted(key).filter(|(why, _)| !is_retried(*why))
    }
}

const PROGRAM: &str = "program";
const ATTEMPT: &str = "attempt";
const GIVEN_UP: &str = "given-up";

/// Smallest size that a file occupies on disk, in bytes.
const BLOCK: u64 = 4096;

/// More bytes than the longest of [`REASONS`].
const WORD_MAX: usize = 16;

#[cfg(test)]
mod tests;
