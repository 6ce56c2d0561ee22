//! What a driver did with a program before: a mark lies in the folder while it is tried, so that the next run knows if
//! the driver took the process along.
//!
//! A mark is locked for as long as the process lives: one that can be locked was left behind. A process that is killed
//! while a driver is at work leaves one, too, and one that dies leaves those of its other threads. That costs speed only,
//! and the sentence about it names the file.

use std::fs::{self, File};
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};

use crate::ending::{self, Undo};
use crate::gpu::program_store::Work;

/// Every kind of work, and the word that stands for it in a mark.
const WORKS: [(Work, &str); 2] = [(Work::Taking, "taking"), (Work::Compiling, "compiling")];

/// Work that was begun; dropping it says that the process has outlived it.
#[derive(Debug)]
pub(super) struct Attempt {
    // Open, and so locked, for as long as it lives.
    _mark: File,
    undo: Option<Undo>,
    path: PathBuf,
}

impl Drop for Attempt {
    fn drop(&mut self) {
        let remove = || {
            let _ = fs::remove_file(&self.path);
        };
        if let Some(undo) = self.undo.take() {
            undo.settle(remove);
        }
    }
}

/// Puts a mark at `path`. None if another process is at the same work, which has put one, or if there is no room for
/// a file: then nobody learns of a death.
pub(super) fn begin(path: &Path, work: Work) -> Option<Attempt> {
    let word = WORKS.iter().find(|(known, _)| *known == work).map_or("", |(_, word)| word);
    let begun = ending::begin(|| {
        let mut mark = File::options().write(true).create(true).truncate(false).open(path).map_err(|_| ())?;
        mark.try_lock().map_err(|_| ())?;
        mark.set_len(0).and_then(|()| mark.write_all(word.as_bytes())).map_err(|_| ())?;
        let undone = path.to_owned();
        let undo = move || {
            let _ = fs::remove_file(undone);
        };
        Ok::<_, ()>((mark, undo))
    });
    let (mark, undo) = begun.ok()?;
    Some(Attempt { _mark: mark, undo: Some(undo), path: path.to_owned() })
}

/// The work in which an earlier process died, if a mark tells of one. The mark is taken away.
pub(super) fn death(path: &Path) -> Option<Work> {
    let mark = File::options().read(true).write(true).open(path).ok()?;
    mark.try_lock().ok()?;
    let mut word = String::new();
    let _ = (&mark).take(16).read_to_string(&mut word);
    let _ = fs::remove_file(path);
    WORKS.iter().find(|(_, known)| *known == word).map(|(work, _)| *work)
}
