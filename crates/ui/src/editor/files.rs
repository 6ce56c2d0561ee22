//! The files of the texts: read, saved, copied, begun, and what is kept of those that are not saved.

use std::io;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use mariana_files::Folders;
use mariana_files::documents::{FileEvent, FileThread};

use super::document::{Document, Question};

/// The text that a new scene begins with.
pub(super) const TEMPLATE: &str = include_str!("new.scene");
/// How long the end of the program waits for texts to be kept.
const KEEP_LIMIT: Duration = Duration::from_secs(3);
const NO_FOLDER: &str = "the system has no place for your own scenes: start with --scene FILE.scene";

/// See the module. Disks are the clerk's.
pub(super) struct Files {
    file_thread: FileThread,
}

impl Files {
    pub(super) fn start(folders: &Folders, wake: impl Fn() + Send + 'static) -> io::Result<Self> {
        Ok(Self { file_thread: FileThread::start(folders, wake)? })
    }

    /// Begins to read a file.
    pub(super) fn open(&self, file: &Path) {
        self.file_thread.open(file);
    }

    /// What has happened to files.
    pub(super) fn file_events(&self) -> Option<FileEvent> {
        self.file_thread.file_events()
    }

    /// Keeps a text while it is not saved.
    pub(super) fn keep(&self, document: &Document) {
        if let Some(file) = document.file() {
            self.file_thread.keep(file, document.is_dirty().then(|| document.bytes()));
        }
    }

    /// Keeps a text whose file has gone.
    pub(super) fn keep_gone(&self, document: &Document) {
        if let Some(file) = document.file() {
            self.file_thread.keep(file, Some(document.bytes()));
        }
    }

    /// Keeps what was typed in an earlier run no longer.
    pub(super) fn forget_kept(&self, file: &Path) {
        self.file_thread.keep(file, None);
    }

    /// Saves a text, unless the file holds what nobody has seen here.
    pub(super) fn save(&self, document: &Document) -> Result<(), &'static str> {
        let Some(file) = document.file() else { return Ok(()) };
        if let Some(Question::Conflict(_)) = document.question {
            return Err("another program has written this file: choose above whose text stays");
        }
        if !document.is_open() {
            return Err("the file cannot be read, so nothing is written over it");
        }
        self.file_thread.save(file, document.bytes(), document.disk.clone());
        Ok(())
    }

    /// Saves a text whatever the file holds.
    pub(super) fn overwrite(&self, document: &Document) {
        if let Some(file) = document.file() {
            self.file_thread.save(file, document.bytes(), None);
        }
    }

    /// Copies a text to the user's folder.
    pub(super) fn copy(&self, document: &Document) -> Result<(), &'static str> {
        let folder = self.file_thread.own_scenes().ok_or(NO_FOLDER)?;
        self.file_thread.create(folder, &document.name(), document.bytes());
        Ok(())
    }

    /// Begins a new scene in a folder, or in the user's.
    pub(super) fn begin(&self, folder: Option<&Path>) -> Result<(), &'static str> {
        let folder = folder.or_else(|| self.file_thread.own_scenes()).ok_or(NO_FOLDER)?;
        self.file_thread.create(folder, "new.scene", Arc::from(TEMPLATE.as_bytes()));
        Ok(())
    }

    /// Waits until everything is kept: the program ends.
    pub(super) fn finish(&self) {
        self.file_thread.finish(KEEP_LIMIT);
    }
}
