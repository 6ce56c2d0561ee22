//! Marks of work during which the process may die: a mark file exists while the work lasts, and a left-over mark tells
//! the next run about the death.
//!
//! A live process holds a lock on its marks, so a mark that can be locked is from a dead process. A crashing process
//! writes [`CRASHED`] into its marks; a killed process cannot. A crash marks the work of all threads, so work may be
//! wrongly suspected.

#![expect(unsafe_code, reason = "code that runs during a crash must not allocate")]

use std::fs::{self, File};
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, Once, PoisonError, Weak};

use crate::ending::{self, Undo};

/// The end of a mark whose process crashed.
pub const CRASHED: &str = "\ncrashed";
/// Bytes of a mark that are read.
const MARK_BYTES: u64 = 1 << 12;

/// The marks of this process.
static MARKS: Mutex<Vec<Weak<File>>> = Mutex::new(Vec::new());

/// Work in progress. Dropping this removes the mark, because the process has survived the work.
#[derive(Debug)]
pub struct Attempt {
    // The mark's file, which is open and therefore locked until the drop.
    _mark: Arc<File>,
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

/// The death of a process during an attempt.
#[derive(Debug, PartialEq, Eq)]
pub struct Death {
    /// The word with which the attempt began.
    pub word: String,
    /// False if the process was killed from outside.
    pub crashed: bool,
}

/// Creates a mark at `path` with a word without line breaks. Returns `None` if another process is doing the same work,
/// or if the file cannot be created; a death then remains undetected.
pub fn begin(path: &Path, word: &str) -> Option<Attempt> {
    record_crashes();
    let begun = ending::begin(|| {
        let mut mark = File::options().write(true).create(true).truncate(false).open(path).map_err(|_| ())?;
        mark.try_lock().map_err(|_| ())?;
        mark.set_len(0).and_then(|()| mark.write_all(word.as_bytes())).map_err(|_| ())?;
        let undone = path.to_owned();
        let undo = move || {
            let _ = fs::remove_file(undone);
        };
        Ok::<_, ()>((Arc::new(mark), undo))
    });
    let (mark, undo) = begun.ok()?;
    let mut marks = MARKS.lock().unwrap_or_else(PoisonError::into_inner);
    marks.retain(|mark| mark.strong_count() > 0);
    marks.push(Arc::downgrade(&mark));
    Some(Attempt { _mark: mark, undo: Some(undo), path: path.to_owned() })
}

/// Returns the death of an earlier process during this attempt, and removes its mark; `None` without a left-over mark.
pub fn death(path: &Path) -> Option<Death> {
    let mark = File::options().read(true).write(true).open(path).ok()?;
    mark.try_lock().ok()?;
    let mut text = String::new();
    let _ = (&mark).take(MARK_BYTES).read_to_string(&mut text);
    let _ = fs::remove_file(path);
    let word = text.strip_suffix(CRASHED);
    Some(Death { crashed: word.is_some(), word: word.unwrap_or(&text).to_owned() })
}

/// Makes a crash of this process write [`CRASHED`] into its marks. The crash then takes its course.
fn record_crashes() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        // SAFETY: the closure waits for no lock and allocates nothing.
        let record = unsafe {
            crash_handler::make_crash_event(|_| {
                for mark in MARKS.try_lock().iter().flat_map(|marks| marks.iter()) {
                    let _ = mark.upgrade().map(|mark| (&*mark).write_all(CRASHED.as_bytes()));
                }
                crash_handler::CrashEventResult::Handled(false)
            })
        };
        match crash_handler::CrashHandler::attach(record) {
            // Dropping the handler would detach it.
            Ok(handler) => std::mem::forget(handler),
            Err(error) => tracing::info!("crashes are not recorded: {error}"),
        }
    });
}

#[cfg(test)]
#[cfg(target_os = "linux")]
mod tests {
    use std::process::{Command, Stdio};

    use super::*;

    const MARK: &str = "MARIANA_TEST_MARK";

    /// Begins an attempt and waits to be killed, in the process that the next test starts.
    #[test]
    fn an_attempt_without_an_end() {
        let Some(path) = std::env::var_os(MARK) else { return };
        let _attempt = begin(Path::new(&path), "compiling").unwrap();
        println!("begun");
        std::thread::sleep(std::time::Duration::from_secs(600));
    }

    #[test]
    fn a_kill_from_outside_was_taken_for_a_crash() {
        use rustix::process::{Pid, Signal, kill_process};
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mark");
        for (signal, crashed) in
            [(Signal::KILL, false), (Signal::ILL, true), (Signal::ABORT, true), (Signal::TERM, false)]
        {
            let mut command = Command::new(std::env::current_exe().unwrap());
            command.args(["--exact", "attempt::tests::an_attempt_without_an_end", "--nocapture"]);
            command.env(MARK, &path).stdout(Stdio::piped()).stderr(Stdio::null());
            let mut process = command.spawn().unwrap();
            let mut lines = std::io::BufRead::lines(std::io::BufReader::new(process.stdout.take().unwrap()));
            assert!(lines.any(|line| line.unwrap().contains("begun")));
            assert_eq!(death(&path), None, "the work is still running");
            kill_process(Pid::from_child(&process), signal).unwrap();
            let status = process.wait().unwrap();
            assert_eq!(
                std::os::unix::process::ExitStatusExt::signal(&status),
                Some(signal.as_raw()),
                "the crash took another course"
            );
            assert_eq!(death(&path), Some(Death { word: "compiling".to_owned(), crashed }), "{signal:?}");
            assert_eq!(death(&path), None);
        }
    }
}
