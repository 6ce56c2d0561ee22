//! The scene on the stage: which world is drawn, by which program, and what comes next.
//!
//! ```text
//! loader (text → world) → upload → interpreter that is there already → drawn in the next frame
//!                                 → compiler threads → its own program → drawn when it is ready
//! ```
//!
//! A new scene is prepared in parallel with what is shown, and takes its place only when a program can draw it: a
//! scene that is broken or slow to compile never costs the present one.

mod ahead;
mod changed_numbers;
mod context_change;
mod drawing;
mod fading;
mod kept;
mod told;
mod universal;
mod views;
mod wishes;

use std::collections::HashMap;
use std::rc::Rc;
use std::time::{Duration, Instant};

use ahead::Ahead;
pub(super) use context_change::{DrawingWays, LoadedScene, SceneLoaders};
use drawing::Making;
pub(super) use drawing::{Drawn, WantedPicture};
use fading::Fading;
use kept::KeptPrograms;
use universal::UniversalInterpreters;
use views::{Views, ViewsOf};

use super::overlay::Slider;
use super::scene_regions::SceneRegions;
use crate::config::SdfChoice;
use crate::frame::Frame;
use crate::frame::block::RegionTree;
use crate::frame::orbit_controls::OrbitControls;
use crate::gpu::background::{BackgroundCompiler, ProgramJob, Sources, WorkerContext};
use crate::gpu::error::GpuError;
use crate::gpu::gl::Gl;
use crate::gpu::program::Program;
use crate::gpu::renderer::Counting;
use crate::gpu::scene_program::{COMPILED_BY_ITSELF_MAX, Interpreter, Mode, compiled_variant_of};
use crate::gpu::scene_resources::SceneResources;
use crate::gpu::stand_ins::SceneShape;
use crate::scenes::{Loaded, Loader, ReadyScene, SceneError, SceneList, SceneSource};

/// What the loader gives.
pub(super) type SceneLoader = Loader<Result<ReadyScene, SceneError>>;

/// Longest distance, in clauses, that `auto` shows interpreted on a software renderer while its own program is being
/// made: there a frame of a longer one takes many times as long as compiling it.
const SHOWN_AT_ONCE_BY_SOFTWARE_MAX: usize = 48;

/// A scene with what can draw it.
struct Cast {
    id: u64,
    source: SceneSource,
    resources: SceneResources,
    /// The variant of the interpreter that it needs; none if its tape does not fit the driver, or the driver refused
    /// it.
    interpreter: Option<Interpreter>,
    interpreted: Option<Rc<Program>>,
    compiled: Option<Rc<Program>>,
    tree: FirstTree,
    /// Whether no compiler has refused it so far.
    compilable: bool,
    /// Whether it also moves without sound.
    moves: bool,
    /// Whether it reads curves of the sound.
    hears_curves: bool,
    sliders: Vec<Slider>,
    /// When it was loaded.
    since: Instant,
    /// Whether it is the scene on the stage with its numbers as constants again.
    settles: bool,
    /// Whether it was asked for again, because its numbers are no longer changed.
    is_resting: bool,
}

/// The first tree of regions of a scene that is coming.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FirstTree {
    /// It is being built.
    Coming,
    /// It is there.
    There,
    /// It takes longer than anyone waits for a picture.
    TooLong,
}

/// The purpose of a program that is being made.
enum Task {
    Compiled(u64),
    Interpreter(Interpreter),
    Universal {
        /// Whether it is for formulas that are no distances.
        steep: bool,
    },
    Views(ViewsOf),
}

/// The scene on the stage, and the one behind it.
pub(super) struct SceneStage {
    gl: Gl,
    choice: SdfChoice,
    loader: SceneLoader,
    list: SceneList,
    /// What was asked for last: shown, or on its way.
    source: SceneSource,
    on_stage: Option<Cast>,
    coming: Option<Cast>,
    /// The scene that was on the stage before, until the first picture of the present one is finished.
    before: Option<Cast>,
    ahead: Ahead,
    fading: Fading,
    /// The picture that is being drawn.
    making: Option<Making>,
    universal: UniversalInterpreters,
    /// Those that are scenes' own.
    interpreters: KeptPrograms<Interpreter>,
    tasks: HashMap<u64, Task>,
    next_id: u64,
    /// Parameters that the user moved, by name: they outlive the text that declares them.
    moved: HashMap<String, f32>,
    problem: Option<(String, String)>,
    notice: Option<(String, Instant)>,
    /// What is said of a scene that was asked for and cannot be drawn yet.
    awaited: Option<String>,
    /// The scene whose picture was finished last.
    pictured: Option<u64>,
    /// Counts the changes that make the same moment look different.
    revision: u64,
    /// The scene on the stage and its mode when they were last announced.
    announced: Option<(u64, Mode)>,
    regions: SceneRegions,
    views: Views,
    hand: OrbitControls,
    /// How far above its target the scene's own camera was in the last picture, in radians.
    own_pitch: f64,
    // Last: its threads draw with what the fields above hold.
    compiler: BackgroundCompiler,
}

