//! Programs that are requested for scenes, and what happens if a driver cannot make one.

use super::views::ViewsOf;
use super::{Cast, SceneStage, Task};
use crate::config::SdfChoice;
use crate::frame::Frame;
use crate::frame::block::RegionTree;
use crate::gpu::background::ProgramJob;
use crate::gpu::error::GpuError;
use crate::gpu::renderer::Counting;
use crate::gpu::scene_program::{Interpreter, Mode, compiled_drawing_variant};
use crate::gpu::shader_source::Variant;
use crate::gpu::stand_ins::SceneShape;

impl SceneStage {
    /// Handles a program that could not be made. The scenes that need it are drawn in the other mode, if there is
    /// one.
    pub(super) fn take_failure(&mut self, task: &Task, error: GpuError) -> Result<(), GpuError> {
        tracing::warn!("{error}");
        self.ahead.leave(task);
        let mut affected = Vec::new();
        for cast in [&mut self.on_stage, &mut self.coming].into_iter().flatten() {
            match task {
                Task::Compiled { id, .. } if *id == cast.id => {
                    cast.compilable = false;
                    if cast.compiled.is_some() {
                        // It is drawn by the program that it has.
                        continue;
                    }
                }
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
    pub(super) fn fall_back(&mut self, id: u64, error: &GpuError) {
        let Some(cast) = self.cast(id) else { return };
        let (name, source) = (cast.source.title(), cast.source.clone());
        let heading = match (cast.compilable, cast.interpreter.is_some()) {
            (false, true) => format!("{name} could not be compiled; it is interpreted instead"),
            (true, false) => format!("{name} could not be interpreted; it is compiled instead"),
            _ => format!("{name} cannot be drawn by this driver; the last good scene stays"),
        };
        let (compilable, can_be_drawn) = (cast.compilable, cast.compilable || cast.interpreter.is_some());
        if compilable {
            self.ask_for_compiled(id);
        } else {
            self.ask_for_interpreter(id);
        }
        // What was told in an earlier run needs a line only.
        if compilable && matches!(error, GpuError::GivenUp { .. }) {
            return self.tell(heading);
        }
        let is_technical = self.choice == SdfChoice::Auto && source.file().is_none();
        match can_be_drawn {
            true if is_technical => self.quiet.note(heading, None),
            true => self.problem = Some((heading, error.to_string())),
            false => self.refuse(source, heading, error.to_string()),
        }
    }

    /// Drops requests for scenes that will not be shown. A program that is being made already is dropped when it
    /// comes.
    pub(super) fn forget_obsolete(&mut self) {
        let kept: Vec<u64> = self.casts().map(|cast| cast.id).collect();
        self.tasks.retain(|_, task| match task {
            Task::Compiled { id, .. } | Task::Views(ViewsOf::Compiled(id)) => kept.contains(id),
            Task::Interpreter(_) | Task::Universal { .. } | Task::Views(_) => true,
        });
        self.views.keep(|id| kept.contains(&id));
        self.compiler.forget(|id| !self.tasks.contains_key(&id));
    }

    pub(super) fn ask_for_compiled(&mut self, id: u64) {
        let asked = self.in_the_making(id, Mode::Compiled);
        let Some(cast) = self.cast_mut(id).filter(|cast| !asked && cast.compiled.is_none()) else { return };
        cast.compilable = true;
        self.request_compiled(id);
    }

    /// Requests the program of the scene on the stage once more, if it cannot look up cells and that is wanted. Until it
    /// comes, the one that is there goes on.
    pub(super) fn ask_for_cells(&mut self) {
        let drawable = |cast: &&Cast| cast.compiled.is_some() && cast.compilable;
        let Some(cast) = self.on_stage.as_ref().filter(drawable) else { return };
        let id = cast.id;
        if !cast.has_cells && self.wants_cells(cast) && !self.in_the_making(id, Mode::Compiled) {
            self.request_compiled(id);
        }
    }

    /// Whether a scene's compiled program is to look up the cells of a tree.
    fn wants_cells(&self, cast: &Cast) -> bool {
        cast.resources.uses_cells(self.regions.wish(), Mode::Compiled)
    }

    fn request_compiled(&mut self, id: u64) {
        let Some(cast) = self.cast(id) else { return };
        let has_cells = self.wants_cells(cast);
        let world = cast.resources.world().clone();
        let job = self.job(cast, move || compiled_drawing_variant(&world, has_cells));
        let how = if has_cells { ", with cells" } else { "" };
        tracing::info!("{} is requested, compiled{how}", cast.source.title());
        self.submit(job, Task::Compiled { id, has_cells });
    }

    pub(super) fn ask_for_interpreter(&mut self, id: u64) {
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

    pub(super) fn job(
        &self,
        cast: &Cast,
        variant: impl FnOnce() -> Result<Variant, GpuError> + Send + 'static,
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

    pub(super) fn submit(&mut self, job: ProgramJob, task: Task) {
        let id = self.fresh_id();
        debug_assert_eq!(id, job.id);
        self.tasks.insert(id, task);
        self.compiler.submit(job);
    }

    /// Whether a scene's program of that mode was requested and has not come.
    pub(super) fn in_the_making(&self, id: u64, mode: Mode) -> bool {
        let needed = self.cast(id).and_then(|cast| cast.interpreter.as_ref());
        self.tasks.values().any(|task| match task {
            Task::Compiled { id: asked, .. } => mode == Mode::Compiled && *asked == id,
            Task::Interpreter(asked) => {
                mode == Mode::Interpreted && needed.is_some_and(|needed| asked.covers(needed))
            }
            Task::Universal { .. } => {
                mode == Mode::Interpreted && needed.is_some_and(|needed| self.universal.are_coming(needed))
            }
            Task::Views(_) => false,
        })
    }
}
