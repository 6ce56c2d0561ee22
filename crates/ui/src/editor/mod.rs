//! The editor in the window: the text of the scene on the stage, its keys, its files, and what is told of it.
//!
//! It is a plain value that keys and the pointer change, and the overlay draws it. Every change goes to the loader as a
//! draft ([`Drafts`]), which stands in the place of the file: what is right shows in the next frame, what is not is marked
//! here. Disks are the clerk's ([`mariana_files::documents::FileThread`]), the clipboard is its own thread's.
//!
//! [`Editor`] owns the parts and hands what one finds to another; each of them has a state of its own:
//!
//! | part | what it is for |
//! |---|---|
//! | `Texts` | the texts of the scene; it owns the four below |
//! | `Documents` | the open texts: which of them shows, and which part of it |
//! | `Files` | what is read, saved, copied and kept |
//! | `Found` | what the loader found in the scene and in others |
//! | `Outbox` | what the loader and the show get: drafts, numbers, commands |
//! | `HeldNumbers` | numbers that are turned, colours that are picked, positions that are dragged |
//! | `Finding` | what is looked for |
//! | `Proposals` | what may be written at the cursor, with small pictures |
//! | `Picture` | what is known of the picture: a point, what is lit up, what objects cost |
//! | `Focus` | whether keys are text, and letters that are being put together |
//! | `Notice` | the answer to the last key |

mod acting;
mod document;
mod documents;
mod files;
mod finding;
mod focus;
mod found;
pub mod keys;
mod notice;
mod object_previews;
mod outbox;
mod params;
mod probed;
mod proposing;
#[cfg(test)]
mod tests;
mod texts;
mod triples;
mod turning;

use std::io;
use std::ops::Range;

pub(crate) use document::{Document, Owner, Question};
use finding::{Find, Finding};
use focus::Focus;
pub use keys::EditAction;
use mariana_editing::{Number, Refused, TurnSpeed};
use notice::Notice;
pub(crate) use object_previews::{ObjectPreview, SIDE as PREVIEW_SIDE};
use probed::Picture;
pub(crate) use probed::{Light, parts_of};
use proposing::Proposals;
pub(crate) use proposing::Proposing;
use texts::Texts;
use turning::HeldNumbers;

use crate::clipboard::Clipboard;
use mariana_commands::Command;
use mariana_files::Folders;
use mariana_render::frame::camera::Camera;
use mariana_render::placement::Map;
use mariana_scenes::probing::Answer;
use mariana_scenes::{Drafts, SceneSource};

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

/// See the module.
pub struct Editor {
    texts: Texts,
    clipboard: Clipboard,
    focus: Focus,
    finding: Finding,
    proposals: Proposals,
    held_numbers: HeldNumbers,
    picture: Picture,
    notice: Notice,
    revision: u64,
}

