//! A scene with its resources and the programs that can draw it.

use std::rc::Rc;
use std::sync::Arc;
use std::time::Instant;

use super::knobs::{Knob, SceneKnobs};
use super::program_task::ProgramOf;
use crate::clock;
use crate::config::SdfChoice;
use crate::gpu::scene_program::COMPILED_BY_ITSELF_MAX;
use crate::gpu::{CellUse, Gl, GpuError, Interpreter, Mode, Program, SceneResources};
use crate::scenes::{ReadyScene, SceneSource, TextureSource};
use crate::song_shapes;
use mariana_control::Slider;
use mariana_field::graph::Op;

#[derive(Debug, Clone, Copy)]
pub(crate) struct DrawingChoice {
    pub sdf: SdfChoice,
    pub cells: CellUse,
}

/// A scene that needs nothing but the driver.
pub(crate) struct LoadedScene {
    pub source: SceneSource,
    pub scene: ReadyScene,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FirstTree {
    Coming,
    /// The tree is built together with the first frame, because the tree of the previous version was fast.
    Untried,
    There,
    /// Building the tree takes longer than a frame may take.
    TooLong,
}

#[derive(Default)]
pub(super) struct ScenePrograms {
    /// `None` if the tape exceeds the driver's limits or the driver rejected the program.
    pub interpreter: Option<Interpreter>,
    pub interpreted: Option<Rc<Program>>,
    pub compiled: Option<Rc<Program>>,
    /// True if the compiled program can look up the cells of a tree.
    pub has_cells: bool,
    /// False if a compile has failed.
    pub compilable: bool,
}

pub(crate) struct PreparedScene {
    /// Unique number; each version of the text has its own.
    pub id: u64,
    pub source: SceneSource,
    pub resources: SceneResources,
    pub(super) programs: ScenePrograms,
    pub(super) tree: FirstTree,
    pub moves: bool,
    pub hears_curves: bool,
    /// True if the scene reads parts of the song.
    pub hears_parts: bool,
    pub shows_cover: bool,
    /// True if the scene shows texts of the song.
    pub has_song_texts: bool,
    pub(super) knobs: SceneKnobs,
    pub since: Instant,
    /// True if this version only turns the numbers of the shown scene back into constants.
    pub settles: bool,
    /// True if the scene was reloaded because its numbers no longer change.
    pub is_resting: bool,
    /// The first warning about the text, for a message when the scene is shown.
    pub warning: Option<String>,
}

impl ScenePrograms {
    pub(super) fn without_interpreter(&mut self) {
        (self.interpreter, self.interpreted) = (None, None);
    }

    /// True if the scene is waiting for an interpreter that `interpreter` covers.
    pub(super) fn lack(&self, interpreter: &Interpreter) -> bool {
        self.interpreted.is_none()
            && self.interpreter.as_ref().is_some_and(|needed| interpreter.covers(needed))
    }
}

impl PreparedScene {
    /// Uploads a scene, without programs. Images that `last` also has are reused.
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
        let (moves, hears_curves, hears_parts) =
            (graph.moves_by_itself(), graph.reads(&Op::CURVES), graph.reads(&Op::PARTS));
        let is_cover = |(_, source): &(usize, TextureSource)| *source == TextureSource::Cover;
        let has_song_texts = song_shapes::are_shown_by(&ready.world);
        let (covers, moving): (Vec<_>, Vec<_>) = TextureSource::of_world(&ready.world).partition(is_cover);
        let resources = SceneResources::upload(gl, last, ready.world, ready.buffers, ready.plan)?;
        Ok(Self {
            id,
            source,
            resources,
            programs: ScenePrograms { interpreter, compilable: true, ..ScenePrograms::default() },
            tree: FirstTree::Coming,
            moves: moves || has_song_texts || !moving.is_empty(),
            has_song_texts,
            hears_curves,
            hears_parts,
            shows_cover: !covers.is_empty(),
            knobs,
            since: clock::now(),
            settles: ready.settles,
            is_resting: false,
            warning: None,
        })
    }

    pub(super) fn into_loaded(self) -> LoadedScene {
        let resources = &self.resources;
        let scene = ReadyScene {
            world: resources.world().clone(),
            buffers: resources.buffers().clone(),
            plan: resources.plan().clone(),
            settles: false,
            warnings: Arc::default(),
        };
        LoadedScene { source: self.source, scene }
    }

    pub(super) fn title(&self) -> String {
        self.source.title()
    }

    pub(super) fn program(&self, mode: Mode) -> Option<&Rc<Program>> {
        match mode {
            Mode::Interpreted => self.programs.interpreted.as_ref(),
            Mode::Compiled => self.programs.compiled.as_ref(),
        }
    }

    /// The mode in which the scene is drawn now; `None` if there is no program.
    pub(super) fn mode(&self, sdf: SdfChoice) -> Option<Mode> {
        let order = match sdf {
            SdfChoice::Interpreted => [Mode::Interpreted, Mode::Compiled],
            SdfChoice::Compiled | SdfChoice::Auto => [Mode::Compiled, Mode::Interpreted],
        };
        order.into_iter().find(|mode| self.program(*mode).is_some())
    }

    /// The mode in which the scene should finally be shown, if the program for this mode is missing.
    pub(super) fn missing_mode(&self, sdf: SdfChoice) -> Option<Mode> {
        Some(self.wanted_mode(sdf)).filter(|mode| self.program(*mode).is_none())
    }

    /// The mode in which the scene should finally be shown.
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

    pub(super) fn is_compiled_by_itself(&self) -> bool {
        self.resources.buffers().cost.compiled <= COMPILED_BY_ITSELF_MAX
    }

    /// The functions that draw the scene in a mode.
    pub(super) fn program_of(&self, mode: Mode) -> Option<ProgramOf> {
        match mode {
            Mode::Compiled => Some(ProgramOf::Compiled(self.id)),
            Mode::Interpreted => self.programs.interpreter.clone().map(ProgramOf::Interpreted),
        }
    }

    /// True if numbers in the scene's text are program inputs instead of constants.
    pub(super) fn is_changing(&self) -> bool {
        let world = self.resources.world();
        // The fraction of a blend is an input too, but not a number in a text.
        world.blended.is_none() && world.scene.params.iter().any(|param| param.is_number)
    }

    /// In a blend, the number of parameters of the outgoing scene; otherwise `usize::MAX`.
    pub(super) fn split(&self) -> usize {
        self.resources.world().blended.unwrap_or(usize::MAX)
    }

    /// The sliders of the scene; in a blend, of the incoming scene.
    pub(super) fn own_knobs(&self) -> impl Iterator<Item = (&Slider, &Knob)> {
        let begin = self.resources.world().blended.unwrap_or(0);
        self.knobs.iter().filter(move |(_, knob)| knob.place >= begin)
    }

    pub(super) fn is_blend(&self) -> bool {
        matches!(self.source, SceneSource::Blend(_))
    }

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
