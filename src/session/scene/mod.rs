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
mod awaited_edit;
mod casting;
mod changed_numbers;
mod context_change;
mod directed;
mod drawing;
pub(crate) mod edits;
mod fading;
mod hands;
mod kept;
mod mixing;
mod performed;
mod preview;
mod quiet;
mod region_builder;
mod regions;
mod requests;
mod scenery;
#[cfg(test)]
mod tests;
mod told;
mod turning;
mod universal;
mod views;
mod wishes;

use std::collections::HashMap;
use std::rc::Rc;
use std::time::{Duration, Instant};

use ahead::Ahead;
use awaited_edit::AwaitedEdit;
pub(crate) use context_change::{DrawingWays, LoadedScene, SceneLoaders};
use directed::Directed;
use drawing::Making;
pub(crate) use drawing::{Drawn, WantedPicture};
use edits::Edits;
use fading::Fading;
use hands::{Hands, Knob};
use kept::KeptPrograms;
use mixing::Mixing;
pub(crate) use performed::Performed;
use preview::Sketching;
use quiet::Quiet;
use regions::SceneRegions;
pub(crate) use regions::Shown;
use scenery::Pictured;
pub(crate) use scenery::Scenery;
pub(crate) use told::SceneWords;
use turning::TurnedNumbers;
use universal::UniversalInterpreters;
use views::{Views, ViewsOf};

use crate::config::SdfChoice;
use crate::frame::Frame;
use crate::frame::orbit_controls::OrbitControls;
use crate::frame::picture::Picture;
use crate::gpu::background::{BackgroundCompiler, Sources, WorkerContext};
use crate::gpu::error::GpuError;
use crate::gpu::gl::Gl;
use crate::gpu::program::Program;
use crate::gpu::scene_program::{COMPILED_BY_ITSELF_MAX, Interpreter, Mode};
use crate::gpu::scene_resources::SceneResources;
use crate::scenes::{Loaded, Loader, ReadyScene, SceneError, SceneList, SceneSource};
use mariana_control::{Model, Slider};
use mariana_music::Features;

/// What the loader gives.
pub(crate) type SceneLoader = Loader<Result<ReadyScene, SceneError>>;

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
    /// Whether that one can look up the cells of a tree.
    has_cells: bool,
    tree: FirstTree,
    /// Whether no compiler has refused it so far.
    compilable: bool,
    /// Whether it also moves without sound.
    moves: bool,
    /// Whether it reads curves of the sound.
    hears_curves: bool,
    sliders: Vec<Slider>,
    /// What each of them turns.
    knobs: Vec<Knob>,
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
    /// It is built with the first picture, because that of the last version of the text took no time.
    Untried,
    /// It is there.
    There,
    /// It takes longer than anyone waits for a picture.
    TooLong,
}

/// The purpose of a program that is being made.
enum Task {
    Compiled {
        /// The scene.
        id: u64,
        /// Whether it is to look up the cells of a tree.
        has_cells: bool,
    },
    Interpreter(Interpreter),
    Universal {
        /// Whether it is for formulas that are no distances.
        steep: bool,
    },
    Views(ViewsOf),
}