impl SceneStage {
    /// Prepares the first scene, which `loader` watches.
    ///
    /// # Errors
    /// What the driver or the system refuses.
    pub(super) fn new(
        gl: &Gl,
        contexts: Vec<WorkerContext>,
        sources: Sources,
        ways: DrawingWays,
        loaders: SceneLoaders,
        first: LoadedScene,
        wake: impl Fn() + Send + Clone + 'static,
    ) -> Result<Self, GpuError> {
        let no_worker = |error: std::io::Error| GpuError::NoWorker { reason: error.to_string() };
        let LoadedScene { source, scene } = first;
        let mut regions = SceneRegions::start(ways.cells, wake.clone()).map_err(no_worker)?;
        regions.insist(ways.view.is_some());
        let compiler = BackgroundCompiler::start(contexts, sources, gl.info(), wake);
        let mut stage = Self {
            gl: gl.clone(),
            choice: ways.sdf,
            loader: loaders.shown,
            list: SceneList::around(&source),
            source: source.clone(),
            on_stage: None,
            coming: None,
            before: None,
            ahead: Ahead::with(loaders.ahead),
            fading: Fading::of(ways.fade),
            making: None,
            // Without threads it would be compiled between frames, which then come late.
            universal: UniversalInterpreters::new(!gl.info().software && compiler.has_threads()),
            interpreters: KeptPrograms::default(),
            tasks: HashMap::new(),
            next_id: 0,
            moved: HashMap::new(),
            problem: None,
            notice: None,
            awaited: None,
            pictured: None,
            revision: 0,
            announced: None,
            regions,
            views: Views::starting_with(ways.view),
            hand: OrbitControls::OFF,
            own_pitch: 0.0,
            compiler,
        };
        stage.prepare(source, scene)?;
        Ok(stage)
    }

    /// Takes in what the loader and the compilers have finished.
    ///
    /// # Errors
    /// The driver refuses what nothing else can stand in for.
    pub(super) fn update(&mut self) -> Result<(), GpuError> {
        while let Some(loaded) = self.loader.poll() {
            self.take_loaded(loaded)?;
        }
        while let Some(finished) = self.compiler.poll() {
            let Some(task) = self.tasks.remove(&finished.id) else { continue };
            let program = finished.program.and_then(|ready| Program::adopt(&self.gl, &ready));
            match (task, program) {
                (Task::Views(of), program) => self.take_views(of, program),
                (Task::Universal { steep }, program) => self.take_universal(steep, program),
                (Task::Interpreter(interpreter), Ok(program)) => {
                    tracing::info!("an interpreter is ready");
                    self.interpreters.add(interpreter, program);
                }
                (Task::Compiled(id), Ok(program)) => {
                    if let Some(cast) = self.cast_mut(id) {
                        cast.compiled = Some(Rc::new(program));
                    }
                }
                (task, Err(error)) => self.take_failure(&task, error)?,
            }
        }
        while let Some((id, tree)) = self.regions.tried_tree() {
            self.take_tree(id, tree);
        }
        self.settle_numbers();
        self.recast();
        self.prepare_for_edits();
        self.prepare_neighbours();
        self.tell_slow_compiling();
        Ok(())
    }

    fn take_loaded(&mut self, loaded: Loaded<Result<ReadyScene, SceneError>>) -> Result<(), GpuError> {
        if loaded.source != self.source {
            return Ok(());
        }
        match loaded.value {
            Ok(ready) => {
                self.problem = None;
                let name = loaded.source.title();
                let Err(error) = self.prepare(loaded.source, ready) else { return Ok(()) };
                if self.on_stage.is_none() {
                    return Err(error);
                }
                tracing::warn!("{error}");
                self.awaited = None;
                let heading = format!("{name} cannot be drawn by this driver; the last good scene stays");
                self.problem = Some((heading, error.to_string()));
                Ok(())
            }
            Err(error) => {
                let (what, text) = match &error {
                    SceneError::Mistakes { plain, .. } => ("has mistakes", plain.clone()),
                    SceneError::World(_) => ("is too complex to be drawn", error.to_string()),
                    other => ("cannot be read", other.to_string()),
                };
                let heading = format!("{} {what}; the last good scene stays", loaded.source.title());
                tracing::warn!("{error}");
                self.awaited = None;
                self.problem = Some((heading, text));
                Ok(())
            }
        }
    }

