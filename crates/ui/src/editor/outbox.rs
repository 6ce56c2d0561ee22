//! Output of the editor: drafts for the loader, values of turned numbers, and commands for the show.

use std::path::Path;

use mariana_commands::Command;
use mariana_field::lang::Turning;
use mariana_scenes::Drafts;

use super::document::Document;

pub(super) struct Outbox {
    pub(super) drafts: Drafts,
    /// True while turned numbers are frame inputs, so that turning them does not reload the text.
    turns: bool,
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
        document.record_sent(version);
        self.commands.push(Command::ReloadScene);
    }

    /// Passes a changed text to the loader, unless only turned numbers have changed.
    pub(super) fn draft_change(&mut self, document: &mut Document) {
        if !self.turns {
            self.draft(document);
        }
    }

    pub(super) fn replace_file(&mut self, document: &mut Document) {
        let Some(file) = document.file() else { return };
        let version = self.drafts.set(file, document.bytes());
        document.record_sent(version);
        self.commands.push(Command::ReloadScene);
    }

    pub(super) fn hold(&mut self, file: &Path, turning: &[Turning], document: &mut Document) -> u64 {
        if document.is_dirty() {
            self.drafts.set(file, document.bytes());
        }
        let since = self.drafts.turn(Some((file, turning)));
        document.record_sent(since);
        self.turns = true;
        self.commands.push(Command::ReloadScene);
        since
    }

    pub(super) fn release(&mut self) {
        self.drafts.turn(None);
        self.turns = false;
    }
}
