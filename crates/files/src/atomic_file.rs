//! Output files that are either complete or absent. The content goes to a temporary file in the same folder, which
//! replaces the target at the end, so the previous file survives a failure.
//!
//! The content is synced to the disk before the rename: after a power failure the folder has either the old file or
//! the new one. A temporary file is removed on drop, and when a signal ends the process ([`crate::ending::begin`]).
//! After a crash, the next run that writes into the folder removes the file. The writer locks its temporary file
//! while the process lives, so a file that can be locked is abandoned. A process id in the name would not identify
//! abandoned files, because containers and machines that share a folder have separate process ids.

use std::ffi::{OsStr, OsString};
use std::fs::File;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use tempfile::{Builder, NamedTempFile};

use crate::ending::{self, Undo};
use crate::file_names::numbered;

const PREFIX: &str = ".mariana-unfinished-";

/// Maximum number of attempts to create a temporary file: another run may remove the file before it is locked.
const ATTEMPTS: usize = 8;

/// The error when a file cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("{} cannot be written ({reason})", path.display())]
pub struct Unwritable {
    /// The target file.
    pub path: PathBuf,
    /// The error from the system.
    pub reason: String,
    kind: ErrorKind,
}

impl Unwritable {
    /// Makes the error from the system's error.
    pub fn new(path: &Path, error: &io::Error) -> Self {
        Self { path: path.to_owned(), reason: error.to_string(), kind: error.kind() }
    }

    /// The remedy, as the end of a sentence.
    pub fn remedy(&self) -> &'static str {
        match self.kind {
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded => "free some disk space",
            ErrorKind::PermissionDenied => "change the permissions of the folder",
            ErrorKind::ReadOnlyFilesystem => {
                "make the disk writable, or set HOME to a folder on another disk"
            }
            _ => "check the folder",
        }
    }
}

/// A temporary file, which is removed when this is dropped, when a signal ends the process, or by the next run after
/// a crash.
#[derive(Debug)]
pub struct Unfinished {
    // The file stays open and locked.
    file: NamedTempFile,
    undo: Undo,
}

impl Unfinished {
    /// Creates a temporary file in `folder` whose name ends in `suffix`. Removes the abandoned files of other runs
    /// first.
    ///
    /// # Errors
    /// Fails with the system's error if the file cannot be created.
    pub fn create(folder: &Path, suffix: &OsStr) -> io::Result<Self> {
        remove_abandoned_once(folder);
        let mut builder = Builder::new();
        builder.prefix(PREFIX).suffix(suffix);
        #[cfg(unix)]
        {
            // The user's umask decides the permissions, as for any new file. Temporary files are private
            // by default.
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(std::fs::Permissions::from_mode(0o666));
        }
        for _ in 0..ATTEMPTS {
            let (file, undo) = ending::begin(|| {
                let file = builder.tempfile_in(folder).map_err(without_path)?;
                let path = file.path().to_owned();
                let remove = move || {
                    // The file may be gone already.
                    let _ = std::fs::remove_file(path);
                };
                io::Result::Ok((file, remove))
            })?;
            if is_held(file.as_file()) {
                return Ok(Self { file, undo });
            }
        }
        Err(io::Error::other("another program keeps removing the temporary file: try again"))
    }

    /// Returns the path of the temporary file, for programs that write or read files by name.
    pub fn path(&self) -> &Path {
        self.file.path()
    }

    /// Appends `bytes`.
    ///
    /// # Errors
    /// Fails with the system's error if the write fails.
    pub fn write_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        // Do not write through the `NamedTempFile`: its errors contain the temporary name, which means nothing to
        // users.
        self.file.as_file_mut().write_all(bytes)
    }

    /// Syncs the content to the disk and renames the file by `persist`, which returns the new path.
    fn put(self, persist: impl FnOnce(NamedTempFile) -> io::Result<PathBuf>) -> io::Result<PathBuf> {
        // Open the file by name, because another program may have replaced it.
        synced(File::options().write(true).open(self.path())?.sync_all())?;
        let Self { file, undo } = self;
        let place = undo.settle(|| persist(file))?;
        // Sync the folder as well; some file systems cannot.
        let _ = File::open(folder_of(&place)).and_then(|folder| folder.sync_all());
        Ok(place)
    }
}

fn replace(file: NamedTempFile, place: &Path) -> io::Result<PathBuf> {
    file.persist(place).map_err(|error| error.error)?;
    Ok(place.to_owned())
}

