//! A scene with its resources and the programs that can draw it.

use std::rc::Rc;
use std::time::Instant;

use super::knobs::SceneKnobs;
use super::program_task::ViewsOf;
use crate::clock;
use crate::config::SdfChoice;
use crate::gpu::cell_use::CellUse;
use crate::gpu::error::GpuError;
use crate::gpu::gl::Gl;
use crate::gpu::program::Program;
use crate::gpu::scene_program::{COMPILED_BY_ITSELF_MAX, Interpreter, Mode};
use crate::gpu::scene_resources::SceneResources;
use crate::scenes::{ReadyScene, SceneSource};

/// How all scenes are drawn.
#[derive(Debug, Clone, Copy)]
pub(super) struct DrawingChoice {
    /// Interpreted, compiled or both.
    pub sdf: SdfChoice,
    /// Whether cells of regions are used where they can be.
    pub cells: CellUse,
}

/// The first tree of regions of a scene that is coming.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FirstTree {
    /// It is being built.
    Coming,
    /// It is built with the first picture, because that of the last version of the text took no time.
    Untried,
    /// It is there.
    There,
    /// It takes longer than anyone waits for a picture.
    TooLong,
}

/// The programs of a scene.
pub(super) struct ScenePrograms {
    /// The variant of the interpreter that it needs; none if its tape does not fit the driver, or the driver refused
    /// it.
    pub interpreter: Option<Interpreter>,
    /// The interpreter, once it is there.
    pub interpreted: Option<Rc<Program>>,
    /// The scene's own program, once it is there.
    pub compiled: Option<Rc<Program>>,
    /// Whether that one can look up the cells of a tree.
    pub has_cells: bool,
    /// Whether no compiler has refused it so far.
    pub compilable: bool,
}

/// See the module.
pub(super) struct PreparedScene {
    /// Its number: another one for each version of its text.
    pub id: u64,
    /// Where it comes from.
    pub source: SceneSource,
    /// What the driver holds of it.
    pub resources: SceneResources,
    /// What draws it.
    pub programs: ScenePrograms,
    /// Its first tree of regions.
    pub tree: FirstTree,
    /// Whether it also moves without sound.
    pub moves: bool,
    /// Whether it reads curves of the sound.
    pub hears_curves: bool,
    /// Its sliders.
    pub knobs: SceneKnobs,
    /// When it was loaded.
    pub since: Instant,
    /// Whether it is the scene that shows with its numbers as constants again.
    pub settles: bool,
    /// Whether it was asked for again, because its numbers are no longer changed.
    pub is_resting: bool,
}

impl ScenePrograms {
    /// The one that draws it in a mode.
    pub(super) fn of(&self, mode: Mode) -> Option<&Rc<Program>> {
        match mode {
            Mode::Interpreted => self.interpreted.as_ref(),
            Mode::Compiled => self.compiled.as_ref(),
        }
    }

    /// From now on only its own program draws it.
    pub(super) fn without_interpreter(&mut self) {
        (self.interpreter, self.interpreted) = (None, None);
    }

    /// Whether it waits for an interpreter like this one.
    pub(super) fn lack(&self, interpreter: &Interpreter) -> bool {
        self.interpreted.is_none()
            && self.interpreter.as_ref().is_some_and(|needed| interpreter.covers(needed))
    }
}

impl PreparedScene {
    /// Uploads a scene, which has no programs yet. Pictures that `last` has, too, are not uploaded again.
    ///
    /// # Errors
    /// What the driver refuses.
    pub(super) fn upload(
        gl: &Gl,
        id: u64,
        source: SceneSource,
        ready: ReadyScene,
        last: Option<&SceneResources>,
    ) -> Result<Self, GpuError> {
        let fits = Interpreter::fits(&ready.buffers, &ready.plan, gl.info());
        if let Err(error) = fits {
            tracing::warn!("{error}");
        }
        let interpreter = fits
            .is_ok()
            .then(|| Interpreter::for_scene(ready.world.features, &ready.buffers, &ready.plan, gl.info()));
        let knobs = SceneKnobs::of(&source, &ready.world);
        let graph = &ready.world.scene.graph;
        let (moves, hears_curves) = (graph.moves_by_itself(), graph.reads_curves());
        let resources = SceneResources::upload_after(last, gl, ready.world, ready.buffers, ready.plan)?;
        Ok(Self {
            id,
            source,
            resources,
            programs: ScenePrograms {
                interpreter,
                interpreted: None,
                compiled: None,
                has_cells: false,
                compilable: true,
            },
            tree: FirstTree::Coming,
            moves,
            hears_curves,
            knobs,
            since: clock::now(),
            settles: ready.settles,
            is_resting: false,
        })
    }

