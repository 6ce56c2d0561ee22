//! Output of the editor: drafts for the loader, backups, values of turned numbers, and commands for the show.

use mariana_commands::Command;
use mariana_files::documents::FileThread;
use mariana_scenes::Drafts;

use super::document::Document;

pub(super) struct Outbox {
    /// Does all reading and writing.
    pub(super) files: FileThread,
    pub(super) drafts: Drafts,
    /// True while turned numbers are frame inputs, so that turning them does not reload the text.
    pub(super) turns: bool,
    pub(super) commands: Vec<Command>,
}

impl Outbox {
    /// Passes a changed text to the loader and to its backup.
    pub(super) fn pass_on(&mut self, document: &mut Document) {
        if document.record_change() {
            self.keep(document);
            // Turned numbers do not reload the text.
            if !self.turns {
                self.draft(document);
            }
        }
    }

    /// Backs up a text that has unsaved edits; deletes the backup of any other text.
    pub(super) fn keep(&self, document: &Document) {
        if let Some(file) = document.file() {
            self.files.keep(file, document.is_dirty().then(|| document.bytes()));
        }
    }

    pub(super) fn draft(&mut self, document: &mut Document) {
        let Some(file) = document.file() else { return };
        let version = match document.is_dirty() {
            true => self.drafts.set(file, document.bytes()),
            false => self.drafts.remove(file),
        };
        self.record_sent(version, document);
    }

    pub(super) fn record_sent(&mut self, version: u64, document: &mut Document) {
        document.record_sent(version);
        self.commands.push(Command::ReloadScene);
    }
}
