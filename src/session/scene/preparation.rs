//! From a scene that was asked for to one that can be drawn.
//!
//! ```text
//! loader (text → world) → upload → interpreter that is there already → drawn in the next frame
//!                                 → compiler threads → its own program → drawn when it is ready
//! ```
//!
//! A new scene is prepared in parallel with what is shown, and takes its place only when a program can draw it: a
//! scene that is broken or slow to compile never costs the present one. A scene in whose text numbers are being changed
//! needs no compiler: it takes over the program of its last version.

use std::rc::Rc;
use std::sync::Arc;
use std::time::Duration;

use super::ahead::{Lacking, WantedAhead};
use super::library::SceneLibrary;
use super::messages::Messages;
use super::prepared_scene::{DrawingChoice, FirstTree, PreparedScene};
use super::prepared_scenes::PreparedScenes;
use super::program_library::ProgramLibrary;
use super::program_task::{Task, ViewsOf};
use super::refusal::{Refusal, TREE_TOO_LONG, too_expensive};
use super::tree_trials::TreeTrials;
use super::versions::{last_version, only_settles};
use crate::clock;
use crate::config::SdfChoice;
use crate::gpu::cell_use::CellUse;
use crate::gpu::error::GpuError;
use crate::gpu::gl::Gl;
use crate::gpu::program::Program;
use crate::gpu::renderer::Renderer;
use crate::gpu::scene_program::Mode;
use crate::gpu::scene_resources::BuiltRegions;
use crate::scenes::{ReadyScene, SceneError, SceneSource};

/// How long nobody changes a number before all of them become constants of a program again.
const REST: Duration = Duration::from_secs(10);
/// Longest distance, in clauses, that `auto` shows interpreted on a software renderer while its own program is being
/// made: there a frame of a longer one takes many times as long as compiling it.
const SHOWN_AT_ONCE_BY_SOFTWARE_MAX: usize = 48;
/// What is done about the first tree of a scene that is coming.
pub(super) enum TreeVerdict {
    /// It is there, or nobody needs it.
    Fine,
    /// The scene is drawn without one.
    DrawnWithout(u64),
    /// The scene cannot be shown.
    Refused(Refusal),
}

/// See the module.
pub(super) struct ScenePreparation {
    gl: Gl,
    choice: DrawingChoice,
    /// What was asked for, and what loads it.
    pub library: SceneLibrary,
    trials: TreeTrials,
    next_scene: u64,
    /// The mode that the user asked for, until its program is there.
    asked_mode: Option<Mode>,
    // Last: its threads draw with what the fields above hold.
    pub programs: ProgramLibrary,
}

impl ScenePreparation {
    /// Prepares nothing yet.
    pub(super) fn new(
        gl: &Gl,
        choice: DrawingChoice,
        library: SceneLibrary,
        trials: TreeTrials,
        programs: ProgramLibrary,
    ) -> Self {
        Self { gl: gl.clone(), choice, library, trials, next_scene: 0, asked_mode: None, programs }
    }

    /// How scenes are drawn.
    pub(super) fn choice(&self) -> DrawingChoice {
        self.choice
    }

    /// Uses cells of regions from now on, or not.
    pub(super) fn set_cells(&mut self, cells: CellUse) {
        self.choice.cells = cells;
    }