    /// What another context can prepare it from.
    pub(super) fn into_ready(self) -> (SceneSource, ReadyScene) {
        let resources = &self.resources;
        let (world, buffers) = (resources.world().clone(), resources.buffers().clone());
        let ready = ReadyScene { world, buffers, plan: resources.plan().clone(), settles: false };
        (self.source, ready)
    }

    /// What people call it.
    pub(super) fn title(&self) -> String {
        self.source.title()
    }

    /// The program that draws it in a mode.
    pub(super) fn program(&self, mode: Mode) -> Option<&Rc<Program>> {
        self.programs.of(mode)
    }

    /// The mode in which it is drawn; none if no program can draw it.
    pub(super) fn mode(&self, sdf: SdfChoice) -> Option<Mode> {
        let order = match sdf {
            SdfChoice::Interpreted => [Mode::Interpreted, Mode::Compiled],
            SdfChoice::Compiled | SdfChoice::Auto => [Mode::Compiled, Mode::Interpreted],
        };
        order.into_iter().find(|mode| self.program(*mode).is_some())
    }

    /// The mode in which it is to be shown in the end, if the program for that is not there.
    pub(super) fn missing_mode(&self, sdf: SdfChoice) -> Option<Mode> {
        Some(self.wanted_mode(sdf)).filter(|mode| self.program(*mode).is_none())
    }

    /// The mode in which it is to be shown in the end.
    pub(super) fn wanted_mode(&self, sdf: SdfChoice) -> Mode {
        let compiles = match sdf {
            SdfChoice::Interpreted => false,
            SdfChoice::Compiled => true,
            SdfChoice::Auto => self.is_compiled_by_itself(),
        };
        if self.programs.interpreter.is_none() || (compiles && self.programs.compilable) {
            Mode::Compiled
        } else {
            Mode::Interpreted
        }
    }

    /// Whether `auto` compiles it.
    pub(super) fn is_compiled_by_itself(&self) -> bool {
        self.resources.buffers().cost.total <= COMPILED_BY_ITSELF_MAX
    }

    /// What a program must draw to show views of it.
    pub(super) fn views(&self, mode: Mode) -> Option<ViewsOf> {
        match mode {
            Mode::Compiled => Some(ViewsOf::Compiled(self.id)),
            Mode::Interpreted => self.programs.interpreter.clone().map(ViewsOf::Interpreted),
        }
    }

    /// Whether numbers of its text are read as inputs.
    pub(super) fn is_changing(&self) -> bool {
        let world = self.resources.world();
        // The share of a blend is no number of a text.
        world.blended.is_none() && world.scene.params.iter().any(|param| param.is_number)
    }

    /// In a blend, how many of its parameters belong to the scene that goes; else more than there are.
    pub(super) fn split(&self) -> usize {
        self.resources.world().blended.unwrap_or(usize::MAX)
    }

    /// Whether it is a scene on its way into another.
    pub(super) fn is_blend(&self) -> bool {
        matches!(self.source, SceneSource::Blend(_))
    }

    /// Why its pixels are so expensive.
    pub(super) fn costs_in_words(&self) -> String {
        let world = self.resources.world();
        let mut what = vec![format!("its distance has {} clauses", self.resources.buffers().cost.distance)];
        if world.non_lipschitz {
            what.push("its formula is not a distance, so rays take small steps".to_owned());
        }
        if world.scene.lights.len() > 1 {
            what.push(format!("it has {} lights", world.scene.lights.len()));
        }
        if world.features.mirrors {
            what.push("it has mirrors".to_owned());
        }
        what.join(", ")
    }
}
