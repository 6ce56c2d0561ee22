//! From a loaded scene to the one on the stage: uploaded, given its programs and its tree, and brought on when it can
//! be drawn.

use std::time::Instant;

use super::hands::sliders_of;
use super::{Cast, FirstTree, SceneStage};
use crate::config::SdfChoice;
use crate::frame::orbit_controls::OrbitControls;
use crate::gpu::error::GpuError;
use crate::gpu::scene_program::Interpreter;
use crate::gpu::scene_resources::SceneResources;
use crate::scenes::{ReadyScene, SceneSource};

/// Longest distance, in clauses, that `auto` shows interpreted on a software renderer while its own program is being
/// made: there a frame of a longer one takes many times as long as compiling it.
const SHOWN_AT_ONCE_BY_SOFTWARE_MAX: usize = 48;

impl SceneStage {
    /// Uploads a scene and requests its programs.
    pub(super) fn prepare(&mut self, source: SceneSource, ready: ReadyScene) -> Result<(), GpuError> {
        let mut cast = self.make_cast(source, ready)?;
        if let Some(last) = self.last_version(&cast) {
            cast.resources.expect_costs_of(&last.resources);
            cast.tree = FirstTree::Untried;
        }
        self.bring(cast);
        Ok(())
    }

    /// Requests what a scene needs to come onto the stage.
    pub(super) fn bring(&mut self, cast: Cast) {
        let id = cast.id;
        self.coming = Some(cast);
        self.forget_obsolete();
        let Some(cast) = self.cast(id) else { return };
        if cast.tree == FirstTree::Coming {
            self.regions.try_tree(id, &cast.resources);
            self.ahead.ask_again_for_trees();
        }
        let Some(cast) = self.cast(id) else { return };
        let fits = cast.interpreter.is_some();
        let (compiles, interprets) = match self.choice {
            SdfChoice::Interpreted => (!fits, true),
            SdfChoice::Compiled => (true, false),
            SdfChoice::Auto => {
                let interprets = cast.compiled.is_none() && !self.is_patient_with(cast);
                (!fits || cast.is_compiled_by_itself(), interprets)
            }
        };
        if compiles {
            self.ask_for_compiled(id);
        }
        if interprets {
            self.ask_for_interpreter(id);
        }
        self.recast();
    }

    /// Uploads a scene.
    pub(super) fn make_cast(&mut self, source: SceneSource, ready: ReadyScene) -> Result<Cast, GpuError> {
        let fits = Interpreter::fits(&ready.buffers, &ready.plan, self.gl.info());
        if let Err(error) = fits {
            tracing::warn!("{error}");
        }
        let interpreter = fits
            .is_ok()
            .then(|| Interpreter::for_scene(ready.world.traits, &ready.buffers, &ready.plan, self.gl.info()));
        let (sliders, knobs) = sliders_of(&source, &ready);
        let graph = &ready.world.scene.graph;
        let (moves, hears_curves) = (graph.moves_by_itself(), graph.reads_curves());
        let id = self.fresh_id();
        let (compiled, has_cells) = self.inherited_program(id, &ready.world).unzip();
        let last = self.on_stage.as_ref().map(|cast| &cast.resources);
        let resources = SceneResources::upload_after(last, &self.gl, ready.world, ready.buffers, ready.plan)?;
        Ok(Cast {
            id,
            source,
            resources,
            interpreter,
            interpreted: None,
            compiled,
            has_cells: has_cells.unwrap_or_default(),
            tree: FirstTree::Coming,
            compilable: true,
            moves,
            hears_curves,
            sliders,
            knobs,
            since: Instant::now(),
            settles: ready.settles,
            is_resting: false,
        })
    }

    /// Whether `auto` waits for a scene's own program.
    pub(super) fn is_patient_with(&self, cast: &Cast) -> bool {
        let long = cast.resources.buffers().cost.distance > SHOWN_AT_ONCE_BY_SOFTWARE_MAX;
        self.gl.info().software && long && cast.is_compiled_by_itself()
    }

    /// Gives the scenes their interpreter, and brings the coming scene onto the stage as soon as it can be drawn in a
    /// mode that was asked for.
    pub(super) fn recast(&mut self) {
        let before = self.announced;
        let staged = [&mut self.on_stage, &mut self.coming].into_iter().flatten();
        for cast in staged.chain(self.ahead.casts_mut()) {
            if let (None, Some(needed)) = (&cast.interpreted, &cast.interpreter) {
                cast.interpreted = self
                    .universal
                    .find(needed)
                    .or_else(|| self.interpreters.find(|known| known.covers(needed)));
            }
        }
        let can_be_drawn = self.coming.as_ref().is_some_and(|cast| {
            let waits = match self.choice {
                SdfChoice::Interpreted => false,
                SdfChoice::Compiled => true,
                SdfChoice::Auto => self.is_patient_with(cast) || self.coming_only_settles(),
            };
            let has_program =
                cast.compiled.is_some() || (cast.interpreted.is_some() && !(waits && cast.compilable));
            has_program && cast.tree != FirstTree::Coming && !self.must_wait_for_the_picture(cast)
        });
        if can_be_drawn {
            let replaced = std::mem::replace(&mut self.on_stage, self.coming.take());
            let name = |cast: &Option<Cast>| cast.as_ref().map(|cast| cast.source.title());
            let is_another = replaced.is_some() && name(&replaced) != name(&self.on_stage);
            let source = |cast: &Option<Cast>| cast.as_ref().map(|cast| cast.source.clone());
            if source(&replaced) != source(&self.on_stage) {
                self.edits.forget();
            } else if self.on_stage.as_ref().is_some_and(|cast| !cast.settles) {
                self.edits.note(Instant::now());
            }
            if let Some(left) = replaced.as_ref().filter(|_| is_another) {
                // A single one may have waited for a driver, or for the processors.
                self.note_left(left, self.pictures_took.into_iter().min().unwrap_or_default());
            }
            // There is no point in coming back to a scene that has shown nothing.
            if self.pictured == replaced.as_ref().map(|cast| cast.id) {
                self.before = replaced;
            }
            self.forget_obsolete();
            // Hands may have turned its parameters since the scene was asked for.
            self.update_sliders();
            self.awaited = None;
            if is_another {
                self.fade_if_it_can();
                if !self.is_as_directed() {
                    let words = self.shown_source().map(|source| self.placed_name(source));
                    self.tell(words.unwrap_or_default());
                }
                self.hand = OrbitControls::OFF;
            }
        }
        self.ask_for_view();
        self.ask_for_cells();
        let now = self.on_stage.as_ref().map(|cast| cast.id).zip(self.mode());
        if now == before {
            return;
        }
        self.announced = now;
        self.revision += 1;
        let Some((name, (id, mode))) = self.name().zip(now) else { return };
        tracing::info!("{name} is shown, {mode}");
        if before.is_some_and(|(known, _)| known == id) && self.asked_mode == Some(mode) {
            self.asked_mode = None;
            self.tell(mode.to_string());
        }
    }
}
