//! The path from a requested scene to one that can be drawn.
//!
//! ```text
//! loader (text → world) → upload → available interpreter → drawn in the next frame
//!                                → compiler threads → its own program → drawn when ready
//! ```
//!
//! A new scene is prepared while the current one is shown, and replaces it only when a program can
//! draw it: a broken or slow scene never affects the current one. While numbers in a scene's text
//! are being changed, no compiler is needed: the new version uses the program of the last version.

use std::rc::Rc;
use std::sync::Arc;
use std::time::Duration;

use super::ahead::{Lacking, WantedAhead};
use super::library::SceneLibrary;
use super::messages::Messages;
use super::prepared_scene::{DrawingChoice, FirstTree, PreparedScene};
use super::prepared_scenes::PreparedScenes;
use super::program_library::ProgramLibrary;
use super::program_task::{ProgramOf, Task};
use super::refusal::{Refusal, TREE_TOO_LONG, too_expensive};
use super::region_builder::RegionBuilder;
use super::versions::{last_version, only_settles};
use crate::clock;
use crate::config::SdfChoice;
use crate::gpu::background::ProgramProduct;
use crate::gpu::{BuiltRegions, Gl, GpuError, Mode, Program};
use crate::scenes::{ReadyScene, SceneError, SceneSource};

/// Time without changes until the numbers of a text become constants of a program again.
const REST: Duration = Duration::from_secs(10);
/// With a software renderer, `auto` interprets a scene during its compilation only if its distance has at most this
/// many clauses. With more clauses, one frame takes many times the compile time.
const SHOWN_AT_ONCE_BY_SOFTWARE_MAX: usize = 48;

pub(crate) struct ScenePreparation {
    gl: Gl,
    pub(super) choice: DrawingChoice,
    pub library: SceneLibrary,
    /// Builds the first trees of new scenes. The build time shows whether a scene is fast enough to be drawn.
    pub(super) trials: RegionBuilder<u64>,
    next_scene: u64,
    /// The mode for which the user waits.
    pub(crate) asked_mode: Option<Mode>,
    // The last field, because its threads draw with objects of the fields above.
    pub(super) programs: ProgramLibrary,
}

impl ScenePreparation {
    pub(super) fn new(
        gl: &Gl,
        choice: DrawingChoice,
        library: SceneLibrary,
        trials: RegionBuilder<u64>,
        programs: ProgramLibrary,
    ) -> Self {
        Self { gl: gl.clone(), choice, library, trials, next_scene: 0, asked_mode: None, programs }
    }

    /// Takes the loaded scene. If the scene cannot be shown, returns the reason and keeps the last good scene.
    ///
    /// # Errors
    /// Fails if the driver rejects the scene, and no other scene can be shown.
    pub(super) fn receive_loaded(
        &mut self,
        ready: Result<ReadyScene, SceneError>,
        scenes: &mut PreparedScenes,
    ) -> Result<Option<Refusal>, GpuError> {
        let source = self.library.wanted.clone();
        let name = source.title();
        let mut warning = None;
        // The editor shows warnings beside the text.
        if let Ok(ready) = &ready
            && let Some(first) = ready.warnings.diagnostics.first()
            && !ready.settles
            && !self.library.is_written
            && matches!(source, SceneSource::File(_))
        {
            tracing::warn!("{}", ready.warnings.render(false));
            warning = Some(format!("{name}: {} (E shows it in the text)", first.message));
        }
        let (heading, text) = match ready.map(|ready| self.prepare(source.clone(), ready, scenes)) {
            Ok(Ok(())) => {
                if let Some(coming) = &mut scenes.coming {
                    coming.warning = warning;
                }
                return Ok(None);
            }
            Ok(Err(error)) if scenes.shown.is_none() => return Err(error),
            Ok(Err(error)) => {
                let heading = format!("{name} cannot be drawn by this driver; the last good scene stays");
                tracing::warn!("{error}");
                (heading, error.to_string())
            }
            Err(error) => {
                let (what, text) = match &error {
                    SceneError::Mistakes { found, .. } => ("has mistakes", found.render(false)),
                    SceneError::World(_) => ("is too complex to be drawn", error.to_string()),
                    other => ("cannot be read", other.to_string()),
                };
                match self.library.is_written {
                    true => tracing::debug!("{error}"),
                    false => tracing::warn!("{error}"),
                }
                (format!("{name} {what}; the last good scene stays"), text)
            }
        };
        Ok(Some(Refusal { source, heading, text }))
    }

