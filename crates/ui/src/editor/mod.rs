//! The editor in the window: the text of the scene on the stage, its keys, its files, and what is told of it.
//!
//! It is a plain value that keys and the pointer change, and the overlay draws it. Every change goes to the loader as a
//! draft ([`Drafts`]), which stands in the place of the file: what is right shows in the next frame, what is not is marked
//! here. Disks are the clerk's ([`Clerk`]), the clipboard is its own thread's.

mod acting;
mod document;
mod files;
pub mod keys;
mod portraits;
mod probed;
mod proposing;
#[cfg(test)]
mod tests;
mod triples;
mod turning;

use std::io;
use std::ops::Range;
use std::path::Path;
use std::time::{Duration, Instant};

pub(crate) use document::{Document, Marked, Owner, Question};
pub use keys::EditAction;
use mariana_editing::{About, TurnSpeed};
pub(crate) use portraits::{Portrait, SIDE as PORTRAIT_SIDE};
pub(crate) use probed::Light;
pub(crate) use proposing::Proposing;
use turning::Turn;

use crate::clipboard::Clipboard;
use crate::clock;
use mariana_commands::{Command, Panel};
use mariana_files::Folders;
use mariana_files::documents::Clerk;
use mariana_scenes::{Drafts, Findings, SceneSource};

/// How long an answer to a key stays.
const ANSWER_STAYS: Duration = Duration::from_secs(6);
/// How long the end of the program waits for texts to be kept.
const KEEP_LIMIT: Duration = Duration::from_secs(3);

/// What the pointer asks of the editor. Places are bytes of the text that shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EditorEvent {
    /// The pointer was pressed at a place.
    Press {
        /// The place.
        at: usize,
        /// How often, quickly.
        clicks: u8,
        /// Whether what lies between is selected.
        select: bool,
    },
    /// It was drawn to a place.
    DragTo(usize),
    /// It has taken the number at a place.
    Grab(usize),
    /// It turns that number by so many points.
    Turn {
        /// Points to the right.
        points: f32,
        /// How far that turns it.
        speed: TurnSpeed,
    },
    /// It has let go of the number, or of the three.
    LetGo,
    /// To pick the colour whose three numbers are at a place.
    PickColor(usize),
    /// To pick no colour any more.
    ClosePicker,
    /// The colour that is picked, as it is in the text.
    SetColor([f64; 3]),
    /// To move the position at the cursor by so much.
    MovePlace([f64; 3]),
    /// It scrolls by so many lines and columns.
    Scroll {
        /// Down.
        lines: f32,
        /// To the right.
        columns: f32,
    },
    /// Nothing: so many lines and columns were drawn.
    Drawn {
        /// The lines.
        rows: usize,
        /// The columns.
        columns: usize,
    },
    /// What a key does, too.
    Act(EditAction),
    /// To show another text of the scene.
    ShowText(usize),
    /// To go to what made the point of the picture that was clicked.
    GoToProbed,
    /// To close what is told of it.
    CloseProbed,
    /// To go to a byte of one of the scene's texts, as they were loaded.
    GoTo {
        /// The text.
        text: usize,
        /// The byte.
        byte: usize,
    },
    /// To take a proposal.
    Take(usize),
    /// An answer to what is asked about the text.
    Answer {
        /// Whether the first thing is done, else the second.
        first: bool,
    },
}

/// Closes the editor.
const CLOSE: Command = Command::TogglePanel(Panel::Editor);

/// What is looked for.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default)]
pub(crate) struct Find {
    /// The words.
    pub query: String,
    /// Whether keys go there.
    pub typing: bool,
}

/// See the module.
pub struct Editor {
    drafts: Drafts,
    clerk: Clerk,
    clipboard: Clipboard,
    documents: Vec<Document>,
    shown: usize,
    /// The scene whose text is shown.
    source: Option<SceneSource>,
    /// What the loader found last in it.
    findings: Option<Findings>,
    /// What it found in others.
    others: Vec<Findings>,
    focused: bool,
    /// Whether a key is still held that was not meant for the text.
    ignores_repeats: bool,
    find: Option<Find>,
    /// Letters that are being put together at the cursor.
    preedit: String,
    proposing: Option<Proposing>,
    portraits: portraits::Portraits,
    turn: Option<Turn>,
    /// Where the colour stands that is picked.
    picked: Option<usize>,
    /// What it knows of the picture.
    picture: probed::Picture,
    /// Commands that wait to be sent.
    commands: Vec<Command>,
    answer: Option<(String, Instant)>,
    /// Lines and columns that show.
    rows: usize,
    columns: usize,
    /// Cursor and view that the next text begins with: of what it is a copy.
    carried: Option<(usize, (f32, f32))>,
    revision: u64,
}

