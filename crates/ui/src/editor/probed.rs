//! What the editor knows of the picture: the point that was clicked, which parts the lines at the cursor make, and what
//! each object costs.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use super::document::Document;
use super::texts::Texts;
use mariana_field::ray_probe::{ObjectCost, PartCost, RayStatistics};
use mariana_render::frame::camera::Camera;
use mariana_render::placement::Map;
use mariana_scenes::probing::Probed;

/// See the module.
#[derive(Default)]
pub(crate) struct Picture {
    /// Leads from places in the window to places in the picture.
    map: Option<Map>,
    /// From where it is seen.
    camera: Option<Camera>,
    probed: Option<Probed>,
    /// Whether what the lines at the cursor make is lit up.
    lights: bool,
    /// Whether the table of what objects cost shows.
    profiles: bool,
    ray_statistics: Option<Arc<RayStatistics>>,
}

/// What of the picture is lit up.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Light {
    /// Cells side by side.
    pub columns: usize,
    /// Whether each cell is made by the lines at the cursor.
    pub cells: Vec<bool>,
}

impl Picture {
    /// Notes how it lies in the window, and from where it is seen. Returns whether each is new.
    pub(super) fn set_view(&mut self, map: Map, camera: Option<Camera>) -> (bool, bool) {
        let is_new = (self.map != Some(map), self.camera != camera);
        (self.map, self.camera) = (Some(map), camera);
        is_new
    }

    /// Takes in what was found at the point that was clicked.
    pub(super) fn take_probed(&mut self, probed: Probed) {
        tracing::debug!("probed: {probed:?}");
        self.probed = Some(probed);
    }

    /// Takes in what was found in the whole.
    pub(super) fn take_ray_statistics(&mut self, ray_statistics: Arc<RayStatistics>) {
        self.ray_statistics = Some(ray_statistics);
    }

    /// Closes what is told of a point. Returns whether there was something.
    pub(super) fn close_probed(&mut self) -> bool {
        self.probed.take().is_some()
    }

    /// Lights up what the lines at the cursor make, or does not any more. Returns which, in words.
    pub(super) fn toggle_light(&mut self) -> &'static str {
        self.lights = !self.lights;
        self.forget_ray_statistics_if_unused();
        match self.lights {
            true => "what the line at the cursor makes is lit up",
            false => "nothing is lit up",
        }
    }

    /// Shows what objects cost, or does not any more.
    pub(super) fn toggle_profile(&mut self) {
        self.profiles = !self.profiles;
        self.forget_ray_statistics_if_unused();
    }

    fn forget_ray_statistics_if_unused(&mut self) {
        if !self.wants_ray_statistics() {
            self.ray_statistics = None;
        }
    }

    /// Another scene shows.
    pub(super) fn forget(&mut self) {
        (self.probed, self.ray_statistics) = (None, None);
    }

    /// Whether it needs to know what the whole shows.
    pub(super) fn wants_ray_statistics(&self) -> bool {
        self.lights || self.profiles
    }

    /// The text and the bytes that made the point that was clicked, as they were loaded.
    pub(super) fn written(&self) -> Option<(usize, Range<usize>)> {
        self.probed.as_ref()?.surface.as_ref()?.written.clone()
    }

    /// What is lit up of a text with this number.
    pub(super) fn light(&self, document: &Document, own: usize) -> Option<Light> {
        let ray_statistics = self.ray_statistics.as_ref().filter(|_| self.lights)?;
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
        let parts: Vec<bool> = ray_statistics
            .parts
            .iter()
            .map(|part| part.places.iter().any(|(file, byte)| *file == own && is_lit(*byte)))
            .collect();
        let of_cell = |cell: &u16| {
            usize::from(*cell).checked_sub(1).and_then(|part| parts.get(part)).is_some_and(|lit| *lit)
        };
        Some(Light {
            columns: ray_statistics.columns,
            cells: ray_statistics.cells.iter().map(of_cell).collect(),
        })
    }
}

/// What the overlay shows.
impl Picture {
    /// Leads from places in the window to places in the picture, both as shares.
    pub(crate) fn map(&self) -> Option<&Map> {
        self.map.as_ref()
    }

    /// The same, and from where the picture is seen.
    pub(crate) fn view(&self) -> Option<(&Map, &Camera)> {
        self.map.as_ref().zip(self.camera.as_ref())
    }

    /// The point that was clicked.
    pub(crate) fn probed(&self) -> Option<&Probed> {
        self.probed.as_ref()
    }

    /// Whether each switch is on: for lighting up, and for the table of costs.
    pub(crate) fn switches(&self) -> (bool, bool) {
        (self.lights, self.profiles)
    }

    /// What objects cost, the dearest first, then the sky, of a survey.
    pub(crate) fn profile(&self) -> Option<(Arc<RayStatistics>, Vec<ObjectCost>)> {
        let ray_statistics = self.ray_statistics.as_ref().filter(|_| self.profiles)?;
        let mut objects = ray_statistics.objects.clone();
        objects.sort_by_key(|object| std::cmp::Reverse(object.run));
        Some((ray_statistics.clone(), objects))
    }
}

/// What the lines cost that make parts of an object, the dearest first, with their numbers and words. Nothing of an
/// object that one line makes.
pub(crate) fn parts_of(object: &ObjectCost, texts: &Texts) -> Vec<(usize, String, PartCost)> {
    let mut lines: Vec<(usize, String, PartCost)> = Vec::new();
    for part in &object.parts {
        let (file, bytes) = part.written.clone();
        let Some((_, number, words)) = texts.line_at(file, bytes) else { continue };
        let is_it = |known: &&mut (usize, String, PartCost)| known.0 == number && known.2.written.0 == file;
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
