//! An open text: its source, its edits, the contents of its file, and its mistakes.

use std::borrow::Cow;
use std::cell::RefCell;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use mariana_editing::{About, Colors, Editing, Number, Triple, TripleKind, about, triples};
use mariana_field::lang::Word;

use super::outbox::Outbox;
use super::wrapping::RowPosition;
use mariana_files::documents::{Bytes, Kept, OnDisk};
use mariana_scenes::{Findings, Mistake, SceneSource};

#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Question {
    Kept(Kept),
    /// Another program wrote the file while this document had unsaved edits.
    Conflict(OnDisk),
    Gone,
}

pub(crate) struct Document {
    /// A file, or a shipped scene or formula, which can only be copied.
    pub source: SceneSource,
    pub editing: Editing,
    pub(super) colors: RefCell<Colors>,
    /// The file's contents when last read; `None` while the file is being read.
    pub disk: Option<OnDisk>,
    pub question: Option<Question>,
    /// The version of the text that the loader checked last.
    checked: u64,
    /// The findings about this version, and the number of the text in them.
    found: Option<(Arc<Findings>, usize)>,
    /// The last version of the text that had no mistakes. The frame shows this version.
    shown: u64,
    /// For each draft sent to the loader, oldest first: the version of all drafts, and the version of this text.
    sent: Vec<(u64, u64)>,
    /// The version of the text that was last passed on to the loader.
    noted: u64,
    /// The position of the first visible row.
    pub view: RowPosition,
}

impl Document {
    /// The document of a file is empty until the file has been read.
    pub(crate) fn of(source: &SceneSource) -> Self {
        let text = match source.file() {
            Some(_) => None,
            None => Some(source.text().map_or_else(|error| error.to_string(), Cow::into_owned).into_bytes()),
        };
        let disk = text.as_deref().map(|text| OnDisk::Bytes(Bytes::from(text)));
        Self {
            source: source.clone(),
            editing: Editing::new(text.unwrap_or_default()),
            colors: RefCell::default(),
            disk,
            question: None,
            checked: 0,
            found: None,
            shown: 0,
            sent: vec![(0, 0)],
            noted: 0,
            view: (0.0, 0.0),
        }
    }

    pub(crate) fn file(&self) -> Option<&Path> {
        self.source.file()
    }

    pub(crate) fn name(&self) -> String {
        match self.file() {
            Some(file) => {
                let name = file.file_name().unwrap_or(file.as_os_str()).to_string_lossy();
                name.replace(char::is_control, " ")
            }
            None => self.source.name(),
        }
    }

    pub(crate) fn is_open(&self) -> bool {
        self.file().is_some() && matches!(self.disk, Some(OnDisk::Bytes(_) | OnDisk::Missing))
    }

