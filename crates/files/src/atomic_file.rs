//! Output files that are either complete or absent: they are written beside their place and renamed into it at the
//! end, so that a failure never costs the file that was there before.
//!
//! The content is on the disk before the file is renamed, so that after a power failure there is the old file or the
//! new one. An unfinished file is removed when it is dropped, and by a signal that ends the process
//! ([`crate::ending::begin`]). After a sudden death the next run that writes into the folder removes it: a
//! writer holds a lock on its file for as long as the process lives, so a file that can be locked is abandoned. (A
//! process id in the name would not show that: containers and machines that share a folder have process ids of their
//! own.)

use std::ffi::{OsStr, OsString};
use std::fs::File;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use tempfile::{Builder, NamedTempFile};

use crate::ending::{self, Undo};

/// What the names of unfinished files begin with.
const PREFIX: &str = ".mariana-unfinished-";

/// How often a new file is tried if another run takes it for an abandoned one in the moment before it is locked.
const ATTEMPTS: usize = 8;

/// A file that cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("{} cannot be written ({reason})", path.display())]
pub struct Unwritable {
    /// The file that was wanted.
    pub path: PathBuf,
    /// What the system said.
    pub reason: String,
}

/// A file that is removed when it is dropped, when a signal ends the process, or by the next run after a sudden
/// death.
#[derive(Debug)]
pub struct Unfinished {
    // Open and locked for as long as it lives.
    file: NamedTempFile,
    undo: Undo,
}

impl Unfinished {
    /// A new file in `folder` whose name ends in `suffix`. What other runs left there is removed first.
    ///
    /// # Errors
    /// What the system says.
    pub fn create(folder: &Path, suffix: &OsStr) -> io::Result<Self> {
        remove_abandoned_once(folder);
        let mut builder = Builder::new();
        builder.prefix(PREFIX).suffix(suffix);
        #[cfg(unix)]
        {
            // Like any new file: the user's umask decides, not the privacy of temporary files.
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(std::fs::Permissions::from_mode(0o666));
        }
        for _ in 0..ATTEMPTS {
            let (file, undo) = ending::begin(|| {
                let file = builder.tempfile_in(folder).map_err(without_path)?;
                let path = file.path().to_owned();
                let remove = move || {
                    // If it is gone already, nothing is lost.
                    let _ = std::fs::remove_file(path);
                };
                io::Result::Ok((file, remove))
            })?;
            if is_held(file.as_file()) {
                return Ok(Self { file, undo });
            }
        }
        Err(io::Error::other("other runs remove what is begun there"))
    }

    /// Its path, for programs that write or read it by name.
    pub fn path(&self) -> &Path {
        self.file.path()
    }

    /// Writes `bytes` at its end.
    ///
    /// # Errors
    /// What the system says.
    pub fn write_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        // Not through the named file: its errors contain the temporary name, which means nothing to the user.
        self.file.as_file_mut().write_all(bytes)
    }

    /// Renames it to `place` once its content is on the disk.
    fn put(self, place: &Path) -> io::Result<()> {
        // Through its name: another program may have written it.
        synced(File::options().write(true).open(self.path())?.sync_all())?;
        let Self { file, undo } = self;
        undo.settle(|| file.persist(place)).map_err(|error| error.error)?;
        // The name is synced too, if folders can be synced.
        let _ = File::open(folder_of(place)).and_then(|folder| folder.sync_all());
        Ok(())
    }
}

/// The error of a temporary file, without its name.
pub fn without_path(error: io::Error) -> io::Error {
    let text = error.to_string();
    io::Error::new(error.kind(), text.split(" at path ").next().unwrap_or_default().to_owned())
}

/// A file system that cannot sync has done all that it can.
fn synced(result: io::Result<()>) -> io::Result<()> {
    match result {
        Err(error) if matches!(error.kind(), ErrorKind::InvalidInput | ErrorKind::Unsupported) => Ok(()),
        result => result,
    }
}

/// Locks a file that was made a moment ago; false if it was removed in between.
#[cfg(unix)]
fn is_held(file: &File) -> bool {
    use std::os::unix::fs::MetadataExt;
    // Without locks nobody can take it for abandoned.
    file.lock().is_err() || file.metadata().is_ok_and(|file| file.nlink() > 0)
}

/// On these systems a lock keeps other programs from writing, so none is taken and no file counts as abandoned.
#[cfg(not(unix))]
fn is_held(_file: &File) -> bool {
    true
}

/// Removes abandoned files in `folder`, unless that is the folder in which it was last done: a thousand stills go
/// into the same one.
fn remove_abandoned_once(folder: &Path) {
    static LAST: Mutex<Option<PathBuf>> = Mutex::new(None);
    let mut last = LAST.lock().unwrap_or_else(PoisonError::into_inner);
    if last.as_deref() != Some(folder) {
        remove_abandoned(folder);
        *last = Some(folder.to_owned());
    }
}

