//! The texts of the edited scene. Connects the open documents, their files, and the loader's drafts and findings.

use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use mariana_commands::Command;
use mariana_editing::{Editing, Refused};
use mariana_field::lang::Turning;
use mariana_files::Folders;
use mariana_files::documents::{FileEvent, FileThread, OnDisk};
use mariana_scenes::{Drafts, Findings, Mistake, SceneSource};

use super::document::{Document, Question};
use super::documents::{Documents, Tab};
use super::outbox::Outbox;

pub(super) const TEMPLATE: &str = include_str!("new.scene");
/// Maximum time to wait for backups when the program exits.
const KEEP_LIMIT: Duration = Duration::from_secs(3);
const NO_FOLDER: &str = "there is no folder for your own scenes: start Mariana with --scene FILE.scene";

/// An edit of the visible text, for later.
pub(super) type Edit = Box<dyn FnOnce(&mut Editing) -> Result<(), Refused>>;

pub(crate) struct Texts {
    pub(super) documents: Documents,
    /// The edited scene, and the loader's findings about it.
    pub(super) source: Option<SceneSource>,
    pub(super) findings: Option<Arc<Findings>>,
    pub(super) outbox: Outbox,
}

impl Texts {
    pub(super) fn start(
        drafts: Drafts,
        folders: &Folders,
        wake: impl Fn() + Send + 'static,
    ) -> io::Result<Self> {
        Ok(Self {
            documents: Documents::new(),
            source: None,
            findings: None,
            outbox: Outbox {
                files: FileThread::start(folders, wake)?,
                drafts,
                turns: false,
                commands: Vec::new(),
            },
        })
    }

    /// True while the file of the visible text is being read, or a copy of the text is being made.
    pub(super) fn are_loading(&self) -> bool {
        let reads = |document: &Document| document.file().is_some() && document.disk.is_none();
        self.documents.shown().is_some_and(reads) || self.documents.carried.is_some()
    }

    pub(crate) fn tabs(&self) -> Vec<Tab> {
        self.documents.tabs(self.findings.as_deref())
    }

    pub(super) fn is_main(&self) -> bool {
        let shown = self.documents.shown();
        shown.is_some_and(|document| self.source.as_ref() == Some(&document.source))
    }

    pub(super) fn number(&self) -> usize {
        let file = self.documents.shown().and_then(Document::file);
        file.and_then(|file| self.findings.as_ref()?.texts.iter().position(|one| one == file)).unwrap_or(0)
    }

    pub(super) fn next_number(&self) -> Option<usize> {
        let tabs = self.tabs();
        let at = tabs.iter().position(|tab| tab.shows).unwrap_or(0);
        (tabs.len() > 1).then(|| (at + 1) % tabs.len())
    }

    pub(super) fn file(&self, number: usize) -> Option<&Path> {
        self.findings.as_ref()?.texts.get(number).map(PathBuf::as_path)
    }

    /// The text with this number, which is a file of the scene.
    pub(super) fn source_of(&self, number: usize) -> Option<SceneSource> {
        self.file(number).map(|file| SceneSource::File(file.to_owned()))
    }

    fn text(&self, number: usize) -> Option<&Document> {
        match self.file(number) {
            Some(file) => self.documents.of(file),
            None => self.documents.shown().filter(|_| number == 0),
        }
    }

    /// Returns the line that contains `range` of the loaded text: its file name, number from 1, and trimmed text.
    pub(crate) fn line_at(&self, number: usize, range: Range<usize>) -> Option<(String, usize, String)> {
        let document = self.text(number)?;
        let now = document.place_as_shown(range)?;
        let buffer = document.editing.buffer();
        let line = buffer.line_of(now.start);
        let words = String::from_utf8_lossy(buffer.line(line)).trim().to_owned();
        Some((document.name(), line + 1, words))
    }

    /// Returns the index, from 0, of the line that contains `range` of the loaded text, if that text is visible.
    pub(super) fn shown_line_at(&self, number: usize, range: Range<usize>) -> Option<usize> {
        let document = self.text(number)?;
        let shows = self.documents.shown().is_some_and(|shown| std::ptr::eq(shown, document));
        let now = document.place_as_shown(range).filter(|_| shows)?;
        Some(document.editing.buffer().line_of(now.start))
    }

    /// Returns the next mistake of the visible text. Without one, returns the number of another text with mistakes.
    pub(super) fn next_mistake(&self) -> Result<Mistake, Option<usize>> {
        let next = self.documents.shown().and_then(Document::next_mistake);
        next.ok_or_else(|| self.findings.as_ref()?.mistakes.first().map(|one| one.text))
    }

    pub(super) fn show_scene(&mut self, source: &SceneSource) {
        self.source = Some(source.clone());
        self.findings = self.outbox.drafts.findings(source);
        self.show(source);
    }

    /// Shows a text. Returns true if its file must be read first.
    pub(super) fn show(&mut self, source: &SceneSource) -> bool {
        let is_read = self.documents.show(source);
        if let Some(file) = source.file().filter(|_| is_read) {
            self.outbox.files.open(file);
        }
        self.mark_mistakes();
        is_read
    }

    pub(super) fn select(&mut self, number: usize, range: Range<usize>) {
        if let Some(text) = self.source_of(number) {
            if self.show(&text) {
                // The cursor is set when the file has been read.
                return self.documents.carried = Some((range.start, (0.0, 0.0)));
            }
        } else if number > 0 {
            return;
        }
        self.documents.select_loaded(range);
    }