    /// Handles a program that could not be made. The scenes that need it are drawn in the other mode, if there is
    /// one.
    fn take_failure(&mut self, task: &Task, error: GpuError) -> Result<(), GpuError> {
        tracing::warn!("{error}");
        self.ahead.leave(task);
        let mut affected = Vec::new();
        for cast in [&mut self.on_stage, &mut self.coming].into_iter().flatten() {
            match task {
                Task::Compiled(id) if *id == cast.id => cast.compilable = false,
                Task::Interpreter(variant)
                    if cast.interpreted.is_none()
                        && cast.interpreter.as_ref().is_some_and(|needed| variant.covers(needed)) =>
                {
                    cast.interpreter = None;
                }
                _ => continue,
            }
            affected.push(cast.id);
        }
        for id in affected {
            self.fall_back(id, &error);
        }
        let lost = self.coming.as_ref().is_some_and(|cast| !cast.compilable && cast.interpreter.is_none());
        if lost {
            (self.coming, self.awaited) = (None, None);
        }
        if self.on_stage.is_none() && self.coming.is_none() { Err(error) } else { Ok(()) }
    }

    /// Requests the mode that is left to draw a scene, and says why.
    fn fall_back(&mut self, id: u64, error: &GpuError) {
        let Some(cast) = self.cast(id) else { return };
        let name = cast.source.title();
        let heading = match (cast.compilable, cast.interpreter.is_some()) {
            (false, true) => format!("{name} could not be compiled; it is interpreted instead"),
            (true, false) => format!("{name} could not be interpreted; it is compiled instead"),
            _ => format!("{name} cannot be drawn by this driver; the last good scene stays"),
        };
        let compilable = cast.compilable;
        if compilable {
            self.ask_for_compiled(id);
        } else {
            self.ask_for_interpreter(id);
        }
        // What was told in an earlier run needs a line only.
        if compilable && matches!(error, GpuError::GivenUp { .. }) {
            return self.tell(heading);
        }
        self.problem = Some((heading, error.to_string()));
    }

    /// Uploads a scene and requests its programs.
    fn prepare(&mut self, source: SceneSource, ready: ReadyScene) -> Result<(), GpuError> {
        let cast = self.make_cast(source, ready)?;
        self.bring(cast);
        Ok(())
    }