    pub(super) fn prepare(
        &mut self,
        source: SceneSource,
        ready: ReadyScene,
        scenes: &mut PreparedScenes,
    ) -> Result<(), GpuError> {
        let mut scene = self.upload(source, ready, scenes)?;
        if let Some(last) = last_version(scenes, &scene) {
            scene.resources.expect_costs_of(&last.resources);
            scene.tree = FirstTree::Untried;
        }
        self.bring(scene, scenes);
        Ok(())
    }

    pub(super) fn bring(&mut self, scene: PreparedScene, scenes: &mut PreparedScenes) {
        scenes.coming = Some(scene);
        self.forget_obsolete(scenes);
        let PreparedScenes { coming: Some(scene), ahead, .. } = scenes else { return };
        if scene.tree == FirstTree::Coming {
            self.trials.request_first(scene.id, &scene.resources, self.choice.cells);
            ahead.request_trees_again();
        }
        let fits = scene.programs.interpreter.is_some();
        let (compiles, interprets) = match self.choice.sdf {
            SdfChoice::Interpreted => (!fits, true),
            SdfChoice::Compiled => (true, false),
            SdfChoice::Auto => {
                let interprets = scene.programs.compiled.is_none() && !self.is_patient_with(scene);
                (!fits || scene.is_compiled_by_itself(), interprets)
            }
        };
        if compiles {
            self.request_compiled(scene);
        }
        if interprets {
            self.programs.request_interpreter(scene);
        }
    }

    fn upload(
        &mut self,
        source: SceneSource,
        ready: ReadyScene,
        scenes: &PreparedScenes,
    ) -> Result<PreparedScene, GpuError> {
        let id = self.next_scene;
        self.next_scene += 1;
        let alike = || scenes.all().filter(|scene| scene.resources.world().is_compiled_like(&ready.world));
        let program =
            alike().find_map(|scene| Some((scene.programs.compiled.clone()?, scene.programs.has_cells)));
        if program.is_none() {
            self.programs.make_for(&alike().map(|scene| scene.id).collect::<Vec<_>>(), id);
        }
        let last = scenes.shown.as_ref().map(|scene| &scene.resources);
        let mut scene = PreparedScene::upload(&self.gl, id, source, ready, last)?;
        if let Some((program, has_cells)) = program {
            (scene.programs.compiled, scene.programs.has_cells) = (Some(program), has_cells);
        }
        Ok(scene)
    }

    /// True if `auto` waits for the scene's own program.
    fn is_patient_with(&self, scene: &PreparedScene) -> bool {
        let long = scene.resources.buffers().cost.distance > SHOWN_AT_ONCE_BY_SOFTWARE_MAX;
        self.gl.info().software && long && scene.is_compiled_by_itself()
    }

    pub(super) fn give_interpreters(&mut self, scenes: &mut PreparedScenes) {
        let PreparedScenes { shown, coming, ahead, .. } = scenes;
        for scene in [shown, coming].into_iter().flatten().chain(ahead.scenes_mut()) {
            if let (None, Some(needed)) = (&scene.programs.interpreted, &scene.programs.interpreter) {
                scene.programs.interpreted = self.programs.interpreter_for(needed);
            }
        }
    }

    pub(super) fn can_show_coming(&self, scenes: &PreparedScenes) -> bool {
        let Some(coming) = &scenes.coming else { return false };
        let waits = match self.choice.sdf {
            SdfChoice::Interpreted => false,
            SdfChoice::Compiled => true,
            SdfChoice::Auto => self.is_patient_with(coming) || only_settles(scenes),
        };
        let programs = &coming.programs;
        let has_program = programs.compiled.is_some()
            || (programs.interpreted.is_some() && !(waits && programs.compilable));
        has_program && coming.tree != FirstTree::Coming
    }

    /// Drops requests for programs of scenes that are gone.
    pub(super) fn forget_obsolete(&mut self, scenes: &PreparedScenes) {
        self.programs.forget_all_but(&scenes.ids());
    }

