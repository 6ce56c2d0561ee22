//! Detects that a driver crashed the process: a mark file exists while the driver works on a program, and a left-over
//! mark shows a crash to the next run.
//!
//! A live process holds a lock on its marks, so a mark that can be locked is from a dead process. A killed process
//! leaves marks too, and a crash leaves the marks of all threads. A wrongly assumed crash costs only speed, and the
//! message about the crash names the file.

use std::fs::{self, File};
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};

use crate::ending::{self, Undo};
use crate::gpu::program_store::Work;

const WORKS: [(Work, &str); 2] = [(Work::Taking, "taking"), (Work::Compiling, "compiling")];

/// Work in progress. Dropping this removes the mark, because the process has survived the work.
#[derive(Debug)]
pub(super) struct Attempt {
    // The mark's file, which is open and therefore locked until the drop.
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

/// Creates a mark at `path`. Returns `None` if another process is doing the same work, or if the file cannot be
/// created; a crash then remains undetected.
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

/// Returns the work during which an earlier process died, and removes its mark; `None` without a left-over mark.
pub(super) fn death(path: &Path) -> Option<Work> {
    let mark = File::options().read(true).write(true).open(path).ok()?;
    mark.try_lock().ok()?;
    let mut word = String::new();
    let _ = (&mark).take(16).read_to_string(&mut word);
    let _ = fs::remove_file(path);
    WORKS.iter().find(|(_, known)| *known == word).map(|(work, _)| *work)
}
