//! The scene editor in the window: the text of the shown scene, its keys, its files and its messages.
//!
//! The editor is a plain value. Keys and the pointer change it, and the overlay draws it. Every edit goes to the loader
//! as a draft ([`Drafts`]) that replaces the file's contents. If the draft is valid, the next frame shows it. Otherwise
//! the editor marks the mistakes. Separate threads access files and the clipboard.
//!
//! [`Editor`] owns the parts and passes results between them:
//!
//! | part | purpose |
//! |---|---|
//! | `Texts` | the texts of the scene and the loader's findings; owns `Documents` and `Outbox` |
//! | `Documents` | the open texts, the visible text, and its scroll position |
//! | `Outbox` | drafts, backups, values of turned numbers, commands |
//! | `HeldNumbers` | turned numbers, picked colours, dragged positions |
//! | `Finding` | the search line |
//! | `Proposals` | the completion list and its previews |
//! | `ProbedPicture` | information about the frame: the clicked point, highlights, costs |
//! | `Focus` | keyboard focus and input methods |
//! | `Notice` | the message line |

mod acting;
mod binding;
mod document;
mod documents;
mod finding;
mod focus;
pub mod keys;
mod notice;
mod outbox;
mod params;
mod probed;
mod proposing;
#[cfg(test)]
mod tests;
mod texts;
mod turning;
mod wrapping;

use std::io;
use std::ops::Range;

use binding::ToWrite;
pub(crate) use document::{Document, Question};
use finding::Finding;
use focus::Focus;
pub use keys::EditAction;
use mariana_control::SoundBinding;
use mariana_editing::{Number, Refused, TurnSpeed};
use notice::Notice;
use probed::ProbedPicture;
pub(crate) use probed::{Light, parts_of};
use proposing::Proposals;
pub(crate) use proposing::{ObjectPreview, Proposing};
use texts::Texts;
use turning::HeldNumbers;
pub(crate) use wrapping::{RowPosition, Wrapping, row_of};

use crate::clipboard::{self, Clipboard};
use mariana_commands::Command;
use mariana_files::Folders;
use mariana_render::frame::camera::Camera;
use mariana_render::placement::Map;
use mariana_scenes::probing::Answer;
use mariana_scenes::{Drafts, SceneSource};

/// The state of the editor.
pub struct Editor {
    pub(crate) texts: Texts,
    clipboard: Clipboard,
    focus: Focus,
    pub(crate) finding: Finding,
    pub(crate) proposals: Proposals,
    pub(crate) held_numbers: HeldNumbers,
    pub(crate) picture: ProbedPicture,
    pub(crate) notice: Notice,
    to_write: Option<ToWrite>,
    /// Changes with the shown state. Changes by keys and by acts of the overlay are counted before they are made.
    pub(crate) revision: u64,
}

impl Editor {
    /// Starts an editor without a text. Its threads call `wake` when one of their results arrives.
    ///
    /// # Errors
    /// Fails if the system cannot start another thread.
    pub fn start(
        drafts: Drafts,
        folders: &Folders,
        wake: impl Fn() + Send + Clone + 'static,
    ) -> io::Result<Self> {
        Ok(Self {
            texts: Texts::start(drafts, folders, wake.clone())?,
            clipboard: clipboard::start(wake.clone()),
            focus: Focus::default(),
            finding: Finding::default(),
            proposals: Proposals::new(wake),
            held_numbers: HeldNumbers::default(),
            picture: ProbedPicture::default(),
            notice: Notice::default(),
            to_write: None,
            revision: 0,
        })
    }

    /// Shows the text of a scene, unless the text is visible already.
    pub fn show_scene(&mut self, source: &SceneSource) {
        let source = match source {
            SceneSource::Blend(blend) => &blend.to.source,
            other => other,
        };
        if self.texts.source.as_ref() == Some(source) {
            return;
        }
        self.let_go();
        self.close_small();
        (self.picture.probed, self.picture.ray_statistics) = (None, None);
        self.texts.show_scene(source);
        self.revision += 1;
    }