/// Renames the file to the first of the [`numbered`] paths that does not exist.
fn put_beside(mut file: NamedTempFile, path: &Path) -> io::Result<PathBuf> {
    for path in numbered(path) {
        match file.persist_noclobber(&path) {
            Ok(_) => return Ok(path),
            Err(error) if path.symlink_metadata().is_ok() => file = error.file,
            // Some file systems have no rename that keeps an existing file.
            Err(error) => return replace(error.file, &path),
        }
    }
    Err(ErrorKind::AlreadyExists.into())
}

/// Returns the error of a temporary file without the file's name.
pub fn without_path(error: io::Error) -> io::Error {
    let text = error.to_string();
    io::Error::new(error.kind(), text.split(" at path ").next().unwrap_or_default().to_owned())
}

/// Ignores the error of a file system that cannot sync.
fn synced(result: io::Result<()>) -> io::Result<()> {
    match result {
        Err(error) if matches!(error.kind(), ErrorKind::InvalidInput | ErrorKind::Unsupported) => Ok(()),
        result => result,
    }
}

/// Locks a newly created file. Returns false if another run has removed it already.
#[cfg(unix)]
fn is_held(file: &File) -> bool {
    use std::os::unix::fs::MetadataExt;
    // On a system without locks, no other run removes the file as abandoned.
    file.lock().is_err() || file.metadata().is_ok_and(|file| file.nlink() > 0)
}

/// Takes no lock on these systems, because a lock would keep other programs from writing. No file counts as
/// abandoned.
#[cfg(not(unix))]
fn is_held(_file: &File) -> bool {
    true
}

/// Removes abandoned files in `folder`. Skips the folder of the previous call, because a program may write thousands
/// of stills into one folder.
fn remove_abandoned_once(folder: &Path) {
    static LAST: Mutex<Option<PathBuf>> = Mutex::new(None);
    let mut last = LAST.lock().unwrap_or_else(PoisonError::into_inner);
    if last.as_deref() != Some(folder) {
        remove_abandoned(folder);
        *last = Some(folder.to_owned());
    }
}