impl std::fmt::Debug for Editor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Editor").field("source", &self.source).field("revision", &self.revision).finish()
    }
}

impl Editor {
    /// An editor without a text, for a user with these folders. `wake` is called on other threads when there is something new for it.
    ///
    /// # Errors
    /// The system has no thread left.
    pub fn start(
        drafts: Drafts,
        folders: &Folders,
        wake: impl Fn() + Send + Clone + 'static,
    ) -> io::Result<Self> {
        Ok(Self {
            drafts,
            clerk: Clerk::start(folders, wake.clone())?,
            clipboard: Clipboard::new(wake.clone()),
            documents: Vec::new(),
            shown: 0,
            source: None,
            findings: None,
            others: Vec::new(),
            focused: false,
            ignores_repeats: false,
            find: None,
            preedit: String::new(),
            proposing: None,
            portraits: portraits::Portraits::new(wake.clone()),
            turn: None,
            picked: None,
            picture: probed::Picture::default(),
            commands: Vec::new(),
            answer: None,
            rows: 20,
            columns: 60,
            carried: None,
            revision: 0,
        })
    }

    /// Shows the text of a scene, if it is another than before.
    pub fn show_scene(&mut self, source: &SceneSource) {
        let source = match source {
            SceneSource::Blend(blend) => &blend.to.source,
            other => other,
        };
        if self.source.as_ref() == Some(source) {
            return;
        }
        self.let_go();
        self.close_small();
        self.forget_picture();
        self.source = Some(source.clone());
        self.others.extend(self.findings.take());
        let known = self.others.iter().position(|found| found.source == *source);
        let found = known.map(|at| self.others.swap_remove(at));
        self.shown = match self.documents.iter().position(|document| document.is_of(source)) {
            Some(known) => known,
            None => match source {
                SceneSource::File(file) => self.open(&file.clone()),
                other => {
                    self.documents.push(Document::shipped(other));
                    self.documents.len() - 1
                }
            },
        };
        if let Some(found) = found {
            self.take_findings(found);
        }
        self.revision += 1;
    }

    /// The place of a file's text among the documents, which is read if it is not there.
    fn open(&mut self, file: &Path) -> usize {
        if let Some(known) = self.documents.iter().position(|document| document.file() == Some(file)) {
            return known;
        }
        self.clerk.open(file);
        self.documents.push(Document::of_file(file));
        self.documents.len() - 1
    }

    /// Takes in what other threads have for the editor.
    pub fn update(&mut self) {
        while let Some(news) = self.clerk.news() {
            self.take_news(news);
        }
        while let Some(text) = self.clipboard.pasted() {
            self.put_in(text.as_bytes());
        }
        for findings in self.drafts.take_findings() {
            self.take_findings(findings);
        }
        self.want_portrait();
        if self.answer.as_ref().is_some_and(|(_, since)| clock::since(*since) > ANSWER_STAYS) {
            self.answer = None;
            self.revision += 1;
        }
    }

    fn take_findings(&mut self, findings: Findings) {
        if Some(&findings.source) != self.source.as_ref() {
            self.others.retain(|other| other.source != findings.source);
            return self.others.push(findings);
        }
        let of_text = |text: usize| {
            findings.mistakes.iter().filter(move |one| one.text == text).cloned().collect::<Vec<_>>()
        };
        for (number, file) in findings.texts.iter().enumerate() {
            if let Some(document) = self.documents.iter_mut().find(|one| one.file() == Some(file)) {
                document.take_mistakes(findings.version, of_text(number));
                if findings.mistakes.is_empty() {
                    document.note_shown();
                }
            }
        }
        if findings.texts.is_empty()
            && let Some(document) = self.documents.get_mut(self.shown)
        {
            document.take_mistakes(findings.version, of_text(0));
        }
        self.check_turn(&findings);
        self.findings = Some(findings);
        self.revision += 1;
    }

    /// Whether keys are text.
    pub fn has_focus(&self) -> bool {
        self.focused
    }

    /// Gives keys to the text or to the show.
    pub fn set_focus(&mut self, focused: bool) {
        self.ignores_repeats |= focused && !self.focused;
        self.revision += u64::from(self.focused != focused);
        self.focused = focused;
        if !focused {
            self.preedit.clear();
            self.close_small();
        }
    }

