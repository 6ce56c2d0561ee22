//! Recorded performances, written as show files in the user's folder by a writer thread, because disks may be slow.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

use mariana_files::Folders;
use mariana_files::atomic_file::{AtomicFile, Unwritable};
use mariana_files::file_names::{numbered, plain_name};
use mariana_work::{Worker, in_order};

/// The path of a written performance, or the error.
pub type Kept = Result<PathBuf, Unwritable>;

/// The folder of performances and the thread that writes them.
pub struct PerformanceFiles {
    writer_thread: Worker<Job, Kept>,
}

/// A performance to write. A later job with the same number replaces the file.
struct Job {
    number: u64,
    title: String,
    text: Box<dyn FnOnce() -> String + Send>,
}

impl PerformanceFiles {
    /// Uses the user's folder of performances.
    pub fn among(folders: &Folders) -> Self {
        Self::in_folder(folder_among(folders))
    }

    /// Uses another folder; with `None`, no performance is stored.
    pub fn in_folder(folder: Option<PathBuf>) -> Self {
        let start = |folder: PathBuf| {
            let mut paths = HashMap::new();
            let work = move |Job { number, title, text }| {
                let path = paths.entry(number).or_insert_with(|| free_path(&folder, &title));
                Some(write(path, &text()))
            };
            in_order("performances", || {}, || work).unwrap_or_default().finished_at_drop(Duration::MAX)
        };
        Self { writer_thread: folder.map(start).unwrap_or_default() }
    }

    /// Returns the newest performance of a song with this title. Reads the disk.
    pub fn newest(folders: &Folders, title: &str) -> Option<PathBuf> {
        let first = first_path(&folder_among(folders)?, title);
        numbered(&first).take_while(|path| path.exists()).last()
    }

    /// Writes or replaces performance `number`. `text` runs on the writer thread. Returns `false` without a folder.
    pub fn keep(&self, number: u64, title: &str, text: impl FnOnce() -> String + Send + 'static) -> bool {
        let job = Job { number, title: title.to_owned(), text: Box::new(text) };
        self.writer_thread.send(job)
    }

    /// Returns `true` once all files are written and all results have been polled.
    pub fn is_idle(&self) -> bool {
        self.writer_thread.is_idle()
    }

    /// Returns the next result, if any.
    pub fn poll(&self) -> Option<Kept> {
        self.writer_thread.poll()
    }
}

fn folder_among(folders: &Folders) -> Option<PathBuf> {
    folders.data.as_ref().map(|data| data.join("performances"))
}

fn free_path(folder: &Path, title: &str) -> PathBuf {
    let first = first_path(folder, title);
    numbered(&first).find(|path| !path.exists()).unwrap_or(first)
}

fn first_path(folder: &Path, title: &str) -> PathBuf {
    // Not `with_extension`: a title may contain a dot.
    folder.join(plain_name(title, "performance") + ".show")
}

fn write(path: &Path, text: &str) -> Kept {
    AtomicFile::create_with_folder(path)?.write(text.as_bytes())?;
    Ok(path.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn performances_get_unique_names_and_grow_in_their_file() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().join("data/performances");
        for (first, name) in [("one", "AC_DC_ Live.show"), ("other", "AC_DC_ Live 2.show")] {
            let files = PerformanceFiles::in_folder(Some(place.clone()));
            assert!(files.keep(7, "AC/DC: Live", || first.to_owned()));
            assert!(files.keep(7, "AC/DC: Live", move || format!("{first}, longer")));
            drop(files);
            assert_eq!(std::fs::read_to_string(place.join(name)).unwrap(), format!("{first}, longer"));
            let newest = PerformanceFiles::newest(&Folders::within(folder.path()), "AC/DC: Live");
            assert_eq!(newest, Some(place.join(name)));
        }
        let files = PerformanceFiles::in_folder(Some(place.clone()));
        files.keep(1, "../..", || "nowhere else".to_owned());
        files.keep(2, "", || "nameless".to_owned());
        drop(files);
        assert_eq!(std::fs::read_dir(&place).unwrap().count(), 4, "all files must be in that folder");
        assert_eq!(std::fs::read_to_string(place.join("performance.show")).unwrap(), "nameless");
    }

    #[test]
    fn a_failed_write_is_reported() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().join("a file");
        std::fs::write(&place, "where the folder should be").unwrap();
        let files = PerformanceFiles::in_folder(Some(place.clone()));
        assert!(files.keep(1, "song", || "at start orb".to_owned()));
        let reported = files.writer_thread.within(Duration::MAX).unwrap().unwrap_err().to_string();
        assert!(reported.contains("a file"), "{reported}");
        assert!(!PerformanceFiles::in_folder(None).keep(1, "song", String::new));
    }
}