    /// Takes a requested program or its compile error.
    ///
    /// # Errors
    /// Fails if no scene can be shown.
    pub(super) fn receive_program(
        &mut self,
        task: &Task,
        program: Result<Program, GpuError>,
        scenes: &mut PreparedScenes,
        messages: &mut Messages,
    ) -> Result<Vec<Refusal>, GpuError> {
        match (&task.of, program) {
            (ProgramOf::Interpreted(interpreter), Ok(program)) => {
                self.programs.receive_interpreter(interpreter, program);
            }
            (ProgramOf::Interpreted(rejected), Err(error))
                if self.programs.reject_universal(rejected, &error) =>
            {
                for scene in scenes.present().filter(|scene| scene.programs.lack(rejected)) {
                    self.programs.request_interpreter(scene);
                }
            }
            (ProgramOf::Compiled(id), Ok(program)) => {
                if let Some(scene) = scenes.get_mut(*id) {
                    scene.programs.compiled = Some(Rc::new(program));
                    scene.programs.has_cells = task.has_cells;
                }
            }
            (of, Err(error)) => return self.handle_failure(of, error, scenes, messages),
        }
        Ok(Vec::new())
    }

    /// Handles a compile error. The affected scenes are drawn in the other mode, if there is one.
    fn handle_failure(
        &mut self,
        of: &ProgramOf,
        error: GpuError,
        scenes: &mut PreparedScenes,
        messages: &mut Messages,
    ) -> Result<Vec<Refusal>, GpuError> {
        tracing::warn!("{error}");
        scenes.ahead.leave(of);
        let mut affected = Vec::new();
        for scene in scenes.present_mut() {
            match of {
                ProgramOf::Compiled(id) if *id == scene.id => {
                    scene.programs.compilable = false;
                    if scene.programs.compiled.is_some() {
                        // The scene already has a program, which continues to draw it.
                        continue;
                    }
                }
                ProgramOf::Interpreted(variant) if scene.programs.lack(variant) => {
                    scene.programs.interpreter = None;
                }
                _ => continue,
            }
            affected.push(scene.id);
        }
        let refused = affected.into_iter().filter_map(|id| self.fall_back(id, &error, scenes, messages));
        let refused = refused.collect();
        let is_lost =
            |scene: &mut PreparedScene| !scene.programs.compilable && scene.programs.interpreter.is_none();
        if scenes.coming.take_if(is_lost).is_some() {
            messages.hint = None;
        }
        if scenes.present().next().is_none() { Err(error) } else { Ok(refused) }
    }

    /// Requests the other mode for a scene and reports why. Returns a refusal if the other mode has failed too.
    fn fall_back(
        &mut self,
        id: u64,
        error: &GpuError,
        scenes: &mut PreparedScenes,
        messages: &mut Messages,
    ) -> Option<Refusal> {
        let scene = scenes.get_mut(id)?;
        let (name, source) = (scene.title(), scene.source.clone());
        let (compilable, interpretable) = (scene.programs.compilable, scene.programs.interpreter.is_some());
        let heading = match (compilable, interpretable) {
            (false, true) => format!("{name} could not be compiled; it is interpreted instead"),
            (true, false) => format!("{name} could not be interpreted; it is compiled instead"),
            _ => format!("{name} cannot be drawn by this driver; the last good scene stays"),
        };
        if compilable {
            self.request_compiled(scene);
        } else {
            self.programs.request_interpreter(scene);
        }
        // A failure already reported in an earlier run is shown as one line.
        if compilable && matches!(error, GpuError::GivenUp { .. }) {
            messages.answer(heading);
            return None;
        }
        if !compilable && !interpretable {
            return Some(Refusal { source, heading, text: error.to_string() });
        }
        // Nobody who watches shipped scenes can do anything about it.
        if self.choice.sdf != SdfChoice::Auto || source.file().is_some() {
            messages.set_problem(heading, error.to_string());
        }
        None
    }

