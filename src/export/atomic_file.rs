//! Output files that are whole or not there: written beside their place and renamed into it at the end, so that
//! a failure never costs the file that was there before.

use std::io::Write;
use std::path::{Path, PathBuf};

use tempfile::{Builder, NamedTempFile, TempPath};

use super::error::ExportError;

/// A file that is being written beside `path`.
pub struct AtomicFile {
    path: PathBuf,
    file: NamedTempFile,
}

impl AtomicFile {
    /// Opens a file beside `path`, with `path`'s extension. A link is followed: it is what it points to that is
    /// replaced.
    ///
    /// # Errors
    /// [`ExportError::Unwritable`] if `path` is a folder, a device or a pipe (renaming would destroy those), or if
    /// its folder takes no files.
    pub fn create(path: &Path) -> Result<Self, ExportError> {
        match path.metadata() {
            Ok(found) if found.is_dir() => return Err(unwritable(path, "it is a folder")),
            Ok(found) if !found.is_file() => return Err(unwritable(path, "it is a device or a pipe")),
            _ => {}
        }
        let place = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let folder = match place.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        if !folder.is_dir() {
            return Err(unwritable(path, format!("there is no folder {}", folder.display())));
        }
        let suffix = path
            .extension()
            .map_or_else(String::new, |extension| format!(".{}", extension.to_string_lossy()));
        let mut builder = Builder::new();
        builder.prefix(".mariana-").suffix(&suffix);
        #[cfg(unix)]
        {
            // As any new file: the user's mask decides, not the privacy of temporary files.
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(std::fs::Permissions::from_mode(0o666));
        }
        let file = builder.tempfile_in(folder).map_err(|error| {
            // The name of the temporary file, which it tells too, means nothing to the user.
            let text = error.to_string();
            unwritable(path, text.split(" at path ").next().unwrap_or(&text))
        })?;
        Ok(Self { path: place, file })
    }

    /// Writes `bytes` and puts the file in its place.
    ///
    /// # Errors
    /// [`ExportError::Unwritable`]; the place then is as it was.
    pub fn write(mut self, bytes: &[u8]) -> Result<(), ExportError> {
        let written = self.file.write_all(bytes).and_then(|()| self.file.flush());
        written.map_err(|error| unwritable(&self.path, error))?;
        self.file.persist(&self.path).map_err(|error| unwritable(&self.path, error.error))?;
        Ok(())
    }

    /// Closes the file so that another program can write it by its name; [`Pending::commit`] puts it in place.
    pub fn close(self) -> Pending {
        Pending { path: self.path, temporary: self.file.into_temp_path() }
    }
}

/// A closed file beside its place. Dropping it removes it.
pub struct Pending {
    path: PathBuf,
    temporary: TempPath,
}

impl Pending {
    /// Where the content goes for now.
    pub fn temporary(&self) -> &Path {
        &self.temporary
    }

    /// Puts the file in its place.
    ///
    /// # Errors
    /// [`ExportError::Unwritable`].
    pub fn commit(self) -> Result<(), ExportError> {
        let Self { path, temporary } = self;
        temporary.persist(&path).map_err(|error| unwritable(&path, error.error))
    }
}

fn unwritable(path: &Path, reason: impl ToString) -> ExportError {
    ExportError::Unwritable { path: path.to_owned(), reason: reason.to_string() }
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
        drop(AtomicFile::create(&path).unwrap().close());
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
}
