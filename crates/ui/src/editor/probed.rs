//! What the editor knows of the picture: the point that was clicked, which parts the lines at the cursor make, and what
//! each object costs.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use super::{Document, Editor};
use mariana_field::sight::{ObjectShare, PartShare, Survey};
use mariana_render::frame::camera::Camera;
use mariana_render::placement::Map;
use mariana_scenes::probing::{Answer, Probed};

/// See the module.
#[derive(Default)]
pub(super) struct Picture {
    /// Leads from places in the window to places in the picture.
    map: Option<Map>,
    /// From where it is seen.
    camera: Option<Camera>,
    probed: Option<Probed>,
    /// Whether what the lines at the cursor make is lit up.
    lights: bool,
    /// Whether the table of what objects cost shows.
    profiles: bool,
    survey: Option<Arc<Survey>>,
}

/// What of the picture is lit up.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Light {
    /// Cells side by side.
    pub columns: usize,
    /// Whether each cell is made by the lines at the cursor.
    pub cells: Vec<bool>,
}

impl Editor {
    /// Notes how the picture lies in the window, and from where it is seen.
    pub fn set_view(&mut self, map: Map, camera: Option<Camera>) {
        let is_new = self.picture.map != Some(map);
        let moves = self.picture.camera != camera;
        (self.picture.map, self.picture.camera) = (Some(map), camera);
        // Only a cross in the picture goes with the camera.
        if is_new || moves && self.place().is_some() {
            self.revision += 1;
        }
    }

    /// Tells something for a moment.
    pub fn tell(&mut self, words: &str) {
        self.say(words);
    }

    /// Takes in what was found in the picture.
    pub fn take_answer_about_the_picture(&mut self, answer: Answer) {
        match answer {
            Answer::TooLong => self.say("this scene is too large to be looked into while it plays"),
            Answer::Survey(source, survey) if Some(&source) == self.source.as_ref() => {
                self.picture.survey = Some(survey);
            }
            Answer::Point(probed) if Some(&probed.source) == self.source.as_ref() => {
                tracing::debug!("probed: {probed:?}");
                self.picture.probed = Some(probed);
                self.show_probed();
            }
            // Of a scene that has gone.
            Answer::Point(_) | Answer::Survey(..) => return,
        }
        self.revision += 1;
    }

    /// Brings the line that made the point that was clicked into sight, if its text shows. The cursor stays where one
    /// writes.
    fn show_probed(&mut self) {
        let Some(line) = self.probed_line() else { return };
        let rows = self.rows.max(3) as f32;
        let Some(document) = self.document_mut() else { return };
        let (top, left) = document.view;
        document.view = (top.min(line as f32 - 1.0).max(line as f32 + 3.0 - rows).max(0.0), left);
    }

    /// Brings cursor and keys to what made the point that was clicked.
    pub(super) fn go_to_probed(&mut self) {
        let surface = self.picture.probed.as_ref().and_then(|probed| probed.surface.as_ref());
        if let Some((file, range)) = surface.and_then(|surface| surface.written.clone()) {
            self.go_to_place(file, range);
        }
        self.set_focus(true);
    }

    /// Brings the cursor to a place of the text as it was loaded.
    pub(super) fn go_to_place(&mut self, file: usize, range: Range<usize>) {
        let known = self.findings.as_ref().and_then(|found| found.texts.get(file)).cloned();
        if let Some(file) = known {
            let is_new = !self.documents.iter().any(|document| document.file() == Some(&*file));
            if is_new {
                // It is read first.
                self.carried = Some((range.start, (0.0, 0.0)));
            }
            let shown = self.open(&file);
            if shown != self.shown {
                self.close_small();
                self.shown = shown;
            }
            if is_new {
                return;
            }
        } else if file > 0 {
            return;
        }
        self.with_text(|document| {
            if let Some(now) = document.place_as_shown(range) {
                document.editing.go_to(now.start, false);
            }
        });
    }

    /// Closes what is told of a point. Whether there was something.
    pub fn close_probed(&mut self) -> bool {
        let was = self.picture.probed.take().is_some();
        self.revision += u64::from(was);
        was
    }

    /// Lights up what the lines at the cursor make, or does not any more.
    pub(super) fn toggle_light(&mut self) {
        self.picture.lights = !self.picture.lights;
        self.forget_survey_if_unused();
        self.say(match self.picture.lights {
            true => "what the line at the cursor makes is lit up",
            false => "nothing is lit up",
        });
    }

    /// Shows what objects cost, or does not any more.
    pub(super) fn toggle_profile(&mut self) {
        self.picture.profiles = !self.picture.profiles;
        self.forget_survey_if_unused();
        self.revision += 1;
    }

    fn forget_survey_if_unused(&mut self) {
        if !self.wants_survey() {
            self.picture.survey = None;
        }
    }

    /// Another scene shows.
    pub(super) fn forget_picture(&mut self) {
        (self.picture.probed, self.picture.survey) = (None, None);
    }
}