/// Removes the unfinished files in `folder` that no process holds. A file that cannot be checked stays.
fn remove_abandoned(folder: &Path) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let ours = entry.file_name().as_encoded_bytes().starts_with(PREFIX.as_bytes())
            && entry.file_type().is_ok_and(|kind| kind.is_file());
        // The lock is held during the removal, so that a run that has just made the file does not go on with it.
        let file = ours.then(|| File::options().read(true).write(true).open(entry.path()));
        if let Some(Ok(file)) = file
            && cfg!(unix)
            && file.try_lock().is_ok()
        {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

fn folder_of(place: &Path) -> &Path {
    match place.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// A file that is being written beside its place.
#[derive(Debug)]
pub struct AtomicFile {
    /// As it was asked for.
    path: PathBuf,
    /// Where it goes, with links followed.
    place: PathBuf,
    unfinished: Unfinished,
}

impl AtomicFile {
    /// Opens a file beside `path`, with `path`'s extension. A link is followed: the file that it points to is
    /// replaced.
    ///
    /// # Errors
    /// [`Unwritable`] if `path` is a folder, a device or a pipe (renaming would destroy those), or if its folder
    /// takes no files.
    pub fn create(path: &Path) -> Result<Self, Unwritable> {
        match path.metadata() {
            Ok(found) if found.is_dir() => return Err(unwritable(path, "it is a folder")),
            Ok(found) if !found.is_file() => return Err(unwritable(path, "it is a device or a pipe")),
            _ => {}
        }
        let place = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let folder = folder_of(&place);
        if !folder.is_dir() {
            return Err(unwritable(path, format!("there is no folder {}", folder.display())));
        }
        let mut suffix = OsString::new();
        if let Some(extension) = path.extension() {
            suffix.push(".");
            suffix.push(extension);
        }
        let unfinished = Unfinished::create(folder, &suffix).map_err(|error| unwritable(path, error))?;
        Ok(Self { path: path.to_owned(), place, unfinished })
    }

    /// Where the content goes for now, for programs that write it by name.
    pub fn temporary(&self) -> &Path {
        self.unfinished.path()
    }

    /// Writes `bytes` and puts the file in its place.
    ///
    /// # Errors
    /// [`Unwritable`]; the place then is as it was.
    pub fn write(mut self, bytes: &[u8]) -> Result<(), Unwritable> {
        self.unfinished.write_all(bytes).map_err(|error| unwritable(&self.path, error))?;
        self.commit()
    }

    /// Puts what was written into its place.
    ///
    /// # Errors
    /// [`Unwritable`]; the place then is as it was.
    pub fn commit(self) -> Result<(), Unwritable> {
        let Self { path, place, unfinished } = self;
        unfinished.put(&place).map_err(|error| unwritable(&path, error))
    }
}

fn unwritable(path: &Path, reason: impl ToString) -> Unwritable {
    Unwritable { path: path.to_owned(), reason: reason.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_there_stays_until_the_new_content_is_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("frame.png");
        std::fs::write(&path, "old").unwrap();
        drop(AtomicFile::create(&path).unwrap());
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
        AtomicFile::create(&path).unwrap().write(b"new").unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "new");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no temporary file is left");
    }

    #[cfg(unix)]
    #[test]
    fn devices_stay_and_links_are_followed() {
        let message = AtomicFile::create(Path::new("/dev/zero")).err().unwrap().to_string();
        assert!(message.contains("/dev/zero"), "{message}");

        let folder = tempfile::tempdir().unwrap();
        let (link, place) = (folder.path().join("link.png"), folder.path().join("place.png"));
        std::fs::write(&place, "old").unwrap();
        std::os::unix::fs::symlink(&place, &link).unwrap();
        AtomicFile::create(&link).unwrap().write(b"new").unwrap();
        assert!(link.is_symlink());
        assert_eq!(std::fs::read_to_string(&place).unwrap(), "new");
    }

    #[test]
    fn a_folder_and_a_missing_folder_are_refused_by_name() {
        let folder = tempfile::tempdir().unwrap();
        for path in [folder.path().to_owned(), folder.path().join("none/frame.png")] {
            let message = AtomicFile::create(&path).err().unwrap().to_string();
            assert!(message.contains(&*path.to_string_lossy()), "{message}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn what_a_killed_run_left_is_removed_and_what_is_written_or_not_ours_stays() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str| std::fs::write(folder.path().join(name), "half").unwrap();
        let others = [".mariana-notes.txt", "mariana-unfinished-1.mp4", ".mariana-unfinishe"];
        others.iter().for_each(|name| write(name));
        let a_folder = format!("{PREFIX}folder");
        std::fs::create_dir(folder.path().join(&a_folder)).unwrap();
        let a_link = format!("{PREFIX}link");
        std::os::unix::fs::symlink(folder.path().join(others[0]), folder.path().join(&a_link)).unwrap();
        let living = Unfinished::create(folder.path(), OsStr::new(".png")).unwrap();
        write(&format!("{PREFIX}aB3x9Z.mp4"));

        remove_abandoned(folder.path());
        let mut names: Vec<String> = std::fs::read_dir(folder.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        let living_name = living.path().file_name().unwrap().to_str().unwrap();
        let mut kept = [&others[..], &[&a_folder, &a_link, living_name]].concat();
        kept.sort();
        assert_eq!(names, kept);
        // Another program may write it by name, as ffmpeg does.
        std::fs::write(living.path(), "by name").unwrap();
        remove_abandoned(folder.path());
        assert_eq!(std::fs::read_to_string(living.path()).unwrap(), "by name");
    }

    #[cfg(unix)]
    #[test]
    fn what_another_program_wrote_by_the_name_takes_the_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("video.mp4");
        std::fs::write(&path, "old").unwrap();
        let file = AtomicFile::create(&path).unwrap();
        std::fs::write(file.temporary(), "new").unwrap();
        file.commit().unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "new");
        // A file that is gone cannot.
        let file = AtomicFile::create(&path).unwrap();
        std::fs::remove_file(file.temporary()).unwrap();
        let message = file.commit().unwrap_err().to_string();
        assert!(message.contains("video.mp4"), "{message}");
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "new");
    }
}
