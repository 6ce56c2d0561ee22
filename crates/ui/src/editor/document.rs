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
    pub noted: u64,
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

    /// The words of a line.
    pub(crate) fn words(&self, line: usize) -> Vec<Word> {
        self.colors.borrow_mut().words(self.editing.buffer(), line)
    }

    /// What is known of the name or the call at a place.
    pub(crate) fn about(&self, offset: usize) -> Option<(Range<usize>, About)> {
        about(self.editing.buffer(), &mut self.colors.borrow_mut(), offset)
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
    pub(crate) fn forget_colors(&self, line: usize) {
        self.colors.borrow_mut().forget_behind(line);
    }
}
