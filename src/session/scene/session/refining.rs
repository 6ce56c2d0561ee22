//! Refines the shown frame of a paused moment ([`super::super::refinement`]), and takes the programs of views and paths.

use super::{PreparedScene, PreparedScenes, SceneComposer, SceneSession};
use crate::gpu::background::ProgramProduct;
use crate::gpu::{GpuError, Mode, Program, Renderer};
use crate::session::scene::composer::Drawn;
use crate::session::scene::program_task::Task;
use crate::session::scene::regions::Shown;

impl SceneSession {
    /// Begins to refine the shown frame once it is at rest, or ends the refinement. Returns true for a beginning.
    pub(crate) fn toggle_refinement(&mut self) -> bool {
        if self.refinement.is_on() {
            self.refine_only(None);
            self.messages.answer("no longer refined");
            return false;
        }
        if let Some(words) = why_not_refined(&self.scenes, &self.composer) {
            self.messages.answer(words);
            return false;
        }
        self.refinement.request();
        self.messages.answer("refining this moment by paths of light");
        self.request_paths();
        true
    }

    /// Ends the refinement of any frame except `wanted`. `None` ends every refinement, and draws the frame again as before.
    pub(crate) fn refine_only(&mut self, wanted: Option<Shown>) {
        match wanted {
            Some(wanted) => self.refinement.end_of_others(wanted),
            None if self.refinement.is_on() => {
                self.refinement.end();
                self.composer.redraw();
            }
            None => {}
        }
    }

    /// True if the shown frame is at rest, and [`Self::refine`] makes it better.
    pub(crate) fn can_refine(&self) -> bool {
        let Some((scene, mode)) = self.drawn() else { return false };
        let is_ready =
            || scene.program_of(mode).is_some_and(|wanted| self.refinement.programs.cover(&wanted));
        self.refinement.is_unfinished()
            && self.scenes.coming.is_none()
            && self.composer.rests_on(scene.id)
            && !self.preparation.programs.is_making(scene, Mode::Compiled)
            && is_ready()
    }

    /// Continues the refinement of the frame that is shown as `of`. Returns the frame if its image has become better.
    ///
    /// # Errors
    /// Fails if the driver reports an error other than a lack of memory.
    pub(crate) fn refine(&mut self, renderer: &mut Renderer, of: Shown) -> Result<Option<Drawn>, GpuError> {
        let begun = crate::clock::now();
        let patience = self.preparation.library.length_of_go();
        let Some((scene, mode)) = self.scenes.drawn(self.preparation.choice.sdf) else { return Ok(None) };
        let Some(frame) = self.composer.pictures.frame() else { return Ok(None) };
        match self.refinement.resume(renderer, scene, mode, frame, of, patience) {
            Ok((is_better, words)) => {
                words.into_iter().for_each(|words| self.messages.answer(words));
                let spent = crate::clock::since(begun);
                Ok(is_better.then_some(Drawn { shown: of, spent }))
            }
            Err(GpuError::Object { what, reason }) => {
                tracing::warn!("the driver could not make {what}: {reason}");
                self.refine_only(None);
                self.messages.answer("the driver has no memory to refine this moment");
                Ok(None)
            }
            Err(error) => Err(error),
        }
    }

    pub(super) fn request_view(&mut self) {
        let Some((scene, mode)) = self.scenes.drawn(self.preparation.choice.sdf) else { return };
        if let Some(wanted) = self.composer.views.missing(scene, mode) {
            self.preparation.programs.request_special(scene, ProgramProduct::Views, wanted);
        }
    }

    /// Requests the program of paths if it is needed. Ends the refinement where it is impossible.
    pub(super) fn request_paths(&mut self) {
        self.refinement.programs.keep(&self.scenes.ids());
        if !self.refinement.is_wanted() {
            return;
        }
        if let Some(words) = why_not_refined(&self.scenes, &self.composer) {
            self.refinement.end();
            return self.messages.answer(words);
        }
        let Some((scene, mode)) = self.scenes.drawn(self.preparation.choice.sdf) else { return };
        // Another program may still come, which will draw the scene.
        if self.preparation.programs.is_making(scene, Mode::Compiled) {
            return;
        }
        if let Some(wanted) = self.refinement.programs.missing(scene, mode) {
            self.preparation.programs.request_special(scene, ProgramProduct::Paths, wanted);
        }
    }

    /// Takes a program of views or of paths, or its compile error.
    pub(in crate::session::scene) fn receive_special(
        &mut self,
        task: Task,
        program: Result<Program, GpuError>,
    ) {
        let draws_views = task.product == ProgramProduct::Views;
        let error = match program {
            Ok(program) if draws_views => return self.composer.views.add(task.of, program),
            Ok(program) => return self.refinement.programs.add(task.of, program),
            Err(error) => error,
        };
        tracing::warn!("{error}");
        let failed = if draws_views {
            self.composer.show_view(None);
            "show views"
        } else {
            self.refinement.end();
            "draw paths of light"
        };
        self.messages.set_problem(format!("this driver cannot {failed}"), error.to_string());
    }
}

/// The reason why the shown frame cannot be refined.
fn why_not_refined(scenes: &PreparedScenes, composer: &SceneComposer) -> Option<&'static str> {
    if composer.views.choice.is_some() {
        return Some("views show numbers, not light: turn them off (V) to refine the moment");
    }
    let is_blend = scenes.shown.as_ref().is_some_and(PreparedScene::is_blend);
    let is_mixed = is_blend || scenes.fading_out.is_some() || composer.fading.goes_on();
    is_mixed.then_some("two scenes are mixed: only a single scene can be refined")
}
