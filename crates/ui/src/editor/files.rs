//! Texts and their files: read, saved, copied, begun, and what others do to them meanwhile.

use std::sync::Arc;

use super::{Document, Editor, Owner, Question};
use mariana_commands::Command;
use mariana_files::documents::{News, OnDisk};
use mariana_scenes::SceneSource;

/// The text that a new scene begins with.
pub(super) const TEMPLATE: &str = include_str!("new.scene");

impl Editor {
    pub(super) fn take_news(&mut self, news: News) {
        self.revision += 1;
        match news {
            News::Opened { file, holds, kept } => {
                let carried = self.carried.take();
                let Some(document) = self.of(&file) else { return };
                if let OnDisk::Bytes(bytes) = &holds {
                    document.editing = mariana_editing::Editing::new(bytes.to_vec());
                    document.noted = 0;
                    document.forget_colors(0);
                    if let Some((cursor, view)) = carried {
                        document.editing.go_to(cursor, false);
                        document.view = view;
                    }
                }
                let is_other = |text: &[u8]| !matches!(&holds, OnDisk::Bytes(bytes) if **bytes == *text);
                match kept {
                    Some(kept) if is_other(&kept.text) => document.question = Some(Question::Kept(kept)),
                    Some(_) => self.clerk.keep(&file, None),
                    None => {}
                }
                if let Some(document) = self.of(&file) {
                    document.disk = Some(holds);
                }
                self.reveal();
                if let Some(found) = self.findings.clone() {
                    self.take_findings(found);
                }
            }
            News::Saved { file, text } => {
                let drafts = self.drafts.clone();
                let Some(document) = self.of(&file) else { return };
                document.disk = Some(OnDisk::Bytes(text));
                document.question = None;
                let name = document.name();
                if document.is_dirty() {
                    // More was typed meanwhile.
                    let bytes = document.bytes();
                    self.clerk.keep(&file, Some(bytes));
                } else {
                    document.note_sent(drafts.remove(&file));
                    self.commands.push(Command::ReloadScene);
                }
                self.say(format!("{name} is saved"));
            }
            News::Refused { file, holds } => {
                if let Some(document) = self.of(&file) {
                    document.question = Some(Question::Conflict(holds));
                }
            }
            News::Failed { reason, .. } => self.say(reason),
            News::Changed { file, holds } => self.take_change(&file, holds),
            News::Created { file } => {
                self.say(format!("this is your own scene now: {}", file.display()));
                self.commands.push(Command::ShowScene(Box::new(SceneSource::File(file))));
            }
        }
    }

    fn of(&mut self, file: &std::path::Path) -> Option<&mut Document> {
        self.documents.iter_mut().find(|document| document.file() == Some(file))
    }

    /// Another program has changed a file.
    fn take_change(&mut self, file: &std::path::Path, holds: OnDisk) {
        let Some(at) = self.documents.iter().position(|document| document.file() == Some(file)) else {
            return;
        };
        let Some(document) = self.documents.get_mut(at) else { return };
        let dirty = document.is_dirty();
        match holds {
            OnDisk::Bytes(bytes) if *bytes == *document.editing.buffer().bytes() => {
                document.question = None;
                document.disk = Some(OnDisk::Bytes(bytes));
            }
            OnDisk::Bytes(bytes) if !dirty => {
                document.question = None;
                // Longer than a text may be, it stays as it was.
                if document.editing.replace_all(&bytes).is_ok() {
                    document.disk = Some(OnDisk::Bytes(bytes));
                    self.note_change_of(at);
                    self.say("another program has changed the file: this is its new text");
                }
            }
            OnDisk::Bytes(bytes) => document.question = Some(Question::Conflict(OnDisk::Bytes(bytes))),
            OnDisk::Missing => {
                document.question = Some(Question::Gone);
                document.disk = Some(OnDisk::Missing);
                // The scene stays on the stage by its draft.
                let (bytes, file) = (document.bytes(), file.to_owned());
                self.clerk.keep(&file, Some(bytes.clone()));
                let version = self.drafts.set(&file, bytes);
                if let Some(document) = self.documents.get_mut(at) {
                    document.note_sent(version);
                }
                self.commands.push(Command::ReloadScene);
            }
            OnDisk::Unreadable(reason) => {
                let words = format!("{} cannot be read any more: {reason}", document.name());
                self.say(words);
            }
        }
    }

    fn note_change_of(&mut self, at: usize) {
        let shown = std::mem::replace(&mut self.shown, at);
        self.note_change();
        self.shown = shown;
    }

    /// Saves the text that shows, or copies one that has no file.
    pub(super) fn save(&mut self) {
        let Some(document) = self.documents.get(self.shown) else { return };
        match (&document.owner, &document.question) {
            (Owner::Shipped(_), _) => self.copy_to_own_folder(),
            (Owner::File(_), Some(Question::Conflict(_))) => {
                self.say("another program has written this file: choose above whose text stays");
            }
            (Owner::File(_), _) if !document.is_open() => {
                self.say("the file cannot be read, so nothing is written over it");
            }
            (Owner::File(file), _) => {
                self.clerk.save(file, document.bytes(), document.disk.clone());
            }
        }
    }

    /// Saves whatever the file holds.
    pub(super) fn overwrite(&mut self) {
        let Some(document) = self.document() else { return };
        if let Some(file) = document.file() {
            self.clerk.save(file, document.bytes(), None);
        }
    }

    /// Takes the text that another program has written. What was typed can be brought back by undoing.
    pub(super) fn take_theirs(&mut self, theirs: OnDisk) {
        let Some(document) = self.documents.get_mut(self.shown) else { return };
        if let OnDisk::Bytes(bytes) = &theirs
            && let Err(refused) = document.editing.replace_all(bytes)
        {
            return self.say(refused.to_string());
        }
        document.disk = Some(theirs);
        self.note_change();
        self.say("this is their text; Ctrl+Z brings yours back");
    }

    /// Keeps what was typed in an earlier run no longer.
    pub(super) fn forget_kept(&mut self) {
        let Some(file) = self.document().and_then(Document::file) else { return };
        self.clerk.keep(file, None);
    }

    fn copy_to_own_folder(&mut self) {
        let Some(document) = self.document() else { return };
        let Some(folder) = self.clerk.own_scenes() else {
            return self.say("the system has no place for your own scenes: start with --scene FILE.scene");
        };
        let carried = (document.editing.cursor(), document.view);
        self.clerk.create(folder, &document.name(), document.bytes());
        self.carried = Some(carried);
    }

    /// Begins a new scene beside the one that shows, or in the user's folder.
    pub(super) fn begin_scene(&mut self) {
        let beside = self.source.as_ref().and_then(SceneSource::file).and_then(std::path::Path::parent);
        match beside.or_else(|| self.clerk.own_scenes()) {
            Some(folder) => self.clerk.create(folder, "new.scene", Arc::from(TEMPLATE.as_bytes())),
            None => self.say("the system has no place for your own scenes: start with --scene FILE.scene"),
        }
    }
}