/// The scene on the stage, and the one behind it.
pub(crate) struct SceneStage {
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
    directed: Directed,
    fading: Fading,
    mixing: Mixing,
    sketching: Sketching,
    edits: Edits,
    awaited_edit: AwaitedEdit,
    /// The picture that is being drawn.
    making: Option<Making>,
    universal: UniversalInterpreters,
    /// Those that are scenes' own.
    interpreters: KeptPrograms<Interpreter>,
    tasks: HashMap<u64, Task>,
    next_id: u64,
    hands: Hands,
    problem: Option<(String, String)>,
    notice: Option<(String, Instant)>,
    /// The hint about a scene that the user asked for, until it is there.
    awaited: Option<String>,
    quiet: Quiet,
    /// The mode that the user asked for, until its program is there.
    asked_mode: Option<Mode>,
    /// Whether somebody writes its text, so that mistakes come and go.
    is_written: bool,
    /// The numbers of a text that a hand turns.
    turned: Option<TurnedNumbers>,
    /// The picture that was begun last, and the one that shows.
    begun_picture: Option<Pictured>,
    seen_picture: Option<Pictured>,
    pictures_seen: u64,
    /// The scene whose picture was finished last.
    pictured: Option<u64>,
    /// How long that took, and the one before it.
    pictures_took: [Duration; 2],
    /// Counts the changes that make the same moment look different.
    revision: u64,
    /// The scene on the stage and its mode when they were last announced.
    announced: Option<(u64, Mode)>,
    regions: SceneRegions,
    views: Views,
    hand: OrbitControls,
    /// How the camera was moved in the last picture.
    shown_hand: OrbitControls,
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
    pub(crate) fn new(
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
            directed: Directed::default(),
            fading: Fading::of(ways.fade),
            mixing: Mixing::default(),
            sketching: Sketching::default(),
            edits: Edits::default(),
            awaited_edit: AwaitedEdit::default(),
            making: None,
            // Without threads it would be compiled between frames, which then come late.
            universal: UniversalInterpreters::new(!gl.info().software && compiler.has_threads()),
            interpreters: KeptPrograms::default(),
            tasks: HashMap::new(),
            next_id: 0,
            hands: Hands::new(Model::default(), Instant::now()),
            problem: None,
            notice: None,
            awaited: None,
            quiet: Quiet::default(),
            asked_mode: None,
            is_written: false,
            turned: None,
            begun_picture: None,
            seen_picture: None,
            pictures_seen: 0,
            pictured: None,
            pictures_took: [Duration::ZERO; 2],
            revision: 0,
            announced: None,
            regions,
            views: Views::starting_with(ways.view),
            hand: OrbitControls::OFF,
            shown_hand: OrbitControls::OFF,
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
    pub(crate) fn update(&mut self) -> Result<(), GpuError> {
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
                (Task::Compiled { id, has_cells }, Ok(program)) => {
                    if let Some(cast) = self.cast_mut(id) {
                        cast.compiled = Some(Rc::new(program));
                        cast.has_cells = has_cells;
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
        self.awaited_edit.note_loaded(loaded.took);
        match loaded.value {
            Ok(ready) => {
                self.problem = None;
                let (source, name) = (loaded.source.clone(), loaded.source.title());
                let Err(error) = self.prepare(loaded.source, ready) else { return Ok(()) };
                if self.on_stage.is_none() {
                    return Err(error);
                }
                tracing::warn!("{error}");
                let heading = format!("{name} cannot be drawn by this driver; the last good scene stays");
                self.refuse(source, heading, error.to_string());
                Ok(())
            }
            Err(error) => {
                let (what, text) = match &error {
                    SceneError::Mistakes { plain, .. } => ("has mistakes", plain.clone()),
                    SceneError::World(_) => ("is too complex to be drawn", error.to_string()),
                    other => ("cannot be read", other.to_string()),
                };
                let heading = format!("{} {what}; the last good scene stays", loaded.source.title());
                match self.is_written {
                    true => tracing::debug!("{error}"),
                    false => tracing::warn!("{error}"),
                }
                self.refuse(loaded.source, heading, text);
                Ok(())
            }
        }
    }

    fn fresh_id(&mut self) -> u64 {
        self.next_id += 1;
        self.next_id - 1
    }

    fn cast(&self, id: u64) -> Option<&Cast> {
        let staged = [&self.on_stage, &self.coming].into_iter().flatten();
        staged.chain(self.mixing.cast()).chain(self.ahead.casts()).find(|cast| cast.id == id)
    }

    fn cast_mut(&mut self, id: u64) -> Option<&mut Cast> {
        let staged = [&mut self.on_stage, &mut self.coming].into_iter().flatten();
        staged.chain(self.mixing.cast_mut()).chain(self.ahead.casts_mut()).find(|cast| cast.id == id)
    }

    /// Every scene that is there.
    fn casts(&self) -> impl Iterator<Item = &Cast> {
        let staged = [&self.on_stage, &self.coming, &self.before].into_iter().flatten();
        staged.chain(self.mixing.cast()).chain(self.ahead.casts())
    }

    /// Shows a line for a moment.
    fn tell(&mut self, text: String) {
        tracing::debug!("told: {text}");
        self.notice = Some((text, Instant::now()));
    }

    /// The mode of the scene on the stage; none before there is one.
    pub(crate) fn mode(&self) -> Option<Mode> {
        self.mode_of(self.on_stage.as_ref()?)
    }

    /// The mode in which a scene is drawn; none if no program can draw it.
    fn mode_of(&self, cast: &Cast) -> Option<Mode> {
        let order = match self.choice {
            SdfChoice::Interpreted => [Mode::Interpreted, Mode::Compiled],
            SdfChoice::Compiled | SdfChoice::Auto => [Mode::Compiled, Mode::Interpreted],
        };
        order.into_iter().find(|mode| cast.program(*mode).is_some())
    }

    /// Whether the scene on the stage is being edited and drawn with fewer samples meanwhile.
    pub(crate) fn saves_samples(&self, now: Instant) -> bool {
        self.edits.save_samples(self.mode(), now)
    }

    /// Whether the regions of a requested picture have come.
    pub(crate) fn has_regions(&self) -> bool {
        self.regions.have_come()
    }

    /// Takes note of how long a frame took.
    pub(crate) fn note_frame_time(&mut self, time: Duration) {
        let Some((cast, mode)) = self.on_stage.as_ref().zip(self.mode()) else { return };
        let built = cast.resources.regions();
        // Views are drawn by other programs, and during a fade two scenes are drawn.
        if self.view().is_some() || self.mixing.cast().is_some() {
            return;
        }
        if built.is_some_and(|built| self.regions.note_frame_time((cast.id, mode), &built, time)) {
            self.revision += 1;
        }
    }

    /// Whether there is something to draw.
    pub(crate) fn is_ready(&self) -> bool {
        self.on_stage.is_some()
    }

    /// How pictures of the scene are made that is coming; none if there is none.
    pub(crate) fn coming_picture(&self) -> Option<Picture> {
        let world = self.coming.as_ref()?.resources.world();
        Some(Frame::new(world, 0.0, Features::SILENCE, (16, 16)).picture)
    }

    /// Notes that the same moment would look different.
    pub(crate) fn look_different(&mut self) {
        self.revision += 1;
    }

    /// A number that changes whenever the same moment would look different.
    pub(crate) fn revision(&self) -> u64 {
        self.revision
    }

    /// Whether what is drawn reads curves of the sound.
    pub(crate) fn hears_curves(&self) -> bool {
        let drawn = [self.on_stage.as_ref(), self.before.as_ref(), self.mixing.cast()];
        self.on_stage.is_none() || drawn.into_iter().flatten().any(|cast| cast.hears_curves)
    }

    /// Whether the scene on the stage also moves without sound.
    pub(crate) fn moves_by_itself(&self) -> bool {
        self.is_moved_by_the_show()
            || self.fading.follows_song()
            || self.on_stage.as_ref().is_none_or(|cast| cast.moves)
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
