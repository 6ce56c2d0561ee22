//! Checks of the blocks `picture` and `sky` beyond the types of their fields: what may depend on the pixel, and feedback
//! that never ends or never begins.

use super::super::diagnostic::Diagnostic;
use super::super::scene::{Picture, TextureRef};
use super::scene::SceneBuilder;
use super::sections::Values;
use crate::graph::{FrameInputs, Input, NodeId, ShapeAtlas};
use crate::limits::{FEEDBACK_DECAY_MAX, FEEDBACK_FRAMES_MAX, FEEDBACK_RATE};

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
        let most = FEEDBACK_FRAMES_MAX / FEEDBACK_RATE;
        let memory = self.lowering.graph.as_constant(picture.memory);
        if let Some((_, span)) = values.given("memory") {
            match memory {
                Some(memory) if (0.0..=most as f32).contains(&memory) => {
                    self.parts.memory = Some(span).filter(|_| decay <= 0.0);
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

    /// Warns of a `memory` without anything to remember; after all blocks, which may call `previous`.
    pub(super) fn check_memory(&mut self) {
        let is_read = self.lowering.declared.textures.iter().any(TextureRef::is_last_frame);
        if let Some(span) = self.parts.memory.filter(|_| !is_read) {
            let warning = Diagnostic::warning(span, "`memory` has no effect without trails and `previous`");
            self.lowering.reports.diagnostics.warn(warning.hint("set `decay = 0.95`, or leave `memory` out"));
        }
    }
}
