//! The editor's queries about the frame: what a clicked point shows, and what the lines of the text do.

use std::sync::Arc;

use super::{Interface, Playback};
use crate::placement::{Map, led};
use crate::probing::{Answer, Prober};
use crate::ray_diagram::RayDiagram;
use crate::session::screen::Screen;
use crate::ui::editor::Editor;
use crate::ui::overlay::RayView;

/// Inspects frames on a thread, which starts with the first query.
#[derive(Default)]
pub(crate) struct Probing {
    prober: Option<Prober>,
    /// Maps positions in the window to positions in the frame, both as fractions.
    map: Option<Map>,
    /// Width and height of the window in pixels.
    size: Option<(u32, u32)>,
    /// Number of the frame for which ray statistics were last requested.
    surveyed: Option<u64>,
    /// The ray under the pointer, while it is shown.
    ray: Option<ShownRay>,
}

#[derive(Default)]
struct ShownRay {
    /// The number of the frame, the position and the size of the last question.
    asked: Option<(u64, [f64; 2], (u32, u32))>,
    view: Option<RayView>,
}

impl Probing {
    /// Returns the ray to draw over the frame.
    pub(super) fn ray_view(&self) -> Option<&RayView> {
        self.ray.as_ref()?.view.as_ref()
    }
}

impl Interface {
    pub(super) fn update_map(&mut self, playback: &mut Playback, map: Map, size: (u32, u32)) {
        (self.probing.map, self.probing.size) = (Some(map), Some(size));
        if let Some(editor) = &mut self.ui_state.editor {
            editor.set_view(map, playback.scene.composer.pictures.camera());
        }
    }

    /// The pointer over the picture in a window of this size, as fractions of the picture from the lower left corner, and
    /// true while its button is held; `None` without a picture, or if the pointer is beside it.
    pub(super) fn pointer_over_picture(&self, size: (u32, u32)) -> Option<([f32; 2], bool)> {
        let (place, pressed) = self.input.pointer.place();
        let [x, y] = self.in_picture(place, size)?.map(|fraction| fraction as f32);
        Some(([x, 1.0 - y], pressed))
    }

    /// Returns a position in the window, in pixels, as fractions of the picture from the upper left corner; `None`
    /// outside the picture.
    fn in_picture(&self, place: [f64; 2], size: (u32, u32)) -> Option<[f64; 2]> {
        let (width, height) = size;
        let fraction = [place[0] / f64::from(width), place[1] / f64::from(height)];
        let at = self.probing.map.and_then(|map| led(&map, fraction));
        at.filter(|at| at.iter().all(|fraction| (0.0..=1.0).contains(fraction)))
    }

    pub(super) fn inspect(&mut self, playback: &mut Playback, screen: &mut dyn Screen, place: [f64; 2]) {
        if !self.is_edited() {
            return;
        }
        let at = screen.size().and_then(|size| self.in_picture(place, size));
        let Some(at) = at else { return };
        match playback.scene.composer.pictures.scenery() {
            Ok(scenery) => self.with_prober(|prober| prober.request_point(scenery, at)),
            Err(reason) => self.show_in_editor(reason),
        }
    }

    pub(super) fn update_probing(&mut self, playback: &mut Playback) {
        self.request_ray(playback);
        for answer in self.probing.prober.iter().flat_map(Prober::answers).collect::<Vec<_>>() {
            if let Answer::Diagram(diagram) = answer {
                self.show_diagram(diagram);
            } else if let Some(editor) = &mut self.ui_state.editor {
                editor.show_probe_answer(answer);
            }
        }
        if !self.is_edited() {
            return;
        }
        let wants = self.ui_state.editor.as_ref().is_some_and(Editor::wants_ray_statistics);
        if !wants {
            self.probing.surveyed = None;
            return;
        }
        let picture = playback.scene.composer.pictures.count;
        let busy = self.probing.prober.as_ref().is_some_and(Prober::surveys);
        if busy || self.probing.surveyed == Some(picture) {
            return;
        }
        self.probing.surveyed = Some(picture);
        if let Ok(scenery) = playback.scene.composer.pictures.scenery() {
            self.with_prober(|prober| prober.request_ray_statistics(scenery));
        }
    }

    /// Shows or hides the ray under the pointer.
    pub(super) fn toggle_ray(&mut self, playback: &mut Playback) {
        let is_on = self.probing.ray.is_none();
        self.probing.ray = is_on.then(ShownRay::default);
        let words = if is_on { "the ray under the pointer is shown" } else { "the ray is hidden" };
        playback.reports.answer(words);
    }

    fn request_ray(&mut self, playback: &Playback) {
        let busy = self.probing.prober.as_ref().is_some_and(Prober::draws);
        let Some(size) = self.probing.size.filter(|_| self.probing.ray.is_some() && !busy) else { return };
        let pictures = &playback.scene.composer.pictures;
        let at = self.in_picture(self.input.pointer.place().0, size).unwrap_or([0.5; 2]);
        let question = Some((pictures.count, at, size));
        let scenery = pictures.scenery();
        let Some(ray) = self.probing.ray.as_mut().filter(|ray| ray.asked != question) else { return };
        ray.asked = question;
        match scenery {
            Ok(scenery) => self.with_prober(|prober| prober.request_diagram(scenery, at, size)),
            // Two scenes are fading.
            Err(_) => ray.view = None,
        }
    }

    fn show_diagram(&mut self, diagram: Arc<RayDiagram>) {
        let Some((ray, map)) = self.probing.ray.as_mut().zip(self.probing.map) else { return };
        ray.view = Some(RayView { diagram, map });
    }

    fn with_prober(&mut self, ask: impl FnOnce(&Prober)) {
        if self.probing.prober.is_none() {
            match Prober::start(self.waker.waking()) {
                Ok(prober) => self.probing.prober = Some(prober),
                Err(error) => {
                    return self.show_in_editor(&format!("cannot inspect the frame: {error}"));
                }
            }
        }
        if let Some(prober) = &self.probing.prober {
            ask(prober);
        }
    }

    fn show_in_editor(&mut self, words: &str) {
        if let Some(editor) = &mut self.ui_state.editor {
            editor.show_notice(words);
        }
    }
}