    /// Takes the first tree of a new scene; `None` if the build was too slow.
    pub(super) fn receive_tree(
        &self,
        id: u64,
        tree: Option<Arc<BuiltRegions>>,
        scenes: &mut PreparedScenes,
    ) -> Result<Option<u64>, Refusal> {
        if scenes.ahead.scenes().any(|scene| scene.id == id) {
            scenes.ahead.receive_tree(id, tree);
            return Ok(None);
        }
        let is_first = scenes.shown.is_none();
        let Some(scene) = scenes.coming.as_mut().filter(|scene| scene.id == id) else {
            return Ok(None);
        };
        if let Some(tree) = tree {
            scene.resources.upload_regions(tree);
            scene.tree = FirstTree::There;
            return Ok(None);
        }
        // Draw the very first scene even if it is slow, because there is no other scene.
        scene.tree = FirstTree::TooLong;
        if is_first {
            return Ok(None);
        }
        let needs_tree = scene.resources.world().non_lipschitz || self.choice.sdf == SdfChoice::Interpreted;
        let has_program = scene.programs.compiled.is_some() || self.programs.is_making(scene, Mode::Compiled);
        if !needs_tree && has_program {
            scene.programs.without_interpreter();
            return Ok(Some(id));
        }
        scenes.coming.take().map_or(Ok(None), |expensive| Err(too_expensive(&expensive, TREE_TOO_LONG)))
    }

    /// Takes a scene that proved too slow in `mode`. If its compiled program is available or being made, the scene is
    /// shown again with this program; otherwise the scene is refused. `why` is the beginning of a sentence.
    pub(super) fn withdraw(
        &self,
        mut expensive: PreparedScene,
        mode: Mode,
        why: &str,
        scenes: &mut PreparedScenes,
    ) -> Option<Refusal> {
        let other_way = mode == Mode::Interpreted
            && expensive.programs.compilable
            && (expensive.programs.compiled.is_some() || self.programs.is_making(&expensive, Mode::Compiled));
        if other_way && self.choice.sdf != SdfChoice::Interpreted {
            expensive.programs.without_interpreter();
            scenes.coming = Some(expensive);
            return None;
        }
        Some(too_expensive(&expensive, why))
    }

    /// Requests a scene's own program, unless it exists or was requested.
    fn request_compiled(&mut self, scene: &mut PreparedScene) {
        if scene.programs.compiled.is_none() && !self.programs.is_making(scene, Mode::Compiled) {
            scene.programs.compilable = true;
            self.programs.request_compiled(scene, self.wants_cells(scene));
        }
    }

    /// Recompiles the shown scene with cell lookups if they are wanted and missing. Keeps the old program meanwhile.
    pub(super) fn request_cells(&mut self, scenes: &PreparedScenes) {
        let drawable =
            |scene: &&PreparedScene| scene.programs.compiled.is_some() && scene.programs.compilable;
        let Some(scene) = scenes.shown.as_ref().filter(drawable) else { return };
        if !scene.programs.has_cells
            && self.wants_cells(scene)
            && !self.programs.is_making(scene, Mode::Compiled)
        {
            self.programs.request_compiled(scene, true);
        }
    }

    fn wants_cells(&self, scene: &PreparedScene) -> bool {
        scene.resources.uses_cells(self.choice.cells, Mode::Compiled)
    }

    /// When idle, requests interpreters that no scene has needed yet, because they speed up later edits.
    pub(super) fn prepare_for_edits(&mut self, scenes: &PreparedScenes) {
        let is_idle = self.programs.is_idle() && self.programs.has_shown;
        if let Some(shown) = scenes.shown.as_ref().filter(|_| is_idle)
            && self.choice.sdf != SdfChoice::Compiled
        {
            self.programs.request_unneeded(shown);
        }
    }

    /// Continues to prepare the next scenes. Called when the current scene is complete.
    pub(super) fn prepare_ahead(&mut self, wanted: WantedAhead, scenes: &mut PreparedScenes) {
        scenes.ahead.request(wanted, |source| self.library.neighbours_of(source));
        let fading_out = scenes.fading_out.as_ref().map(|scene| &scene.source);
        let lacking = scenes.ahead.prepare_next(self.choice.sdf, fading_out);
        let Some(Lacking { id, program, tree }) = lacking else { return };
        let Some(scene) = scenes.get_mut(id) else { return };
        if tree {
            tracing::info!("{} is prepared ahead", scene.title());
            self.trials.request_first(id, &scene.resources, self.choice.cells);
        }
        match program {
            Some(Mode::Compiled) => self.request_compiled(scene),
            Some(Mode::Interpreted) => self.programs.request_interpreter(scene),
            None => {}
        }
    }

