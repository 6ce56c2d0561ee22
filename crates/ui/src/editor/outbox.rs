//! Output of the editor: drafts for the loader, values of turned numbers, and commands for the show.

use std::path::Path;

use mariana_commands::Command;
use mariana_field::lang::Turning;
use mariana_scenes::Drafts;

use super::document::Document;

pub(super) struct Outbox {
    pub(super) drafts: Drafts,
    /// True while turned numbers are frame inputs, so that turning them does not reload the text.
    pub(super) turns: bool,
    commands: Vec<Command>,
}

impl Outbox {
    pub(super) fn new(drafts: Drafts) -> Self {
        Self { drafts, turns: false, commands: Vec::new() }
    }

    pub(super) fn send(&mut self, command: Command) {
        self.commands.push(command);
    }

    pub(super) fn drain_commands(&mut self) -> Vec<Command> {
        std::mem::take(&mut self.commands)
    }

    pub(super) fn draft(&mut self, document: &mut Document) {
        let Some(file) = document.file() else { return };
        let version = match document.is_dirty() {
            true => self.drafts.set(file, document.bytes()),
            false => self.drafts.remove(file),
        };
        self.record_sent(version, document);
    }

    fn record_sent(&mut self, version: u64, document: &mut Document) {
        document.record_sent(version);
        self.commands.push(Command::ReloadScene);
    }

    pub(super) fn replace_file(&mut self, document: &mut Document) {
        let Some(file) = document.file() else { return };
        let version = self.drafts.set(file, document.bytes());
        self.record_sent(version, document);
    }

    pub(super) fn hold(&mut self, file: &Path, turning: &[Turning], document: &mut Document) -> u64 {
        if document.is_dirty() {
            self.drafts.set(file, document.bytes());
        }
        let since = self.drafts.turn(Some((file, turning)));
        self.turns = true;
        self.record_sent(since, document);
        since
    }

    pub(super) fn release(&mut self) {
        self.drafts.turn(None);
        self.turns = false;
    }
}