/// What the overlay and the show ask.
impl Editor {
    /// Whether it needs to know what the picture shows.
    pub fn wants_survey(&self) -> bool {
        self.picture.lights || self.picture.profiles
    }

    /// Leads from places in the window to places in the picture, both as shares.
    pub(crate) fn map(&self) -> Option<&Map> {
        self.picture.map.as_ref()
    }

    /// The same, and from where the picture is seen.
    pub(crate) fn view(&self) -> Option<(&Map, &Camera)> {
        self.picture.map.as_ref().zip(self.picture.camera.as_ref())
    }

    /// The point that was clicked.
    pub(crate) fn probed(&self) -> Option<&Probed> {
        self.picture.probed.as_ref()
    }

    /// The line of a place of the text as it was loaded: its file's name, its number from 1, and its words.
    pub(crate) fn line_at(&self, file: usize, range: Range<usize>) -> Option<(String, usize, String)> {
        let document = self.document_of(file)?;
        let now = document.place_as_shown(range)?;
        let buffer = document.editing.buffer();
        let line = buffer.line_of(now.start);
        let words = String::from_utf8_lossy(buffer.line(line)).trim().to_owned();
        Some((document.name(), line + 1, words))
    }

    /// The line, from 0, of the text that shows which made the point that was clicked.
    pub(crate) fn probed_line(&self) -> Option<usize> {
        let (file, range) = self.picture.probed.as_ref()?.surface.as_ref()?.written.clone()?;
        let document = self.document_of(file)?;
        let shows = self.document().is_some_and(|shown| std::ptr::eq(shown, document));
        let now = document.place_as_shown(range).filter(|_| shows)?;
        Some(document.editing.buffer().line_of(now.start))
    }

    fn document_of(&self, file: usize) -> Option<&Document> {
        match self.findings.as_ref().and_then(|found| found.texts.get(file)) {
            Some(path) => self.documents.iter().find(|document| document.file() == Some(path)),
            None => self.document().filter(|_| file == 0),
        }
    }

    /// Whether each switch is on: for lighting up, and for the table of costs.
    pub(crate) fn switches(&self) -> (bool, bool) {
        (self.picture.lights, self.picture.profiles)
    }

    /// What is lit up.
    pub(crate) fn light(&self) -> Option<Light> {
        let survey = self.picture.survey.as_ref().filter(|_| self.picture.lights)?;
        let document = self.document()?;
        let texts = self.findings.as_ref().map_or(&[][..], |found| &found.texts);
        let own = document.file().and_then(|own| texts.iter().position(|file| file == own)).unwrap_or(0);
        let (buffer, selection) = (document.editing.buffer(), document.editing.selection());
        let lines = buffer.line_of(selection.start)..=buffer.line_of(selection.end);
        let mut known = BTreeMap::new();
        let mut is_lit = |byte: usize| {
            *known.entry(byte).or_insert_with(|| {
                document
                    .place_as_shown(byte..byte)
                    .is_some_and(|now| lines.contains(&buffer.line_of(now.start)))
            })
        };
        let parts: Vec<bool> = survey
            .parts
            .iter()
            .map(|part| part.places.iter().any(|(file, byte)| *file == own && is_lit(*byte)))
            .collect();
        let of_cell = |cell: &u16| {
            usize::from(*cell).checked_sub(1).and_then(|part| parts.get(part)).is_some_and(|lit| *lit)
        };
        Some(Light { columns: survey.columns, cells: survey.cells.iter().map(of_cell).collect() })
    }

    /// What objects cost, the dearest first, then the sky, of a survey.
    pub(crate) fn profile(&self) -> Option<(Arc<Survey>, Vec<ObjectShare>)> {
        let survey = self.picture.survey.as_ref().filter(|_| self.picture.profiles)?;
        let mut objects = survey.objects.clone();
        objects.sort_by_key(|object| std::cmp::Reverse(object.run));
        Some((survey.clone(), objects))
    }

    /// What the lines cost that make parts of an object, the dearest first, with their numbers and words. Nothing of an
    /// object that one line makes.
    pub(crate) fn parts_of(&self, object: &ObjectShare) -> Vec<(usize, String, PartShare)> {
        let mut lines: Vec<(usize, String, PartShare)> = Vec::new();
        for part in &object.parts {
            let (file, bytes) = part.written.clone();
            let Some((_, number, words)) = self.line_at(file, bytes) else { continue };
            let is_it =
                |known: &&mut (usize, String, PartShare)| known.0 == number && known.2.written.0 == file;
            match lines.iter_mut().find(is_it) {
                Some((_, _, known)) => {
                    known.rays += part.rays;
                    known.evaluations += part.evaluations;
                    known.run += part.run;
                }
                None => lines.push((number, words, part.clone())),
            }
        }
        if lines.len() < 2 {
            lines.clear();
        }
        lines.sort_by_key(|(_, _, part)| std::cmp::Reverse(part.run));
        lines
    }
}