    pub(super) fn receive_loaded_ahead(&mut self, scenes: &mut PreparedScenes) {
        for (at, loaded) in scenes.ahead.poll() {
            // Ignore errors: they are reported when the user requests the scene.
            let ready = loaded.value.ok().filter(|ready| scenes.ahead.has_room_for(&ready.world));
            let scene = ready.and_then(|ready| {
                let uploaded = self.upload(loaded.source, ready, scenes);
                uploaded.inspect_err(|error| tracing::info!("a scene is not prepared ahead: {error}")).ok()
            });
            scenes.ahead.put(at, scene);
        }
    }

    /// Requests a scene. Returns `true` if it is already prepared and needs no loader.
    pub(super) fn request_scene(&mut self, source: SceneSource, scenes: &mut PreparedScenes) -> bool {
        // Only a scene that is already shown can take a neighbour's place.
        let from = scenes.shown_source().filter(|shown| *shown == &self.library.wanted).cloned();
        let PreparedScenes { ahead, fading_out, .. } = scenes;
        let prepared =
            from.and_then(|from| ahead.remove(&source, from, &mut self.library.loader, fading_out));
        self.library.wanted = source;
        let is_prepared = prepared.is_some();
        match prepared {
            Some(scene) => self.bring(scene, scenes),
            None => self.library.load(),
        }
        is_prepared
    }

    /// Reloads the scene after its numbers have rested for a while.
    pub(super) fn settle_numbers(&self, scenes: &mut PreparedScenes) {
        let is_coming = scenes.coming.is_some();
        let Some(shown) = scenes.shown.as_mut().filter(|scene| scene.is_changing()) else { return };
        let is_wanted = shown.source == self.library.wanted;
        if clock::since(shown.since) > REST && !shown.is_resting && is_wanted && !is_coming {
            shown.is_resting = true;
            self.library.load();
        }
    }

    /// Toggles interpreted and compiled, and returns the mode. The current program is used until the new one is ready.
    pub(super) fn toggle_mode(&mut self, shown: Mode, scenes: &mut PreparedScenes) -> Mode {
        let other = match shown {
            Mode::Interpreted => Mode::Compiled,
            Mode::Compiled => Mode::Interpreted,
        };
        let choice_of = |mode: Mode| match mode {
            Mode::Interpreted => SdfChoice::Interpreted,
            Mode::Compiled => SdfChoice::Compiled,
        };
        // A mode that is still being prepared is cancelled.
        let is_coming = scenes.shown.as_ref().is_some_and(|scene| self.programs.is_making(scene, other));
        let wanted = if self.choice.sdf == choice_of(other) && is_coming { shown } else { other };
        self.choice.sdf = choice_of(wanted);
        // The next scene also waits for the new mode.
        for scene in scenes.present_mut() {
            match wanted {
                Mode::Interpreted => self.programs.request_interpreter(scene),
                Mode::Compiled => self.request_compiled(scene),
            }
        }
        wanted
    }

    /// Reports programs that the driver has been compiling for a long time, each program once.
    pub(super) fn report_slow_programs(&self, scenes: &PreparedScenes, messages: &mut Messages) {
        for id in self.programs.compiler.slow() {
            let Some(task) = self.programs.tasks.get(&id) else { continue };
            let is_for_frames = task.product == ProgramProduct::Frames;
            // Skip scenes prepared ahead: nobody waits for them.
            let is_theirs = |scene: &PreparedScene| task.of == ProgramOf::Compiled(scene.id);
            if is_for_frames && scenes.ahead.scenes().any(is_theirs) {
                continue;
            }
            let what = match (task.product, &task.of) {
                (ProgramProduct::Views, _) => Some("views".to_owned()),
                (ProgramProduct::Paths, _) => Some("paths of light".to_owned()),
                (ProgramProduct::Frames, ProgramOf::Interpreted(_)) => Some("an interpreter".to_owned()),
                (ProgramProduct::Frames, ProgramOf::Compiled(of)) => {
                    scenes.get(*of).map(PreparedScene::title)
                }
            };
            let Some(what) = what else { continue };
            let meanwhile = match scenes.shown {
                Some(_) => "the current scene stays until then",
                None => "the window stays empty until then",
            };
            let sentence = format!("the driver is still compiling {what}: {meanwhile}");
            tracing::warn!("{sentence}");
            let is_awaited = messages.hint.is_some() || self.asked_mode.is_some() || scenes.shown.is_none();
            if is_awaited || !is_for_frames {
                messages.answer(sentence);
            }
        }
    }
}
