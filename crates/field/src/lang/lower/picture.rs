//! Checks of the blocks `picture` and `sky` beyond the types of their fields: what may depend on the pixel, and feedback
//! that never ends or never begins.

use super::super::diagnostic::Diagnostic;
use super::super::scene::{Picture, TextureRef};
use super::scene::SceneBuilder;
use super::sections::Values;
use crate::graph::{FrameInputs, Input, NodeId, Point, Screen, ShapeAtlas};
use crate::limits::{FEEDBACK_DECAY_MAX, FEEDBACK_FRAMES_MAX, FEEDBACK_RATE};

/// Light is forgotten when less than this fraction is left.
pub(crate) const FORGOTTEN: f32 = 1.0 / 255.0;
/// A scene changes visibly when a history begins if more than this fraction of light is left by then.
pub(crate) const VISIBLE: f32 = 4.0 * FORGOTTEN;

/// Returns the message about light that outlasts the frames that a scene remembers.
pub(crate) fn outlasting(light: &str, left: f32, frames: u32) -> String {
    let seconds = frames as f32 / FEEDBACK_RATE as f32;
    format!(
        "{light} longer than the scene's memory of {seconds} s: {:.0} % is left when it ends, so the brightness changes \
         every {seconds} s",
        100.0 * left
    )
}

impl SceneBuilder<'_> {
    /// Reports fields that depend on the pixel through a `let` of the block, which only the field `allowed` may do.
    /// Silent after other mistakes, which may be the same.
    pub(super) fn refuse_pixels(&mut self, fields: &[(&str, &[NodeId])], allowed: &str, values: &Values) {
        if !self.lowering.reports.diagnostics.is_empty() {
            return;
        }
        for (name, numbers) in fields {
            let Some((_, span)) = values.given(name) else { continue };
            let Ok(used) = self.lowering.graph.inputs_used(numbers) else { continue };
            if used.inputs.contains(&Input::X) || used.inputs.contains(&Input::Y) {
                let message = format!("`{name}` cannot depend on `pixel`, which is a place in the picture");
                let wrong = Diagnostic::unsupported(span, message);
                self.lowering.reports.add(wrong.hint(format!("use `pixel` in {allowed} alone")));
            }
        }
    }

    pub(super) fn check_picture(&mut self, picture: &Picture, values: &Values) {
        let fields = [
            ("exposure", &[picture.exposure][..]),
            ("bloom", &[picture.bloom]),
            ("vignette", &[picture.vignette]),
            ("grain", &[picture.grain]),
            ("decay", &[picture.decay]),
            ("blur", &[picture.blur]),
        ];
        self.refuse_pixels(&fields, "`warp`", values);
        let params = self.lowering.declared.params.iter().map(|param| (param.min, param.max));
        let any = FrameInputs::any(params, &ShapeAtlas::NONE);
        let decay = picture.largest_decay(&self.lowering.graph, &any);
        let is_warped_away = values.given("warp").is_some() && self.is_warped_away(picture);
        let mut warn = |span, message: String, hint: &str| {
            self.lowering.reports.diagnostics.warn(Diagnostic::warning(span, message).hint(hint));
        };
        match values.given("decay") {
            Some((_, span)) if decay > FEEDBACK_DECAY_MAX => warn(
                span,
                format!("`decay` may be above {FEEDBACK_DECAY_MAX}, so trails would last too long"),
                "larger values are limited to it; `min` or `clamp` show that yours are smaller",
            ),
            Some((_, span)) if decay <= 0.0 => warn(
                span,
                "`decay` is never above 0, so there are no trails".to_owned(),
                "write the fraction of the light that stays, as in `decay = 0.95`",
            ),
            _ => {}
        }
        for name in ["warp", "blur"] {
            if let Some((_, span)) = values.given(name)
                && decay <= 0.0
            {
                warn(span, format!("`{name}` has no effect without trails"), "set `decay = 0.95`");
            }
        }
        if let Some((_, span)) = values.given("warp")
            && is_warped_away
        {
            warn(
                span,
                "`warp` takes all trails from outside of the picture".to_owned(),
                "places are 0 to 1, as in `pixel / resolution`",
            );
        }
        let most = FEEDBACK_FRAMES_MAX / FEEDBACK_RATE;
        let memory = self.lowering.graph.as_constant(picture.memory);
        if let Some((_, span)) = values.given("memory") {
            match memory {
                Some(memory) if (0.0..=most as f32).contains(&memory) => {
                    self.parts.memory = Some(span).filter(|_| decay <= 0.0);
                    let frames = (memory * FEEDBACK_RATE as f32).ceil();
                    let left = decay.clamp(0.0, FEEDBACK_DECAY_MAX).powf(frames);
                    if memory > 0.0 && left > VISIBLE {
                        warn(
                            span,
                            outlasting("trails last", left, frames as u32),
                            "leave `memory` out, because it follows from `decay`, or lower `decay`",
                        );
                    }
                }
                Some(memory) if memory > most as f32 => warn(
                    span,
                    format!("a `memory` of {memory} s would delay each still and each jump"),
                    &format!("it is limited to {most} s"),
                ),
                _ if !self.lowering.reports.diagnostics.is_empty() => {}
                _ => {
                    let wrong = Diagnostic::new(span, "`memory` is no number of seconds");
                    self.lowering.reports.add(wrong.hint(format!("write a number from 0 to {most}")));
                }
            }
        }
    }

    /// True if no trail at some pixels comes from a place in the picture, at the start of a silent song.
    fn is_warped_away(&self, picture: &Picture) -> bool {
        let params = self.lowering.declared.params.iter().map(|param| param.default).collect();
        let screen = Screen::of_size((1280, 720));
        let inputs = FrameInputs { params, screen, ..FrameInputs::default() };
        (1..16).all(|at| {
            let point = Point::at(80.0 * at as f32, 45.0 * at as f32, 0.0);
            let place = self.lowering.graph.evaluate(&picture.warp, &point, &inputs).unwrap_or_default();
            place.iter().all(|part| part.is_finite()) && place.iter().any(|part| !(0.0..=1.0).contains(part))
        })
    }

    /// Warns of a `memory` without anything to remember; after all blocks, which may call `previous`.
    pub(super) fn check_memory(&mut self) {
        let is_read = self.lowering.declared.textures.iter().any(TextureRef::is_last_frame);
        if let Some(span) = self.parts.memory.filter(|_| !is_read) {
            let warning = Diagnostic::warning(span, "`memory` has no effect without trails and `previous`");
            self.lowering.reports.diagnostics.warn(warning.hint("set `decay = 0.95`, or leave `memory` out"));
        }
    }
}