    /// Handles results of the editor's threads.
    pub fn update(&mut self) {
        while let Some(file_events) = self.texts.outbox.files.file_events() {
            self.revision += 1;
            if let Some(words) = self.texts.receive_event(file_events) {
                self.show_notice(words);
            }
        }
        while let Some(text) = self.clipboard.poll() {
            self.put_in(text.as_bytes());
        }
        binding::write_waiting(self);
        acting::replay_early_keys(self);
        if self.texts.update_findings() {
            self.held_numbers.check(&mut self.texts);
            self.revision += 1;
        }
        self.revision += u64::from(self.proposals.update());
    }

    /// True if keys are typed into the editor.
    pub fn has_focus(&self) -> bool {
        self.focus.is_on
    }

    /// Gives the keyboard focus to the editor or back to the show.
    pub fn set_focus(&mut self, focused: bool) {
        self.focus.set(focused);
        self.revision += 1;
        if !focused {
            self.close_small();
        }
    }

    /// Keeps keys until the scene to edit exists, or no longer.
    pub fn await_scene(&mut self, awaits: bool) {
        self.focus.awaits_scene = awaits;
    }

    /// Returns the commands that the editor has sent since the last call.
    pub fn drain_commands(&mut self) -> Vec<Command> {
        std::mem::take(&mut self.texts.outbox.commands)
    }

    /// Backs up unsaved text before the program exits.
    pub fn finish(&mut self) {
        self.let_go();
        self.texts.finish();
    }

    /// True if the editor shows mistakes of the scene.
    pub fn tells_mistakes(&self) -> bool {
        self.texts.findings.as_ref().is_some_and(|found| !found.mistakes.is_empty())
    }

    /// Shows a message for a moment.
    pub fn show_notice(&mut self, words: impl Into<String>) {
        self.notice.show(words.into());
        self.revision += 1;
    }

    fn show_refusal<E: ToString>(&mut self, done: Result<(), E>) {
        if let Err(words) = done {
            self.show_notice(words.to_string());
        }
    }

    fn close_small(&mut self) {
        self.finding.line = None;
        self.proposals.shown = None;
        self.held_numbers.close_picker(&mut self.texts);
    }

    /// Replaces the declaration of the parameter `name` by its binding. One undo brings it back. Copies a shipped scene
    /// first.
    pub fn write_binding(&mut self, name: &str, binding: &SoundBinding) {
        let (name, binding) = (name.to_owned(), binding.clone());
        self.to_write = Some(ToWrite { name, binding, is_copied: false });
        binding::write_waiting(self);
    }

    /// Sets the frame's position in the window and its camera.
    pub fn set_view(&mut self, map: Map, camera: Option<Camera>) {
        let picture = &mut self.picture;
        let (is_new, moves) = (picture.map != Some(map), picture.camera != camera);
        (picture.map, picture.camera) = (Some(map), camera);
        // Only the cross that marks a position depends on the camera.
        let is_crossed =
            || self.document().is_some_and(|document| self.held_numbers.place(document).is_some());
        if is_new || moves && is_crossed() {
            self.revision += 1;
        }
    }

    /// Handles the result of a probe of the frame.
    pub fn show_probe_answer(&mut self, answer: Answer) {
        match answer {
            // The session takes it.
            Answer::Diagram(_) => {}
            Answer::TooLong => self.show_notice("this scene is too large to be inspected while it plays"),
            Answer::RayStatistics(source, ray_statistics) if Some(&source) == self.texts.source.as_ref() => {
                self.picture.ray_statistics = Some(ray_statistics);
            }
            Answer::Point(probed) if Some(&probed.source) == self.texts.source.as_ref() => {
                tracing::debug!("probed: {probed:?}");
                self.picture.probed = Some(probed);
                // Scroll to the line that drew the point, but leave the cursor where the user is typing.
                if let Some(line) = self.probed_line() {
                    self.texts.documents.reveal_row((line as f32, 0.0));
                }
            }
            // Ignore a late answer about a previous scene.
            Answer::Point(_) | Answer::RayStatistics(..) => return,
        }
        self.revision += 1;
    }

    fn select(&mut self, number: usize, range: Range<usize>) {
        let own = self.document().and_then(Document::file);
        if self.texts.file(number).is_some_and(|file| own != Some(file)) {
            self.close_small();
        }
        self.texts.select(number, range);
    }