    pub(super) fn edit(
        &mut self,
        change: impl FnOnce(&mut Editing) -> Result<(), Refused>,
    ) -> Result<(), String> {
        let Some(document) = self.documents.shown_mut() else { return Ok(()) };
        document.check_open()?;
        let changed = change(&mut document.editing);
        self.record_change();
        self.documents.reveal();
        changed.map_err(|refused| refused.to_string())
    }

    pub(super) fn record_change(&mut self) {
        if let Some(document) = self.documents.shown_mut() {
            self.outbox.pass_on(document);
        }
    }

    /// Saves the visible text, unless another program has changed its file in the meantime. Copies a text without a
    /// file to the user's own scenes.
    pub(super) fn save(&mut self) -> Result<(), &'static str> {
        let Some(document) = self.documents.shown() else { return Ok(()) };
        let files = &self.outbox.files;
        let Some(file) = document.file() else {
            files.create(files.own_scenes().ok_or(NO_FOLDER)?, &document.name(), document.bytes());
            let (cursor, view) = (document.editing.cursor(), document.view);
            self.documents.carried = Some((cursor, view));
            return Ok(());
        };
        if let Some(Question::Conflict(_)) = document.question {
            return Err("another program has changed this file: above the text, choose the version to keep");
        }
        if !document.is_open() {
            return Err("not saved: the file cannot be read, and saving could overwrite it");
        }
        files.save(file, document.bytes(), document.disk.clone());
        Ok(())
    }

    /// Saves the visible text, even if another program has changed its file.
    pub(super) fn overwrite(&self) {
        let document = self.documents.shown();
        if let Some((document, file)) = document.and_then(|document| Some((document, document.file()?))) {
            self.outbox.files.save(file, document.bytes(), None);
        }
    }

    /// Replaces the user's text by the text that the other program wrote. Undo brings back the user's text.
    pub(super) fn adopt_theirs(&mut self, theirs: OnDisk) -> Result<(), Refused> {
        let Some(document) = self.documents.shown_mut() else { return Ok(()) };
        if let OnDisk::Bytes(bytes) = &theirs {
            document.editing.replace_all(bytes)?;
        }
        document.disk = Some(theirs);
        self.record_change();
        Ok(())
    }

    pub(super) fn forget_kept(&self) {
        if let Some(file) = self.documents.shown().and_then(Document::file) {
            self.outbox.files.keep(file, None);
        }
    }

    pub(super) fn begin_scene(&self) -> Result<(), &'static str> {
        let beside = self.source.as_ref().and_then(SceneSource::file).and_then(Path::parent);
        let files = &self.outbox.files;
        let folder = beside.or_else(|| files.own_scenes()).ok_or(NO_FOLDER)?;
        files.create(folder, "new.scene", Arc::from(TEMPLATE.as_bytes()));
        Ok(())
    }

    pub(super) fn finish(&self) {
        self.documents.unsaved().for_each(|document| self.outbox.keep(document));
        self.outbox.files.finish(KEEP_LIMIT);
    }

    pub(super) fn hold(&mut self, file: &Path, turning: &[Turning]) -> Option<u64> {
        let document = self.documents.shown_mut()?;
        if document.is_dirty() {
            self.outbox.drafts.set(file, document.bytes());
        }
        let since = self.outbox.drafts.turn(Some((file, turning)));
        self.outbox.turns = true;
        self.outbox.record_sent(since, document);
        Some(since)
    }

    pub(super) fn release(&mut self) {
        self.outbox.drafts.turn(None);
        self.outbox.turns = false;
        if let Some(document) = self.documents.shown_mut() {
            self.outbox.draft(document);
        }
    }

    /// Takes new findings about the edited scene. Returns true if there are any.
    pub(super) fn update_findings(&mut self) -> bool {
        let newest = self.source.as_ref().and_then(|source| self.outbox.drafts.findings(source));
        let is_new = |one: &Arc<Findings>| self.findings.as_ref().is_none_or(|now| !Arc::ptr_eq(now, one));
        let Some(newest) = newest.filter(is_new) else { return false };
        self.findings = Some(newest);
        self.mark_mistakes();
        true
    }

    fn mark_mistakes(&mut self) {
        if let Some(findings) = self.findings.as_ref() {
            self.documents.show_findings(findings);
        }
    }

    pub(super) fn receive_event(&mut self, file_events: FileEvent) -> Option<String> {
        match file_events {
            FileEvent::Opened { file, holds, kept } => {
                let carried = self.documents.carried.take();
                self.documents.of_mut(&file)?.load(holds, kept, carried, &self.outbox);
                self.documents.reveal();
                self.mark_mistakes();
                None
            }
            FileEvent::Saved { file, text } => {
                let document = self.documents.of_mut(&file)?;
                document.disk = Some(OnDisk::Bytes(text));
                document.question = None;
                if document.is_dirty() {
                    // The user typed more text during the save.
                    self.outbox.keep(document);
                } else {
                    self.outbox.draft(document);
                }
                Some(format!("saved {}", document.name()))
            }
            FileEvent::Refused { file, holds } => {
                self.documents.of_mut(&file)?.question = Some(Question::Conflict(holds));
                None
            }
            FileEvent::Failed(reason) => {
                self.documents.carried = None;
                Some(reason)
            }
            FileEvent::Changed { file, holds } => {
                self.documents.of_mut(&file)?.read_change(holds, &mut self.outbox)
            }
            FileEvent::Created(file) => {
                let words = format!("created {}", file.display());
                self.outbox.commands.push(Command::ShowScene(Box::new(SceneSource::File(file))));
                Some(words)
            }
        }
    }
}