    pub(super) fn check_open(&self) -> Result<(), &'static str> {
        match (&self.source, &self.disk) {
            _ if self.is_open() => Ok(()),
            (SceneSource::File(_), None) => Err("please wait: the file is still loading"),
            (SceneSource::File(_), _) => Err("the file cannot be read, so it cannot be edited"),
            (SceneSource::Formula(_), _) => {
                Err("this formula has no file: press Ctrl+S to save it as a scene, then edit the scene")
            }
            _ => Err("this scene comes with Mariana: press Ctrl+S to make your own copy, then edit the copy"),
        }
    }

    /// Loads the contents of the file, and the backup of an earlier run.
    pub(super) fn load(
        &mut self,
        holds: OnDisk,
        kept: Option<Kept>,
        carried: Option<(usize, RowPosition)>,
        outbox: &Outbox,
    ) {
        if let OnDisk::Bytes(bytes) = &holds {
            self.editing = Editing::new(bytes.to_vec());
            self.noted = 0;
            self.colors.get_mut().forget_behind(0);
            if let Some((cursor, view)) = carried {
                self.editing.move_to(cursor, false);
                self.view = view;
            }
        }
        let is_same = |kept: &Kept| matches!(&holds, OnDisk::Bytes(bytes) if **bytes == *kept.text);
        let is_needless = kept.as_ref().is_some_and(is_same);
        self.disk = Some(holds);
        if is_needless {
            outbox.keep(self);
        } else {
            self.question = kept.map(Question::Kept);
        }
    }

    /// Takes a change of the file by another program. Returns a message, if the user must know.
    pub(super) fn read_change(&mut self, holds: OnDisk, outbox: &mut Outbox) -> Option<String> {
        match holds {
            OnDisk::Bytes(bytes) if *bytes == *self.editing.buffer().bytes() => {
                self.question = None;
                self.disk = Some(OnDisk::Bytes(bytes));
            }
            OnDisk::Bytes(bytes) if !self.is_dirty() => {
                self.question = None;
                // If the new text is too long, keep the old text.
                if self.editing.replace_all(&bytes).is_ok() {
                    self.disk = Some(OnDisk::Bytes(bytes));
                    outbox.pass_on(self);
                    return Some("reloaded: another program has changed the file".to_owned());
                }
            }
            OnDisk::Bytes(bytes) => self.question = Some(Question::Conflict(OnDisk::Bytes(bytes))),
            OnDisk::Missing => {
                self.question = Some(Question::Gone);
                self.disk = Some(OnDisk::Missing);
                // The file is gone, but its text stays in the drafts, so the scene stays on screen.
                outbox.keep(self);
                outbox.draft(self);
            }
            OnDisk::Unreadable(reason) => {
                return Some(format!("cannot read {} again: {reason}", self.name()));
            }
        }
        None
    }

    pub(super) fn record_change(&mut self) -> bool {
        let is_new = self.noted != self.editing.version();
        if is_new {
            self.noted = self.editing.version();
            if let Some(line) = self.editing.changed_line() {
                self.colors.get_mut().forget_behind(line);
            }
        }
        is_new
    }

    pub(crate) fn is_dirty(&self) -> bool {
        match &self.disk {
            Some(OnDisk::Bytes(bytes)) => self.editing.buffer().bytes() != &**bytes,
            Some(OnDisk::Missing) => !self.editing.buffer().is_empty(),
            _ => false,
        }
    }

    pub(crate) fn bytes(&self) -> Bytes {
        Arc::from(self.editing.buffer().bytes())
    }

    pub(crate) fn record_sent(&mut self, drafts: u64) {
        self.sent.push((drafts, self.editing.version()));
    }

    /// Shows the mistakes in the text, which has this number among the texts of the scene.
    pub(crate) fn show_findings(&mut self, findings: &Arc<Findings>, number: usize) {
        let sent = self.sent.iter().rev().find(|(version, _)| *version <= findings.version);
        self.checked = sent.map_or(0, |(_, version)| *version);
        if findings.mistakes.is_empty() {
            self.shown = self.checked;
        }
        self.found = Some((findings.clone(), number));
    }

    /// Maps `range` from the version that the frame shows to the present text; `None` if that part was edited since.
    pub(crate) fn place_as_shown(&self, range: Range<usize>) -> Option<Range<usize>> {
        self.editing.place(self.shown, range)
    }

    /// The mistakes at their present positions. Leaves out mistakes whose text has been edited.
    pub(crate) fn mistakes(&self) -> impl Iterator<Item = Mistake> {
        self.marked(|found| &found.mistakes)
    }

    /// The warnings at their present positions. Leaves out warnings whose text has been edited.
    pub(crate) fn warnings(&self) -> impl Iterator<Item = Mistake> {
        self.marked(|found| &found.warnings)
    }

    fn marked(&self, of: fn(&Findings) -> &[Mistake]) -> impl Iterator<Item = Mistake> {
        let found = self.found.as_ref();
        let (found, number) = found.map_or((&[][..], 0), |(found, number)| (of(found), *number));
        found.iter().filter(move |one| one.text == number).filter_map(|one| {
            let range = self.editing.place(self.checked, one.range.clone())?;
            Some(Mistake { range, ..one.clone() })
        })
    }

    /// The warning at the cursor.
    pub(crate) fn warning(&self) -> Option<Mistake> {
        let cursor = self.editing.cursor();
        self.warnings().find(|one| (one.range.start..=one.range.end).contains(&cursor))
    }

    pub(crate) fn mistake(&self) -> Option<Mistake> {
        let cursor = self.editing.cursor();
        let at_cursor = |one: &Mistake| (one.range.start..=one.range.end).contains(&cursor);
        let all: Vec<Mistake> = self.mistakes().collect();
        all.iter().find(|one| at_cursor(one)).or(all.first()).cloned()
    }

    pub(super) fn next_mistake(&self) -> Option<Mistake> {
        let cursor = self.editing.cursor();
        let all: Vec<Mistake> = self.mistakes().collect();
        all.iter().find(|one| one.range.start > cursor).or(all.first()).cloned()
    }

    pub(crate) fn words(&self, line: usize) -> Vec<Word> {
        self.colors.borrow_mut().words(self.editing.buffer(), line)
    }

    pub(crate) fn about(&self, offset: usize) -> Option<(Range<usize>, About)> {
        about(self.editing.buffer(), &mut self.colors.borrow_mut(), offset)
    }

    pub(crate) fn number(&self, offset: usize) -> Option<(Number, usize)> {
        let buffer = self.editing.buffer();
        let line = buffer.line_of(offset);
        let start = buffer.line_start(line);
        Some((Number::at(buffer.line(line), &self.words(line), offset - start)?, start))
    }

    // Triples of numbers are colours to pick, and positions to drag in the frame. While the user changes a triple, its
    // numbers are frame inputs, like a turned number.

    /// Returns the `vec3` calls in `line` whose arguments are number literals, and the byte offset of the line's start.
    pub(crate) fn triples(&self, line: usize) -> (Vec<Triple>, usize) {
        let buffer = self.editing.buffer();
        (triples(buffer, &mut self.colors.borrow_mut(), line), buffer.line_start(line))
    }

    /// Returns the triple that contains byte `at`, and the byte offset of the triple's line.
    pub(super) fn triple_at(&self, at: usize) -> Option<(Triple, usize)> {
        let (triples, start) = self.triples(self.editing.buffer().line_of(at));
        let inside = at.checked_sub(start)?;
        let triple = triples.into_iter().find(|one| (one.range.start..=one.range.end).contains(&inside))?;
        Some((triple, start))
    }

    pub(super) fn color_at(&self, at: usize) -> Option<(Triple, usize)> {
        self.triple_at(at).filter(|(triple, _)| triple.kind == TripleKind::Color)
    }

    /// Returns the position written at the cursor, and its sign in the scene: -1 if the scene negates it, otherwise 1.
    pub(super) fn place_at_cursor(&self) -> Option<([f64; 3], f64)> {
        let (triple, _) = self.triple_at(self.editing.cursor()).filter(|_| self.is_open())?;
        match triple.kind {
            TripleKind::Place { turned } => Some((triple.values(), if turned { -1.0 } else { 1.0 })),
            TripleKind::Color | TripleKind::Other => None,
        }
    }
}