    /// Goes to the line that drew the clicked point.
    pub(crate) fn jump_to_probed(&mut self) {
        if let Some((number, range)) = self.picture.written() {
            self.select(number, range);
        }
        self.set_focus(true);
    }

    /// Goes to a byte of one of the scene's loaded texts.
    pub(crate) fn jump_to(&mut self, text: usize, byte: usize) {
        self.set_focus(true);
        self.select(text, byte..byte);
    }

    /// Closes the card of the clicked point. Returns true if the card was open.
    pub fn close_probed(&mut self) -> bool {
        let was = self.picture.probed.take().is_some();
        self.revision += u64::from(was);
        was
    }

    /// True if the editor needs ray statistics of the frame.
    pub fn wants_ray_statistics(&self) -> bool {
        self.picture.lights || self.picture.profiles
    }

    pub(crate) fn grab(&mut self, at: usize) {
        self.close_small();
        match self.document().and_then(|document| document.number(at)) {
            Some((number, line_start)) => self.hold_numbers(vec![number], line_start),
            None => self.let_go(),
        }
    }

    fn hold_numbers(&mut self, numbers: Vec<Number>, line_start: usize) {
        self.set_focus(true);
        let taken = self.held_numbers.grab(numbers, line_start, &mut self.texts);
        self.show_refusal(taken);
    }

    /// Grabs the triple at an offset, unless a triple is grabbed already. Returns true if a triple is grabbed now.
    fn hold_triple(&mut self, at: usize) -> bool {
        let found = self.document().and_then(|document| document.triple_at(at));
        if let Some((triple, line_start)) = found.filter(|_| !self.held_numbers.turns_three()) {
            self.hold_numbers(triple.numbers.into(), line_start);
        }
        self.held_numbers.turns_three()
    }

    fn turn(&mut self, turn: impl FnOnce(&mut HeldNumbers, &mut Texts) -> Result<(), Refused>) {
        let done = turn(&mut self.held_numbers, &mut self.texts);
        self.show_refusal(done);
    }

    /// Turns the grabbed number by a movement of the pointer to the right, in points.
    pub(crate) fn turn_number(&mut self, points: f32, speed: TurnSpeed) {
        self.turn(|held_numbers, texts| held_numbers.turn(f64::from(points), speed, texts));
    }

    pub(crate) fn let_go(&mut self) {
        self.held_numbers.let_go(&mut self.texts);
    }

    pub(crate) fn pick_color(&mut self, at: usize) {
        self.let_go();
        self.set_focus(true);
        self.close_small();
        let Some(document) = self.document() else { return };
        let Some((triple, start)) = document.color_at(at) else { return };
        if let Err(words) = document.check_open() {
            return self.show_notice(words);
        }
        let at = start + triple.range.start;
        self.with_text(|document| document.editing.move_to(at, false));
        self.held_numbers.picked = Some(at);
    }

    pub(crate) fn close_picker(&mut self) {
        self.held_numbers.close_picker(&mut self.texts);
    }

    pub(crate) fn set_color(&mut self, color: [f64; 3]) {
        if self.held_numbers.picked.is_some_and(|at| self.hold_triple(at)) {
            self.turn(|held_numbers, texts| held_numbers.turn_three(color.map(|part| part.max(0.0)), texts));
        }
    }

    pub(crate) fn move_place(&mut self, way: [f64; 3]) {
        let cursor = self.document().map(|document| document.editing.cursor());
        if cursor.is_some_and(|cursor| self.hold_triple(cursor)) {
            self.turn(|held_numbers, texts| held_numbers.move_three(way, texts));
        }
    }

    pub(crate) fn document(&self) -> Option<&Document> {
        self.texts.documents.shown()
    }

    pub(crate) fn preedit(&self) -> &str {
        &self.focus.preedit
    }

    /// Returns the index, from 0, of the line that drew the clicked point, if the line's text is visible.
    pub(crate) fn probed_line(&self) -> Option<usize> {
        let (number, range) = self.picture.written()?;
        self.texts.shown_line_at(number, range)
    }

    pub(crate) fn light(&self) -> Option<Light> {
        self.picture.light(self.document()?, self.texts.number())
    }
}