    /// Requests what a scene needs to come onto the stage.
    fn bring(&mut self, cast: Cast) {
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
            SdfChoice::Auto => (!fits || cast.is_compiled_by_itself(), !self.is_patient_with(cast)),
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
    fn make_cast(&mut self, source: SceneSource, ready: ReadyScene) -> Result<Cast, GpuError> {
        let fits = Interpreter::fits(&ready.buffers, &ready.plan, self.gl.info());
        if let Err(error) = fits {
            tracing::warn!("{error}");
        }
        let interpreter = fits
            .is_ok()
            .then(|| Interpreter::for_scene(ready.world.traits, &ready.buffers, &ready.plan, self.gl.info()));
        let params = ready.world.scene.params.iter().filter(|param| !param.is_number);
        let sliders = params.map(|param| Slider {
            name: param.name.clone(),
            value: param.default,
            min: param.min,
            max: param.max,
            default: param.default,
        });
        let sliders = sliders.collect();
        let graph = &ready.world.scene.graph;
        let (moves, hears_curves) = (graph.moves_by_itself(), graph.reads_curves());
        let id = self.fresh_id();
        let compiled = self.inherited_program(id, &ready.world);
        let last = self.on_stage.as_ref().map(|cast| &cast.resources);
        let resources = SceneResources::upload_after(last, &self.gl, ready.world, ready.buffers, ready.plan)?;
        Ok(Cast {
            id,
            source,
            resources,
            interpreter,
            interpreted: None,
            compiled,
            tree: FirstTree::Coming,
            compilable: true,
            moves,
            hears_curves,
            sliders,
            since: Instant::now(),
            settles: ready.settles,
            is_resting: false,
        })
    }

    /// Whether `auto` waits for a scene's own program.
    fn is_patient_with(&self, cast: &Cast) -> bool {
        let long = cast.resources.buffers().cost.distance > SHOWN_AT_ONCE_BY_SOFTWARE_MAX;
        self.gl.info().software && long && cast.is_compiled_by_itself()
    }

    /// Drops requests for scenes that will not be shown. A program that is being made already is dropped when it
    /// comes.
    fn forget_obsolete(&mut self) {
        let kept: Vec<u64> = self.casts().map(|cast| cast.id).collect();
        self.tasks.retain(|_, task| match task {
            Task::Compiled(id) | Task::Views(ViewsOf::Compiled(id)) => kept.contains(id),
            Task::Interpreter(_) | Task::Universal { .. } | Task::Views(_) => true,
        });
        self.views.keep(|id| kept.contains(&id));
        self.compiler.forget(|id| !self.tasks.contains_key(&id));
    }

    fn ask_for_compiled(&mut self, id: u64) {
        let asked = self.in_the_making(id, Mode::Compiled);
        let Some(cast) = self.cast_mut(id).filter(|cast| !asked && cast.compiled.is_none()) else { return };
        cast.compilable = true;
        let Some(cast) = self.cast(id) else { return };
        let world = cast.resources.world().clone();
        let job = self.job(cast, move || compiled_variant_of(&world, Counting::Off));
        tracing::info!("{} is requested, compiled", cast.source.title());
        self.submit(job, Task::Compiled(id));
    }

    fn ask_for_interpreter(&mut self, id: u64) {
        let Some(cast) = self.cast(id) else { return };
        let Some(needed) = cast.interpreter.clone() else { return };
        // The first picture does not wait for it, because a scene's own interpreter is compiled sooner.
        let can_wait = self.pictured.is_some() || self.in_the_making(id, Mode::Compiled);
        if self.universal.find(&needed).is_some() {
            return;
        }
        if self.universal.serve(&needed) && can_wait {
            return self.ask_for_universal(needed.is_steep(), id);
        }
        let mut asked = self.tasks.values().filter_map(|task| match task {
            Task::Interpreter(asked) => Some(asked),
            _ => None,
        });
        let covers = |known: &Interpreter| known.covers(&needed);
        if self.interpreters.has(covers) || asked.any(covers) {
            return;
        }
        let variant = needed.clone();
        let mut job = self.job(cast, move || Ok(variant.variant(Counting::Off)));
        job.can_be_given_up = true;
        tracing::info!("{} is requested, interpreted", cast.source.title());
        self.submit(job, Task::Interpreter(needed));
    }

    fn job(
        &self,
        cast: &Cast,
        variant: impl FnOnce() -> Result<crate::gpu::shader_source::Variant, GpuError> + Send + 'static,
    ) -> ProgramJob {
        let world = cast.resources.world();
        let frame = Frame::new(world, 0.0, mariana_music::Features::SILENCE, (16, 16));
        ProgramJob {
            id: self.next_id,
            variant: Box::new(variant),
            block: frame.block(world, &RegionTree::default()),
            picture: frame.picture,
            scene: SceneShape::of(world),
            draws_views: false,
            can_be_given_up: false,
        }
    }

    fn submit(&mut self, job: ProgramJob, task: Task) {
        let id = self.fresh_id();
        debug_assert_eq!(id, job.id);
        self.tasks.insert(id, task);
        self.compiler.submit(job);
    }

    fn fresh_id(&mut self) -> u64 {
        self.next_id += 1;
        self.next_id - 1
    }

    fn cast(&self, id: u64) -> Option<&Cast> {
        let staged = [&self.on_stage, &self.coming].into_iter().flatten();
        staged.chain(self.ahead.casts()).find(|cast| cast.id == id)
    }

    fn cast_mut(&mut self, id: u64) -> Option<&mut Cast> {
        let staged = [&mut self.on_stage, &mut self.coming].into_iter().flatten();
        staged.chain(self.ahead.casts_mut()).find(|cast| cast.id == id)
    }

    /// Every scene that is there.
    fn casts(&self) -> impl Iterator<Item = &Cast> {
        [&self.on_stage, &self.coming, &self.before].into_iter().flatten().chain(self.ahead.casts())
    }

    /// Gives the scenes their interpreter, and brings the coming scene onto the stage as soon as it can be drawn in a
    /// mode that was asked for.
    fn recast(&mut self) {
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
            has_program && cast.tree != FirstTree::Coming
        });
        if can_be_drawn {
            let replaced = std::mem::replace(&mut self.on_stage, self.coming.take());
            let name = |cast: &Option<Cast>| cast.as_ref().map(|cast| cast.source.title());
            let is_another = replaced.is_some() && name(&replaced) != name(&self.on_stage);
            // There is no point in coming back to a scene that has shown nothing.
            if self.pictured == replaced.as_ref().map(|cast| cast.id) {
                self.before = replaced;
            }
            self.forget_obsolete();
            // The sliders may have been moved since the scene was asked for.
            for slider in self.on_stage.iter_mut().flat_map(|cast| &mut cast.sliders) {
                let value = self.moved.get(&slider.name).copied().unwrap_or(slider.default);
                slider.value = value.clamp(slider.min, slider.max);
            }
            self.awaited = None;
            if is_another {
                self.fade_if_it_can();
                self.tell(self.name().unwrap_or_default());
                self.hand = OrbitControls::OFF;
            }
        }
        self.ask_for_view();
        let now = self.on_stage.as_ref().map(|cast| cast.id).zip(self.mode());
        if now == before {
            return;
        }
        self.announced = now;
        self.revision += 1;
        let Some((name, (id, mode))) = self.name().zip(now) else { return };
        tracing::info!("{name} is shown, {mode}");
        if before.is_some_and(|(known, _)| known == id) {
            self.tell(mode.to_string());
        }
    }

    /// Shows a line for a moment.
    fn tell(&mut self, text: String) {
        self.notice = Some((text, Instant::now()));
    }

    /// The mode of the scene on the stage; none before there is one.
    pub(super) fn mode(&self) -> Option<Mode> {
        let cast = self.on_stage.as_ref()?;
        let order = match self.choice {
            SdfChoice::Interpreted => [Mode::Interpreted, Mode::Compiled],
            SdfChoice::Compiled | SdfChoice::Auto => [Mode::Compiled, Mode::Interpreted],
        };
        order.into_iter().find(|mode| cast.program(*mode).is_some())
    }

    /// Whether a scene's program of that mode was requested and has not come.
    fn in_the_making(&self, id: u64, mode: Mode) -> bool {
        let needed = self.cast(id).and_then(|cast| cast.interpreter.as_ref());
        self.tasks.values().any(|task| match task {
            Task::Compiled(asked) => mode == Mode::Compiled && *asked == id,
            Task::Interpreter(asked) => {
                mode == Mode::Interpreted && needed.is_some_and(|needed| asked.covers(needed))
            }
            Task::Universal { .. } => {
                mode == Mode::Interpreted && needed.is_some_and(|needed| self.universal.are_coming(needed))
            }
            Task::Views(_) => false,
        })
    }

    /// Whether the regions of a requested picture have come.
    pub(super) fn has_regions(&self) -> bool {
        self.regions.have_come()
    }

    /// Takes note of how long a frame took.
    pub(super) fn note_frame_time(&mut self, time: Duration) {
        let Some((cast, mode)) = self.on_stage.as_ref().zip(self.mode()) else { return };
        let built = cast.resources.regions();
        // Views are drawn by other programs.
        if self.view().is_some() {
            return;
        }
        if built.is_some_and(|built| self.regions.note_frame_time((cast.id, mode), &built, time)) {
            self.revision += 1;
        }
    }

    /// Whether there is something to draw.
    pub(super) fn is_ready(&self) -> bool {
        self.on_stage.is_some()
    }

    /// A number that changes whenever the same moment would look different.
    pub(super) fn revision(&self) -> u64 {
        self.revision
    }

    /// Whether the scene on the stage reads curves of the sound.
    pub(super) fn hears_curves(&self) -> bool {
        self.on_stage.as_ref().is_none_or(|cast| cast.hears_curves)
    }

    /// Whether the scene on the stage also moves without sound.
    pub(super) fn moves_by_itself(&self) -> bool {
        self.on_stage.as_ref().is_none_or(|cast| cast.moves)
    }
}

impl Cast {
    /// Whether `auto` compiles it.
    fn is_compiled_by_itself(&self) -> bool {
        self.resources.buffers().cost.total <= COMPILED_BY_ITSELF_MAX
    }

    fn program(&self, mode: Mode) -> Option<&Rc<Program>> {
        match mode {
            Mode::Interpreted => self.interpreted.as_ref(),
            Mode::Compiled => self.compiled.as_ref(),
        }
    }
}
