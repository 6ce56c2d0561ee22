//! A text in the editor: whose it is, what it holds, what its file holds, and what is wrong with it.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use mariana_editing::{About, Colors, Editing, Number, about};
use mariana_field::lang::Word;

use mariana_files::documents::{Bytes, Kept, OnDisk};
use mariana_scenes::{Mistake, SceneSource};

/// Whose text it is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Owner {
    /// A file's, which can be changed.
    File(PathBuf),
    /// That of a scene that has no file of its own, which can be copied.
    Shipped(SceneSource),
}

/// Why the text of a shipped scene cannot be changed.
const READ_ONLY: &str =
    "this scene comes with Mariana: Ctrl+S copies it to your folder, and there it can be changed";

/// What the user is asked about a text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Question {
    /// Text of an earlier run was kept that was not saved.
    Kept(Kept),
    /// Another program has written the file while it was changed here.
    Conflict(OnDisk),
    /// The file has gone.
    Gone,
}

/// A mistake where it stands now.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Marked {
    /// Its bytes; empty if it is about the whole.
    pub range: Range<usize>,
    /// The sentence.
    pub message: String,
    /// What to do; may be empty.
    pub hint: String,
}

/// What another program's change of a file means for its text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Change {
    /// Nothing, or a question.
    None,
    /// The text is theirs now.
    Taken,
    /// The file has gone.
    Gone,
    /// The file cannot be read, in words.
    Unreadable(String),
}

/// See the module.
pub(crate) struct Document {
    pub owner: Owner,
    pub editing: Editing,
    colors: RefCell<Colors>,
    /// What the file holds, as far as is known; none while it is being read.
    pub disk: Option<OnDisk>,
    pub question: Option<Question>,
    /// The mistakes of a version of the text.
    found: (u64, Vec<Mistake>),
    /// The version of the text that was last found to be right: the picture shows it.
    shown: u64,
    /// Which version of this text stood in the drafts from which version of those on.
    sent: VecDeque<(u64, u64)>,
    /// The version of which the change was passed on last.
    noted: u64,
    /// First line and first column that show.
    pub view: (f32, f32),
}

/// Most versions of a text that are on their way through the loader.
const SENT_MAX: usize = 256;

impl Document {
    /// A text that is being read.
    pub(crate) fn of_file(file: &Path) -> Self {
        Self::new(Owner::File(file.to_owned()), Vec::new(), None)
    }

    /// A text that cannot be changed.
    pub(crate) fn shipped(source: &SceneSource) -> Self {
        let text = source.text().map_or_else(|error| error.to_string(), std::borrow::Cow::into_owned);
        let bytes: Bytes = Arc::from(text.as_bytes());
        Self::new(Owner::Shipped(source.clone()), text.into_bytes(), Some(OnDisk::Bytes(bytes)))
    }

    fn new(owner: Owner, text: Vec<u8>, disk: Option<OnDisk>) -> Self {
        Self {
            owner,
            editing: Editing::new(text),
            colors: RefCell::default(),
            disk,
            question: None,
            found: (0, Vec::new()),
            shown: 0,
            sent: VecDeque::from([(0, 0)]),
            noted: 0,
            view: (0.0, 0.0),
        }
    }

    /// Its file; none if it cannot be changed.
    pub(crate) fn file(&self) -> Option<&Path> {
        match &self.owner {
            Owner::File(file) => Some(file),
            Owner::Shipped(_) => None,
        }
    }

    /// Whether it is the text of a scene.
    pub(crate) fn is_of(&self, source: &SceneSource) -> bool {
        match (&self.owner, source) {
            (Owner::File(own), SceneSource::File(file)) => own == file,
            (Owner::Shipped(own), source) => own == source,
            _ => false,
        }
    }

    /// What it is called.
    pub(crate) fn name(&self) -> String {
        match &self.owner {
            Owner::File(file) => {
                let name = file.file_name().unwrap_or(file.as_os_str()).to_string_lossy();
                name.replace(char::is_control, " ")
            }
            Owner::Shipped(source) => source.name(),
        }
    }

    /// Whether it can be changed: it was read, and has a file.
    pub(crate) fn is_open(&self) -> bool {
        self.file().is_some() && matches!(self.disk, Some(OnDisk::Bytes(_) | OnDisk::Missing))
    }

