//! Reads, saves, copies and creates the files of the texts, and backs up unsaved text.

use std::io;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use mariana_files::Folders;
use mariana_files::documents::FileThread;

use super::document::{Document, Question};

pub(super) const TEMPLATE: &str = include_str!("new.scene");
/// Maximum time to wait for backups when the program exits.
pub(super) const KEEP_LIMIT: Duration = Duration::from_secs(3);
const NO_FOLDER: &str = "there is no folder for your own scenes: start Mariana with --scene FILE.scene";

/// Access to the file thread, which does all reading and writing.
pub(super) struct Files {
    pub(super) file_thread: FileThread,
}

impl Files {
    pub(super) fn start(folders: &Folders, wake: impl Fn() + Send + 'static) -> io::Result<Self> {
        Ok(Self { file_thread: FileThread::start(folders, wake)? })
    }

    /// Backs up a text that has unsaved edits; deletes the backup of any other text.
    pub(super) fn keep(&self, document: &Document) {
        if let Some(file) = document.file() {
            self.file_thread.keep(file, document.is_dirty().then(|| document.bytes()));
        }
    }

    pub(super) fn keep_gone(&self, document: &Document) {
        if let Some(file) = document.file() {
            self.file_thread.keep(file, Some(document.bytes()));
        }
    }

    /// Saves a text, unless another program has changed the file in the meantime.
    pub(super) fn save(&self, document: &Document) -> Result<(), &'static str> {
        let Some(file) = document.file() else { return Ok(()) };
        if let Some(Question::Conflict(_)) = document.question {
            return Err("another program has changed this file: above the text, choose the version to keep");
        }
        if !document.is_open() {
            return Err("not saved: the file cannot be read, and saving could overwrite it");
        }
        self.file_thread.save(file, document.bytes(), document.disk.clone());
        Ok(())
    }

    pub(super) fn copy(&self, document: &Document) -> Result<(), &'static str> {
        let folder = self.file_thread.own_scenes().ok_or(NO_FOLDER)?;
        self.file_thread.create(folder, &document.name(), document.bytes());
        Ok(())
    }

    pub(super) fn begin(&self, folder: Option<&Path>) -> Result<(), &'static str> {
        let folder = folder.or_else(|| self.file_thread.own_scenes()).ok_or(NO_FOLDER)?;
        self.file_thread.create(folder, "new.scene", Arc::from(TEMPLATE.as_bytes()));
        Ok(())
    }
}