    /// Takes what was loaded of the wanted scene, and prepares it. Returns what keeps it from being shown; then the last
    /// good scene stays.
    ///
    /// # Errors
    /// The driver refuses it, and there is nothing else to be shown.
    pub(super) fn take_loaded(
        &mut self,
        ready: Result<ReadyScene, SceneError>,
        scenes: &mut PreparedScenes,
    ) -> Result<Option<Refusal>, GpuError> {
        let source = self.library.wanted().clone();
        let name = source.title();
        let (heading, text) = match ready.map(|ready| self.prepare(source.clone(), ready, scenes)) {
            Ok(Ok(())) => return Ok(None),
            Ok(Err(error)) if scenes.shown.is_none() => return Err(error),
            Ok(Err(error)) => {
                let heading = format!("{name} cannot be drawn by this driver; the last good scene stays");
                tracing::warn!("{error}");
                (heading, error.to_string())
            }
            Err(error) => {
                let (what, text) = match &error {
                    SceneError::Mistakes { plain, .. } => ("has mistakes", plain.clone()),
                    SceneError::World(_) => ("is too complex to be drawn", error.to_string()),
                    other => ("cannot be read", other.to_string()),
                };
                match self.library.is_written() {
                    true => tracing::debug!("{error}"),
                    false => tracing::warn!("{error}"),
                }
                (format!("{name} {what}; the last good scene stays"), text)
            }
        };
        Ok(Some(Refusal { source, heading, text }))
    }

    /// Uploads a scene and requests its programs.
    ///
    /// # Errors
    /// What the driver refuses.
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