    /// Returns the commands that the editor has sent since the last call.
    pub fn take_commands(&mut self) -> Vec<Command> {
        std::mem::take(&mut self.commands)
    }

    /// Keeps what is not saved: the program ends.
    pub fn finish(&mut self) {
        self.let_go();
        for document in self.documents.iter().filter(|document| document.is_dirty()) {
            if let Some(file) = document.file() {
                self.clerk.keep(file, Some(document.bytes()));
            }
        }
        self.clerk.finish(KEEP_LIMIT);
    }

    /// Whether it tells what is wrong with the scene.
    pub fn tells_mistakes(&self) -> bool {
        self.findings.as_ref().is_some_and(|found| !found.mistakes.is_empty())
    }

    /// Says something for a moment.
    fn say(&mut self, words: impl Into<String>) {
        self.answer = Some((words.into(), clock::now()));
        self.revision += 1;
    }

    fn document_mut(&mut self) -> Option<&mut Document> {
        self.documents.get_mut(self.shown)
    }
}

/// What the overlay shows.
impl Editor {
    /// Grows with everything that changes its look.
    pub(crate) fn revision(&self) -> u64 {
        self.revision
    }

    /// The text that shows.
    pub(crate) fn document(&self) -> Option<&Document> {
        self.documents.get(self.shown)
    }

    /// What is looked for.
    pub(crate) fn find_line(&self) -> Option<&Find> {
        self.find.as_ref()
    }

    /// The letters that are being put together at the cursor.
    pub(crate) fn preedit(&self) -> &str {
        &self.preedit
    }

    /// What may be written at the cursor.
    pub(crate) fn proposing(&self) -> Option<&Proposing> {
        self.proposing.as_ref()
    }

    /// Where the number stands that is being turned, or the three.
    pub(crate) fn turned(&self) -> Option<Range<usize>> {
        self.turn.as_ref().map(Turn::range)
    }

    /// Whether three numbers are turned together.
    pub(crate) fn turns_three(&self) -> bool {
        self.turn.as_ref().is_some_and(Turn::is_triple)
    }

    /// The answer to the last key.
    pub(crate) fn answer(&self) -> Option<&str> {
        self.answer.as_ref().map(|(words, _)| words.as_str())
    }

    /// When the answer goes.
    pub(crate) fn changes_at(&self) -> Option<Instant> {
        self.answer.as_ref().map(|(_, since)| *since + ANSWER_STAYS)
    }

    /// The names of the scene's texts, whether each has mistakes, and whether it shows and is saved. Without includes
    /// there is one.
    pub(crate) fn tabs(&self) -> Vec<Tab> {
        let of_document = |document: &Document, shows| Tab {
            name: document.name(),
            shows,
            wrong: document.mistakes().next().is_some(),
            dirty: document.is_dirty(),
        };
        let texts = self.findings.as_ref().map_or(&[][..], |found| &found.texts);
        let mut tabs: Vec<Tab> = Vec::new();
        for (number, file) in texts.iter().enumerate() {
            let wrong = self.findings.iter().flat_map(|found| &found.mistakes).any(|one| one.text == number);
            tabs.push(
                match self.documents.iter().position(|one| one.file() == Some(file)) {
                    Some(at) => self.documents.get(at).map(|one| of_document(one, at == self.shown)),
                    None => None,
                }
                .unwrap_or_else(|| Tab {
                    name: file.file_name().unwrap_or_default().to_string_lossy().into_owned(),
                    shows: false,
                    wrong,
                    dirty: false,
                }),
            );
        }
        if tabs.is_empty() {
            tabs.extend(self.document().map(|document| of_document(document, true)));
        }
        tabs
    }

    /// The mistake to tell: the one at the cursor, or else the first.
    pub(crate) fn mistake(&self) -> Option<Marked> {
        let document = self.document()?;
        let cursor = document.editing.cursor();
        let at_cursor = |one: &Marked| (one.range.start..=one.range.end).contains(&cursor);
        let all: Vec<Marked> = document.mistakes().collect();
        all.iter().find(|one| at_cursor(one)).or(all.first()).cloned()
    }

    /// What is known of the place at the cursor.
    pub(crate) fn about(&self) -> Option<About> {
        let document = self.document()?;
        document.about(document.editing.cursor()).map(|(_, about)| about)
    }
}

/// A text of the scene, as its tab shows it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Tab {
    /// The file's name.
    pub name: String,
    /// Whether it is the one that shows.
    pub shows: bool,
    /// Whether it has mistakes.
    pub wrong: bool,
    /// Whether it is not saved.
    pub dirty: bool,
}
