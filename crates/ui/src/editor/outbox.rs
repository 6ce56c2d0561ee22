//! What the editor sends to the show: its texts as drafts, numbers that a hand turns, and commands.

use std::path::Path;

use mariana_commands::Command;
use mariana_field::lang::Turning;
use mariana_scenes::{Drafts, Findings};

use super::document::Document;

/// See the module.
pub(super) struct Outbox {
    drafts: Drafts,
    /// Whether numbers of a text are inputs of the frame: for their values it is not read.
    turns: bool,
    /// Commands that wait to be sent.
    commands: Vec<Command>,
}

impl Outbox {
    pub(super) fn new(drafts: Drafts) -> Self {
        Self { drafts, turns: false, commands: Vec::new() }
    }

    pub(super) fn send(&mut self, command: Command) {
        self.commands.push(command);
    }

    /// Returns the commands since the last call.
    pub(super) fn take_commands(&mut self) -> Vec<Command> {
        std::mem::take(&mut self.commands)
    }

    /// What the loader found since the last call.
    pub(super) fn take_findings(&self) -> Vec<Findings> {
        self.drafts.take_findings()
    }

    /// Hands a text to the loader as it is.
    pub(super) fn draft(&mut self, document: &mut Document) {
        let Some(file) = document.file() else { return };
        let version = match document.is_dirty() {
            true => self.drafts.set(file, document.bytes()),
            false => self.drafts.remove(file),
        };
        document.note_sent(version);
        self.commands.push(Command::ReloadScene);
    }

    /// Hands a changed text to the loader, unless its numbers go into the frame without it.
    pub(super) fn draft_change(&mut self, document: &mut Document) {
        if !self.turns {
            self.draft(document);
        }
    }

    /// Lets a text stand for its file, which has gone.
    pub(super) fn replace_file(&mut self, document: &mut Document) {
        let Some(file) = document.file() else { return };
        let version = self.drafts.set(file, document.bytes());
        document.note_sent(version);
        self.commands.push(Command::ReloadScene);
    }

    /// Makes numbers of a file's text inputs of the frame. Returns the version of the drafts from which on they are.
    pub(super) fn hold(&mut self, file: &Path, turning: &[Turning], document: &mut Document) -> u64 {
        if document.is_dirty() {
            self.drafts.set(file, document.bytes());
        }
        let since = self.drafts.turn(Some((file, turning)));
        document.note_sent(since);
        self.turns = true;
        self.commands.push(Command::ReloadScene);
        since
    }

    /// Lets the text hold for its numbers again.
    pub(super) fn release(&mut self) {
        self.drafts.turn(None);
        self.turns = false;
    }
}