    /// Looks whether it can be changed; otherwise says why not.
    pub(super) fn check_open(&self) -> Result<(), &'static str> {
        match (&self.owner, &self.disk) {
            _ if self.is_open() => Ok(()),
            (Owner::Shipped(_), _) => Err(READ_ONLY),
            (_, None) => Err("the file is still being read"),
            _ => Err("the file cannot be read, so it is not changed"),
        }
    }

    /// Takes in what was read of its file. Returns whether what was kept of an earlier run is needed no more.
    pub(super) fn take_read(
        &mut self,
        holds: OnDisk,
        kept: Option<Kept>,
        carried: Option<(usize, (f32, f32))>,
    ) -> bool {
        if let OnDisk::Bytes(bytes) = &holds {
            self.editing = Editing::new(bytes.to_vec());
            self.noted = 0;
            self.forget_colors(0);
            if let Some((cursor, view)) = carried {
                self.editing.go_to(cursor, false);
                self.view = view;
            }
        }
        let is_other = |text: &[u8]| !matches!(&holds, OnDisk::Bytes(bytes) if **bytes == *text);
        let mut is_needless = false;
        match kept {
            Some(kept) if is_other(&kept.text) => self.question = Some(Question::Kept(kept)),
            Some(_) => is_needless = true,
            None => {}
        }
        self.disk = Some(holds);
        is_needless
    }

    /// Another program has changed its file.
    pub(super) fn take_change(&mut self, holds: OnDisk) -> Change {
        match holds {
            OnDisk::Bytes(bytes) if *bytes == *self.editing.buffer().bytes() => {
                self.question = None;
                self.disk = Some(OnDisk::Bytes(bytes));
            }
            OnDisk::Bytes(bytes) if !self.is_dirty() => {
                self.question = None;
                // Longer than a text may be, it stays as it was.
                if self.editing.replace_all(&bytes).is_ok() {
                    self.disk = Some(OnDisk::Bytes(bytes));
                    return Change::Taken;
                }
            }
            OnDisk::Bytes(bytes) => self.question = Some(Question::Conflict(OnDisk::Bytes(bytes))),
            OnDisk::Missing => {
                self.question = Some(Question::Gone);
                self.disk = Some(OnDisk::Missing);
                return Change::Gone;
            }
            OnDisk::Unreadable(reason) => {
                return Change::Unreadable(format!("{} cannot be read any more: {reason}", self.name()));
            }
        }
        Change::None
    }

    /// Notes that the text's change is passed on. Returns whether it was not yet.
    pub(super) fn note_change(&mut self) -> bool {
        let is_new = self.noted != self.editing.version();
        if is_new {
            self.noted = self.editing.version();
            if let Some(line) = self.editing.take_changed_line() {
                self.forget_colors(line);
            }
        }
        is_new
    }

    /// Whether it differs from what its file holds.
    pub(crate) fn is_dirty(&self) -> bool {
        match &self.disk {
            Some(OnDisk::Bytes(bytes)) => self.editing.buffer().bytes() != &**bytes,
            Some(OnDisk::Missing) => !self.editing.buffer().is_empty(),
            _ => false,
        }
    }

    /// Its bytes, to be handed on.
    pub(crate) fn bytes(&self) -> Bytes {
        Arc::from(self.editing.buffer().bytes())
    }

    /// Notes that a version of the drafts has this text.
    pub(crate) fn note_sent(&mut self, drafts: u64) {
        if self.sent.len() >= SENT_MAX {
            self.sent.pop_front();
        }
        self.sent.push_back((drafts, self.editing.version()));
    }

    /// Takes the mistakes that were found with a version of the drafts.
    pub(crate) fn take_mistakes(&mut self, drafts: u64, mistakes: Vec<Mistake>) {
        let sent = self.sent.iter().rev().find(|(version, _)| *version <= drafts);
        self.found = (sent.map_or(0, |(_, version)| *version), mistakes);
    }

    /// Notes that the version of which mistakes were taken last has none.
    pub(crate) fn note_shown(&mut self) {
        self.shown = self.found.0;
    }

    /// Where bytes of the text that the picture shows stand now; none if they were changed since.
    pub(crate) fn place_as_shown(&self, range: Range<usize>) -> Option<Range<usize>> {
        self.editing.place(self.shown, range)
    }

    /// The mistakes where they stand now; those that were changed since have gone.
    pub(crate) fn mistakes(&self) -> impl Iterator<Item = Marked> {
        let (version, found) = &self.found;
        found.iter().filter_map(|one| {
            let range = self.editing.place(*version, one.range.clone())?;
            Some(Marked { range, message: one.message.clone(), hint: one.hint.clone() })
        })
    }

    /// The mistake to tell: the one at the cursor, or else the first.
    pub(crate) fn mistake(&self) -> Option<Marked> {
        let cursor = self.editing.cursor();
        let at_cursor = |one: &Marked| (one.range.start..=one.range.end).contains(&cursor);
        let all: Vec<Marked> = self.mistakes().collect();
        all.iter().find(|one| at_cursor(one)).or(all.first()).cloned()
    }

    /// The next mistake behind the cursor, around the end.
    pub(super) fn next_mistake(&self) -> Option<Marked> {
        let cursor = self.editing.cursor();
        let all: Vec<Marked> = self.mistakes().collect();
        all.iter().find(|one| one.range.start > cursor).or(all.first()).cloned()
    }

    /// The words of a line.
    pub(crate) fn words(&self, line: usize) -> Vec<Word> {
        self.colors.borrow_mut().words(self.editing.buffer(), line)
    }

    /// What is known of the name or the call at a place.
    pub(crate) fn about(&self, offset: usize) -> Option<(Range<usize>, About)> {
        about(self.editing.buffer(), &mut self.colors.borrow_mut(), offset)
    }

    /// What is known of the place at the cursor.
    pub(crate) fn about_cursor(&self) -> Option<About> {
        self.about(self.editing.cursor()).map(|(_, about)| about)
    }

    /// The number at a place, and where its line begins.
    pub(crate) fn number(&self, offset: usize) -> Option<(Number, usize)> {
        let buffer = self.editing.buffer();
        let line = buffer.line_of(offset);
        let start = buffer.line_start(line);
        Some((Number::at(buffer.line(line), &self.words(line), offset - start)?, start))
    }

    /// Does something with the colours.
    pub(crate) fn with_colors<T>(&self, act: impl FnOnce(&mut Colors) -> T) -> T {
        act(&mut self.colors.borrow_mut())
    }

    /// Notes that the text has changed from a line on.
    fn forget_colors(&self, line: usize) {
        self.colors.borrow_mut().forget_behind(line);
    }
}