impl std::fmt::Debug for Editor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Editor")
            .field("source", &self.texts.source())
            .field("revision", &self.revision)
            .finish_non_exhaustive()
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
            texts: Texts::start(drafts, folders, wake.clone())?,
            clipboard: Clipboard::new(wake.clone()),
            focus: Focus::default(),
            finding: Finding::default(),
            proposals: Proposals::new(wake),
            held_numbers: HeldNumbers::default(),
            picture: Picture::default(),
            notice: Notice::default(),
            revision: 0,
        })
    }

    /// Shows the text of a scene, if it is another than before.
    pub fn show_scene(&mut self, source: &SceneSource) {
        let source = match source {
            SceneSource::Blend(blend) => &blend.to.source,
            other => other,
        };
        if self.texts.source() == Some(source) {
            return;
        }
        self.let_go();
        self.close_small();
        self.picture.forget();
        self.texts.show_scene(source);
        self.revision += 1;
    }

    /// Takes in what other threads have for the editor.
    pub fn update(&mut self) {
        while let Some(file_events) = self.texts.file_events() {
            self.revision += 1;
            if let Some(words) = self.texts.take_news(file_events) {
                self.tell(words);
            }
        }
        while let Some(text) = self.clipboard.pasted() {
            self.put_in(text.as_bytes());
        }
        if self.texts.take_findings() {
            self.held_numbers.check(&mut self.texts);
            self.revision += 1;
        }
        let changes = [self.proposals.update(), self.notice.update()];
        self.revision += u64::from(changes.contains(&true));
    }

    /// Whether keys are text.
    pub fn has_focus(&self) -> bool {
        self.focus.is_on()
    }

    /// Gives keys to the text or to the show.
    pub fn set_focus(&mut self, focused: bool) {
        self.revision += u64::from(self.focus.set(focused));
        if !focused {
            self.close_small();
        }
    }

    /// Returns the commands that the editor has sent since the last call.
    pub fn take_commands(&mut self) -> Vec<Command> {
        self.texts.take_commands()
    }

    /// Keeps what is not saved: the program ends.
    pub fn finish(&mut self) {
        self.let_go();
        self.texts.finish();
    }

    /// Whether it tells what is wrong with the scene.
    pub fn tells_mistakes(&self) -> bool {
        self.texts.findings().is_some_and(|found| !found.mistakes.is_empty())
    }

    /// Tells something for a moment.
    pub fn tell(&mut self, words: impl Into<String>) {
        self.notice.say(words.into());
        self.revision += 1;
    }

    /// Tells why something was not done.
    fn tell_refusal<E: ToString>(&mut self, done: Result<(), E>) {
        if let Err(words) = done {
            self.tell(words.to_string());
        }
    }

    /// Closes what belongs to the moment: the line for finding, and proposals.
    fn close_small(&mut self) {
        self.finding.close();
        self.proposals.close();
        self.held_numbers.close_picker(&mut self.texts);
        self.revision += 1;
    }
}

/// The picture.
impl Editor {
    /// Notes how the picture lies in the window, and from where it is seen.
    pub fn set_view(&mut self, map: Map, camera: Option<Camera>) {
        let (is_new, moves) = self.picture.set_view(map, camera);
        // Only a cross in the picture goes with the camera.
        let is_crossed =
            || self.document().is_some_and(|document| self.held_numbers.place(document).is_some());
        if is_new || moves && is_crossed() {
            self.revision += 1;
        }
    }

    /// Takes in what was found in the picture.
    pub fn take_answer_about_the_picture(&mut self, answer: Answer) {
        match answer {
            Answer::TooLong => self.tell("this scene is too large to be looked into while it plays"),
            Answer::RayStatistics(source, ray_statistics) if Some(&source) == self.texts.source() => {
                self.picture.take_ray_statistics(ray_statistics);
            }
            Answer::Point(probed) if Some(&probed.source) == self.texts.source() => {
                self.picture.take_probed(probed);
                // The line that made it comes into sight. The cursor stays where one writes.
                if let Some(line) = self.probed_line() {
                    self.texts.reveal_line(line);
                }
            }
            // Of a scene that has gone.
            Answer::Point(_) | Answer::RayStatistics(..) => return,
        }
        self.revision += 1;
    }

    /// Brings the cursor to a place of one of the scene's texts as it was loaded.
    fn go_to(&mut self, number: usize, range: Range<usize>) {
        let own = self.document().and_then(Document::file);
        if self.texts.file(number).is_some_and(|file| own != Some(file)) {
            self.close_small();
        }
        self.texts.go_to(number, range);
        self.revision += 1;
    }

    /// Closes what is told of a point. Whether there was something.
    pub fn close_probed(&mut self) -> bool {
        let was = self.picture.close_probed();
        self.revision += u64::from(was);
        was
    }

    /// Whether it needs to know what the picture shows.
    pub fn wants_ray_statistics(&self) -> bool {
        self.picture.wants_ray_statistics()
    }
}

/// Numbers, colours and positions that are turned.
impl Editor {
    /// Takes the number at a place.
    fn grab(&mut self, at: usize) {
        self.close_small();
        match self.document().and_then(|document| document.number(at)) {
            Some((number, line_start)) => self.take_numbers(vec![number], line_start),
            None => self.let_go(),
        }
    }