/// Removes the temporary files in `folder` that no process has locked. Keeps files that cannot be checked.
fn remove_abandoned(folder: &Path) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let ours = entry.file_name().as_encoded_bytes().starts_with(PREFIX.as_bytes())
            && entry.file_type().is_ok_and(|kind| kind.is_file());
        // The lock is held during the removal, so that a run that has just created the file notices the removal.
        let file = ours.then(|| File::options().read(true).write(true).open(entry.path()));
        if let Some(Ok(file)) = file
            && cfg!(unix)
            && file.try_lock().is_ok()
        {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// The folder of a file; the working directory for a bare name.
pub fn folder_of(file: &Path) -> &Path {
    file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// A file that is being written under a temporary name.
#[derive(Debug)]
pub struct AtomicFile {
    /// The requested path.
    path: PathBuf,
    /// The target, with links resolved.
    place: PathBuf,
    unfinished: Unfinished,
}

impl AtomicFile {
    /// Opens a temporary file in the folder of `path`, with the extension of `path`. If `path` is a link, its target
    /// is replaced.
    ///
    /// # Errors
    /// [`Unwritable`] if `path` is a folder, a device or a pipe, which a rename would destroy, or if no file can be
    /// created in its folder.
    pub fn create(path: &Path) -> Result<Self, Unwritable> {
        match path.metadata() {
            Ok(found) if found.is_dir() => return Err(refused(path, "it is a folder")),
            Ok(found) if !found.is_file() => return Err(refused(path, "it is a device or a pipe")),
            _ => {}
        }
        let place = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let folder = folder_of(&place);
        if !folder.is_dir() {
            return Err(refused(path, format!("there is no folder {}", folder.display())));
        }
        let mut suffix = OsString::new();
        if let Some(extension) = path.extension() {
            suffix.push(".");
            suffix.push(extension);
        }
        let unfinished =
            Unfinished::create(folder, &suffix).map_err(|error| Unwritable::new(path, &error))?;
        Ok(Self { path: path.to_owned(), place, unfinished })
    }

    /// Creates the folder of `path` if it is missing, and opens a temporary file as [`Self::create`] does.
    ///
    /// # Errors
    /// [`Unwritable`], as [`Self::create`], or if the folder cannot be created.
    pub fn create_with_folder(path: &Path) -> Result<Self, Unwritable> {
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(|error| Unwritable::new(folder, &error))?;
        }
        Self::create(path)
    }

    /// Returns the path of the temporary file, for programs that write files by name.
    pub fn temporary(&self) -> &Path {
        self.unfinished.path()
    }

    /// Writes `bytes` and replaces the target.
    ///
    /// # Errors
    /// [`Unwritable`]; the target is then unchanged.
    pub fn write(mut self, bytes: &[u8]) -> Result<(), Unwritable> {
        self.unfinished.write_all(bytes).map_err(|error| Unwritable::new(&self.path, &error))?;
        self.commit()
    }

    /// Replaces the target with the content written so far.
    ///
    /// # Errors
    /// [`Unwritable`]; the target is then unchanged.
    pub fn commit(self) -> Result<(), Unwritable> {
        let Self { path, place, unfinished } = self;
        unfinished.put(|file| replace(file, &place)).map_err(|error| Unwritable::new(&path, &error))?;
        Ok(())
    }

    /// Puts the content written so far at the path, or at the next free [`numbered`] path. Never replaces a file.
    /// Returns the path of the new file.
    ///
    /// # Errors
    /// [`Unwritable`]
    pub fn commit_beside(self) -> Result<PathBuf, Unwritable> {
        let Self { path, unfinished, .. } = self;
        unfinished.put(|file| put_beside(file, &path)).map_err(|error| Unwritable::new(&path, &error))
    }

    /// Writes `bytes`, and puts them at a free path as [`Self::commit_beside`] does.
    ///
    /// # Errors
    /// [`Unwritable`]
    pub fn write_beside(mut self, bytes: &[u8]) -> Result<PathBuf, Unwritable> {
        self.unfinished.write_all(bytes).map_err(|error| Unwritable::new(&self.path, &error))?;
        self.commit_beside()
    }
}

fn refused(path: &Path, reason: impl Into<String>) -> Unwritable {
    Unwritable::new(path, &io::Error::other(reason.into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_old_file_stays_until_the_new_content_is_complete() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("frame.png");
        std::fs::write(&path, "old").unwrap();
        drop(AtomicFile::create(&path).unwrap());
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
        AtomicFile::create(&path).unwrap().write(b"new").unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "new");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no temporary file is left");
    }

    #[test]
    fn a_new_file_gets_another_name_if_its_name_is_taken() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("song.mp4");
        let paths = ["song.mp4", "song 2.mp4", "song 3.mp4"].map(|name| folder.path().join(name));
        // Both writers begin before the first one ends.
        let (one, two) = (AtomicFile::create(&path).unwrap(), AtomicFile::create(&path).unwrap());
        let made = [one.write_beside(b"one").unwrap(), two.write_beside(b"two").unwrap()];
        let three = AtomicFile::create(&path).unwrap().write_beside(b"three").unwrap();
        assert_eq!([&made[0], &made[1], &three], [&paths[0], &paths[1], &paths[2]]);
        let texts = paths.map(|path| std::fs::read_to_string(path).unwrap());
        assert_eq!(texts, ["one", "two", "three"]);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3, "no temporary file is left");
    }

    #[test]
    fn a_folder_without_permission_was_told_to_free_disk_space() {
        let remedy = |kind: ErrorKind| Unwritable::new(Path::new("a"), &kind.into()).remedy();
        assert_eq!(remedy(ErrorKind::StorageFull), "free some disk space");
        for (kind, words) in
            [(ErrorKind::PermissionDenied, "permissions"), (ErrorKind::ReadOnlyFilesystem, "writable")]
        {
            assert!(remedy(kind).contains(words) && !remedy(kind).contains("space"), "{}", remedy(kind));
        }
    }

    #[cfg(unix)]
    #[test]
    fn devices_are_refused_and_links_are_followed() {
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
    fn abandoned_files_are_removed_and_locked_or_foreign_ones_stay() {
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
        // Another program may write the file by name, as ffmpeg does.
        std::fs::write(living.path(), "by name").unwrap();
        remove_abandoned(folder.path());
        assert_eq!(std::fs::read_to_string(living.path()).unwrap(), "by name");
    }

    #[cfg(unix)]
    #[test]
    fn content_that_another_program_wrote_by_name_replaces_the_target() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("video.mp4");
        std::fs::write(&path, "old").unwrap();
        let file = AtomicFile::create(&path).unwrap();
        std::fs::write(file.temporary(), "new").unwrap();
        file.commit().unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "new");
        // The commit fails if the temporary file was deleted.
        let file = AtomicFile::create(&path).unwrap();
        std::fs::remove_file(file.temporary()).unwrap();
        let message = file.commit().unwrap_err().to_string();
        assert!(message.contains("video.mp4"), "{message}");
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "new");
    }
}
