//! Information about the rendered frame: the clicked point, the parts drawn by the lines at the cursor, and each
//! object's cost.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use super::document::Document;
use super::texts::Texts;
use mariana_field::ray_probe::{ObjectCost, PartCost, RayStatistics};
use mariana_render::frame::camera::Camera;
use mariana_render::placement::Map;
use mariana_scenes::probing::Probed;

#[derive(Default)]
pub(crate) struct ProbedPicture {
    /// Maps positions in the window to positions in the frame.
    pub(crate) map: Option<Map>,
    pub(super) camera: Option<Camera>,
    pub(crate) probed: Option<Probed>,
    /// True while parts drawn by the lines at the cursor are highlighted.
    pub(crate) lights: bool,
    /// True while the cost of each object is shown.
    pub(crate) profiles: bool,
    pub(crate) ray_statistics: Option<Arc<RayStatistics>>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Light {
    pub columns: usize,
    /// For each cell of a grid over the frame, row by row: true if the lines at the cursor draw the cell.
    pub cells: Vec<bool>,
}

impl ProbedPicture {
    pub(super) fn toggle_light(&mut self) -> &'static str {
        self.lights = !self.lights;
        match self.lights {
            true => "highlighting what the line at the cursor draws",
            false => "highlighting off",
        }
    }

    /// Returns the formula of the clicked point: the number of its text, and its byte range in the loaded text.
    pub(super) fn written(&self) -> Option<(usize, Range<usize>)> {
        self.probed.as_ref()?.surface.as_ref()?.written.clone()
    }

    /// Returns the highlighted cells for the visible text, whose number is `own`.
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

    pub(crate) fn view(&self) -> Option<(&Map, &Camera)> {
        self.map.as_ref().zip(self.camera.as_ref())
    }

    /// The objects by descending cost, and the ray statistics, which also contain the sky.
    pub(crate) fn profile(&self) -> Option<(Arc<RayStatistics>, Vec<ObjectCost>)> {
        let ray_statistics = self.ray_statistics.as_ref().filter(|_| self.profiles)?;
        let mut objects = ray_statistics.objects.clone();
        objects.sort_by_key(|object| std::cmp::Reverse(object.run));
        Some((ray_statistics.clone(), objects))
    }
}

/// Returns the lines that draw parts of `object`, costliest first: number, text, cost. Empty if there is only one.
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