    /// Takes numbers of a line that begins at a byte.
    fn take_numbers(&mut self, numbers: Vec<Number>, line_start: usize) {
        self.set_focus(true);
        let taken = self.held_numbers.take(numbers, line_start, &mut self.texts);
        self.tell_refusal(taken);
        self.revision += 1;
    }

    /// Takes the three numbers at a place, unless three are held. Returns whether three are held then.
    fn take_three(&mut self, at: usize) -> bool {
        let found = self.document().and_then(|document| document.triple_at(at));
        if let Some((triple, line_start)) = found.filter(|_| !self.held_numbers.turns_three()) {
            self.take_numbers(triple.numbers.into(), line_start);
        }
        self.held_numbers.turns_three()
    }

    /// Turns what the hand holds.
    fn turn(&mut self, turn: impl FnOnce(&mut HeldNumbers, &mut Texts) -> Result<(), Refused>) {
        let done = turn(&mut self.held_numbers, &mut self.texts);
        self.tell_refusal(done);
        self.revision += 1;
    }

    /// Lets go of it: the text holds from now on.
    fn let_go(&mut self) {
        self.revision += u64::from(self.held_numbers.let_go(&mut self.texts));
    }

    /// Opens what picks the colour at a place.
    fn pick_color(&mut self, at: usize) {
        self.let_go();
        self.set_focus(true);
        self.close_small();
        let Some(document) = self.document() else { return };
        let Some((triple, start)) = document.color_at(at) else { return };
        if let Err(words) = document.check_open() {
            return self.tell(words);
        }
        let at = start + triple.range.start;
        self.with_text(|document| document.editing.go_to(at, false));
        self.held_numbers.pick(at);
    }

    /// Gives the colour that is picked other numbers.
    fn set_color(&mut self, color: [f64; 3]) {
        if self.held_numbers.picked().is_some_and(|at| self.take_three(at)) {
            self.turn(|held_numbers, texts| held_numbers.turn_three(color.map(|part| part.max(0.0)), texts));
        }
    }

    /// Moves the position at the cursor.
    fn move_place(&mut self, way: [f64; 3]) {
        let cursor = self.document().map(|document| document.editing.cursor());
        if cursor.is_some_and(|cursor| self.take_three(cursor)) {
            self.turn(|held_numbers, texts| held_numbers.move_three(way, texts));
        }
    }
}

/// What the overlay shows.
impl Editor {
    /// Grows with everything that changes its look.
    pub(crate) fn revision(&self) -> u64 {
        self.revision
    }

    /// The texts of the scene.
    pub(crate) fn texts(&self) -> &Texts {
        &self.texts
    }

    /// The one that shows.
    pub(crate) fn document(&self) -> Option<&Document> {
        self.texts.document()
    }

    /// What is looked for.
    pub(crate) fn find_line(&self) -> Option<&Find> {
        self.finding.line()
    }

    /// The letters that are being put together at the cursor.
    pub(crate) fn preedit(&self) -> &str {
        self.focus.preedit()
    }

    /// What may be written at the cursor.
    pub(crate) fn proposals(&self) -> &Proposals {
        &self.proposals
    }

    /// What the hand holds.
    pub(crate) fn held_numbers(&self) -> &HeldNumbers {
        &self.held_numbers
    }

    /// The answer to the last key.
    pub(crate) fn notice(&self) -> &Notice {
        &self.notice
    }

    /// What is known of the picture.
    pub(crate) fn picture(&self) -> &Picture {
        &self.picture
    }

    /// The line, from 0, of the text that shows which made the point that was clicked.
    pub(crate) fn probed_line(&self) -> Option<usize> {
        let (number, range) = self.picture.written()?;
        self.texts.shown_line_at(number, range)
    }

    /// What is lit up.
    pub(crate) fn light(&self) -> Option<Light> {
        self.picture.light(self.document()?, self.texts.number())
    }
}