    /// Requests what a scene needs to be shown.
    pub(super) fn bring(&mut self, scene: PreparedScene, scenes: &mut PreparedScenes) {
        scenes.coming = Some(scene);
        self.forget_obsolete(scenes);
        let PreparedScenes { coming: Some(scene), ahead, .. } = scenes else { return };
        if scene.tree == FirstTree::Coming {
            self.trials.request(scene.id, &scene.resources, self.choice.cells);
            ahead.ask_again_for_trees();
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

    /// Whether `auto` waits for a scene's own program.
    fn is_patient_with(&self, scene: &PreparedScene) -> bool {
        let long = scene.resources.buffers().cost.distance > SHOWN_AT_ONCE_BY_SOFTWARE_MAX;
        self.gl.info().software && long && scene.is_compiled_by_itself()
    }

    /// Gives the scenes their interpreter.
    pub(super) fn give_interpreters(&mut self, scenes: &mut PreparedScenes) {
        let PreparedScenes { shown, coming, ahead, .. } = scenes;
        for scene in [shown, coming].into_iter().flatten().chain(ahead.scenes_mut()) {
            if let (None, Some(needed)) = (&scene.programs.interpreted, &scene.programs.interpreter) {
                scene.programs.interpreted = self.programs.interpreter_for(needed);
            }
        }
    }

    /// Whether the scene that is coming can be drawn in a mode that was asked for.
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

    /// Drops requests for scenes that will not be shown.
    pub(super) fn forget_obsolete(&mut self, scenes: &PreparedScenes) {
        self.programs.forget_all_but(&scenes.ids());
    }

    /// Takes a program that was requested for scenes, or the fact that it could not be made.
    ///
    /// # Errors
    /// There is nothing else to be shown.
    pub(super) fn take_program(
        &mut self,
        task: &Task,
        program: Result<Program, GpuError>,
        scenes: &mut PreparedScenes,
        messages: &mut Messages,
    ) -> Result<Vec<Refusal>, GpuError> {
        match (task, program) {
            (Task::Universal { non_lipschitz }, program) => {
                if let Some(sentence) = self.programs.take_universal(*non_lipschitz, program) {
                    messages.note_remark(sentence.to_owned(), None);
                    let waits = |scene: &&PreparedScene| {
                        let needed = scene.programs.interpreter.as_ref();
                        needed.is_some_and(|needed| needed.is_non_lipschitz() == *non_lipschitz)
                            && scene.programs.interpreted.is_none()
                    };
                    for scene in scenes.present().filter(waits) {
                        self.programs.request_interpreter(scene);
                    }
                }
            }
            (Task::Interpreter(interpreter), Ok(program)) => {
                self.programs.add_interpreter(interpreter.clone(), program);
            }
            (Task::Compiled { id, has_cells }, Ok(program)) => {
                if let Some(scene) = scenes.get_mut(*id) {
                    scene.programs.compiled = Some(Rc::new(program));
                    scene.programs.has_cells = *has_cells;
                }
            }
            (_, Ok(_)) => {}
            (task, Err(error)) => return self.take_failure(task, error, scenes, messages),
        }
        Ok(Vec::new())
    }

    /// Handles a program that could not be made. The scenes that need it are drawn in the other mode, if there is
    /// one.
    fn take_failure(
        &mut self,
        task: &Task,
        error: GpuError,
        scenes: &mut PreparedScenes,
        messages: &mut Messages,
    ) -> Result<Vec<Refusal>, GpuError> {
        tracing::warn!("{error}");
        scenes.ahead.leave(task);
        let mut affected = Vec::new();
        for scene in scenes.present_mut() {
            match task {
                Task::Compiled { id, .. } if *id == scene.id => {
                    scene.programs.compilable = false;
                    if scene.programs.compiled.is_some() {
                        // It is drawn by the program that it has.
                        continue;
                    }
                }
                Task::Interpreter(variant) if scene.programs.lack(variant) => {
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
            messages.set_hint(None);
        }
        if scenes.present().next().is_none() { Err(error) } else { Ok(refused) }
    }

    /// Requests the mode that is left to draw a scene, and says why. Returns a scene for which there is none.
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
        // What was reported in an earlier run needs a line only.
        if compilable && matches!(error, GpuError::GivenUp { .. }) {
            messages.answer(heading);
            return None;
        }
        let is_technical = self.choice.sdf == SdfChoice::Auto && source.file().is_none();
        match compilable || interpretable {
            true if is_technical => messages.note_remark(heading, None),
            true => messages.set_problem(heading, error.to_string()),
            false => return Some(Refusal { source, heading, text: error.to_string() }),
        }
        None
    }

    /// The first tree of a scene that has come, if there is one; no tree if it takes longer than anyone waits.
    pub(super) fn poll_tree(&self) -> Option<(u64, Option<Arc<BuiltRegions>>)> {
        self.trials.poll()
    }

    /// Takes the first tree of a scene that is coming, or the fact that there is none.
    pub(super) fn take_tree(
        &mut self,
        id: u64,
        tree: Option<Arc<BuiltRegions>>,
        scenes: &mut PreparedScenes,
    ) -> TreeVerdict {
        if scenes.ahead.scenes().any(|scene| scene.id == id) {
            scenes.ahead.take_tree(id, tree);
            return TreeVerdict::Fine;
        }
        let is_first = scenes.shown.is_none();
        let Some(scene) = scenes.coming.as_mut().filter(|scene| scene.id == id) else {
            return TreeVerdict::Fine;
        };
        if let Some(tree) = tree {
            scene.resources.take_regions(tree);
            scene.tree = FirstTree::There;
            return TreeVerdict::Fine;
        }
        // The first scene is drawn however long it takes: there is nothing else to show.
        scene.tree = FirstTree::TooLong;
        if is_first {
            return TreeVerdict::Fine;
        }
        let needs_tree = scene.resources.world().non_lipschitz || self.choice.sdf == SdfChoice::Interpreted;
        let has_program = scene.programs.compiled.is_some() || self.programs.is_making(scene, Mode::Compiled);
        if !needs_tree && has_program {
            scene.programs.without_interpreter();
            return TreeVerdict::DrawnWithout(id);
        }
        let Some(expensive) = scenes.coming.take() else { return TreeVerdict::Fine };
        self.forget_obsolete(scenes);
        TreeVerdict::Refused(too_expensive(&expensive, TREE_TOO_LONG))
    }

    /// Takes a scene that was shown in a mode and would take too long. If a program of the other mode is being made, the
    /// scene comes back in that mode; else it is refused. `why` begins a sentence.
    pub(super) fn take_back(
        &mut self,
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
        self.forget_obsolete(scenes);
        Some(too_expensive(&expensive, why))
    }

    /// Requests a scene's own program, unless it is there or was requested.
    fn request_compiled(&mut self, scene: &mut PreparedScene) {
        if scene.programs.compiled.is_none() && !self.programs.is_making(scene, Mode::Compiled) {
            scene.programs.compilable = true;
            self.programs.request_compiled(scene, self.wants_cells(scene));
        }
    }

    /// Requests the program of the scene that shows once more, if it cannot look up cells and that is wanted. Until it
    /// comes, the one that is there goes on.
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

    /// Whether a scene's compiled program is to look up the cells of a tree.
    fn wants_cells(&self, scene: &PreparedScene) -> bool {
        scene.resources.uses_cells(self.choice.cells, Mode::Compiled)
    }

    /// Requests interpreters that no scene has needed so far, once there is nothing else to do, for edits to come.
    pub(super) fn prepare_for_edits(&mut self, scenes: &PreparedScenes) {
        let is_idle = self.programs.is_idle() && self.programs.has_shown();
        if let Some(shown) = scenes.shown.as_ref().filter(|_| is_idle)
            && self.choice.sdf != SdfChoice::Compiled
        {
            self.programs.request_unneeded(shown);
        }
    }

    /// Goes on preparing what comes next. The present scene is complete.
    pub(super) fn prepare_ahead(&mut self, wanted: WantedAhead, scenes: &mut PreparedScenes) {
        if scenes.ahead.want(wanted, |source| self.library.neighbours_of(source)) {
            self.forget_obsolete(scenes);
        }
        let Some(Lacking { id, program, tree }) = scenes.ahead.go_on(self.choice.sdf) else { return };
        let Some(scene) = scenes.get_mut(id) else { return };
        if tree {
            tracing::info!("{} is prepared ahead", scene.title());
            self.trials.request(id, &scene.resources, self.choice.cells);
        }
        match program {
            Some(Mode::Compiled) => self.request_compiled(scene),
            Some(Mode::Interpreted) => self.programs.request_interpreter(scene),
            None => {}
        }
    }

    /// Takes the scenes that were loaded to be prepared ahead.
    pub(super) fn take_loaded_ahead(&mut self, scenes: &mut PreparedScenes) {
        for (at, loaded) in scenes.ahead.poll() {
            // What is wrong with it is said when somebody goes there.
            let ready = loaded.value.ok().filter(|ready| scenes.ahead.has_room_for(&ready.world));
            let scene = ready.and_then(|ready| {
                let uploaded = self.upload(loaded.source, ready, scenes);
                uploaded.inspect_err(|error| tracing::info!("not prepared ahead: {error}")).ok()
            });
            scenes.ahead.put(at, scene);
        }
    }

    /// Draws a neighbour that is ready but for its first draw, where nobody sees it.
    pub(super) fn rehearse(&self, renderer: &mut Renderer, scenes: &mut PreparedScenes) {
        scenes.ahead.rehearse(self.choice.sdf, renderer);
    }

    /// Wants a scene from now on. One that is prepared ahead needs no loader: it comes at once. Returns whether it does.
    pub(super) fn ask_for(&mut self, source: SceneSource, scenes: &mut PreparedScenes) -> bool {
        // Only the scene that is shown is kept in exchange.
        let from = scenes.shown_source().filter(|shown| *shown == self.library.wanted()).cloned();
        let prepared = from.and_then(|from| scenes.ahead.take(&source, from, self.library.loader_mut()));
        self.library.want(source);
        match prepared {
            Some(scene) => {
                self.bring(scene, scenes);
                true
            }
            None => {
                self.library.load();
                false
            }
        }
    }

    /// Asks for the scene again when nobody has changed a number for a while.
    pub(super) fn settle_numbers(&self, scenes: &mut PreparedScenes) {
        let is_coming = scenes.coming.is_some();
        let Some(shown) = scenes.shown.as_mut().filter(|scene| scene.is_changing()) else { return };
        let is_wanted = shown.source == *self.library.wanted();
        if clock::since(shown.since) > REST && !shown.is_resting && is_wanted && !is_coming {
            shown.is_resting = true;
            self.library.load();
        }
    }

    /// Changes between interpreted and compiled. A missing program is made; until then the picture stays. Returns the mode
    /// that is wanted now.
    pub(super) fn toggle_mode(&mut self, shown: Mode, scenes: &mut PreparedScenes) -> Mode {
        let other = match shown {
            Mode::Interpreted => Mode::Compiled,
            Mode::Compiled => Mode::Interpreted,
        };
        let waited_for = match self.choice.sdf {
            SdfChoice::Auto => None,
            SdfChoice::Interpreted => Some(Mode::Interpreted),
            SdfChoice::Compiled => Some(Mode::Compiled),
        };
        // A wish that is not fulfilled yet is withdrawn.
        let is_coming = scenes.shown.as_ref().is_some_and(|scene| self.programs.is_making(scene, other));
        let wanted = if waited_for == Some(other) && is_coming { shown } else { other };
        self.choice.sdf = match wanted {
            Mode::Interpreted => SdfChoice::Interpreted,
            Mode::Compiled => SdfChoice::Compiled,
        };
        // The scene that is coming also waits for what is wanted now.
        for scene in scenes.present_mut() {
            match wanted {
                Mode::Interpreted => self.programs.request_interpreter(scene),
                Mode::Compiled => self.request_compiled(scene),
            }
        }
        wanted
    }

    /// Notes the mode that the user waits for, if one.
    pub(super) fn await_mode(&mut self, mode: Option<Mode>) {
        self.asked_mode = mode;
    }

    /// Whether the user waited for this mode, which is there now; says so once.
    pub(super) fn has_come(&mut self, mode: Mode) -> bool {
        self.asked_mode.take_if(|asked| *asked == mode).is_some()
    }

    /// Says of each program that the driver is at for long that it is, once.
    pub(super) fn report_slow_programs(&self, scenes: &PreparedScenes, messages: &mut Messages) {
        for id in self.programs.slow() {
            let Some(task) = self.programs.task(id) else { continue };
            // Nobody waits for what is prepared ahead.
            let is_theirs =
                |scene: &PreparedScene| matches!(task, Task::Compiled { id, .. } if *id == scene.id);
            if scenes.ahead.scenes().any(is_theirs) {
                continue;
            }
            let what = match task {
                Task::Compiled { id: of, .. } => scenes.get(*of).map(PreparedScene::title),
                Task::Views(ViewsOf::Compiled(of)) => {
                    scenes.get(*of).map(|scene| format!("the views of {}", scene.title()))
                }
                Task::Views(ViewsOf::Interpreted(_)) => Some("the interpreter's views".to_owned()),
                Task::Interpreter(_) | Task::Universal { .. } => Some("an interpreter".to_owned()),
            };
            let Some(what) = what else { continue };
            let meanwhile = match scenes.shown {
                Some(_) => "the show goes on without it",
                None => "nothing can be shown before",
            };
            let sentence = format!("the driver is still compiling {what}: {meanwhile}");
            tracing::warn!("{sentence}");
            if self.user_waits_for(task, scenes, messages.is_scene_awaited()) {
                messages.answer(sentence.clone());
            }
            messages.note_remark(sentence, Some(id));
        }
    }

    /// True if the user requested the scene or mode that a task compiles for, or if the window is still empty.
    fn user_waits_for(&self, task: &Task, scenes: &PreparedScenes, is_scene_awaited: bool) -> bool {
        let coming = scenes.coming.as_ref().filter(|_| is_scene_awaited);
        let waits = match task {
            Task::Views(_) => true,
            Task::Compiled { id, .. } => {
                self.asked_mode == Some(Mode::Compiled) || coming.is_some_and(|scene| scene.id == *id)
            }
            Task::Interpreter(_) | Task::Universal { .. } => {
                let lacks_interpreter = |scene: &PreparedScene| scene.program(Mode::Interpreted).is_none();
                self.asked_mode == Some(Mode::Interpreted) || coming.is_some_and(lacks_interpreter)
            }
        };
        waits || scenes.shown.is_none()
    }
}
