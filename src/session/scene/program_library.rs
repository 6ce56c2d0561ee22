//! Programs for scenes: pending compile tasks, and the interpreters shared by several scenes.
//!
//! ```text
//! universal interpreter ─ rejected ─► the scene's own interpreter ─ rejected ─► compiled only
//! ```

use std::collections::HashMap;
use std::rc::Rc;

use super::kept::KeptPrograms;
use super::prepared_scene::PreparedScene;
use super::program_task::{ProgramOf, Task};
use crate::frame::Frame;
use crate::frame::projection::Projection;
use crate::gpu::background::{BackgroundCompiler, ProgramJob, ProgramProduct};
use crate::gpu::scene_program::{
    as_paths, as_views, compiled_drawing_variant, compiled_variant_of, projected,
};
use crate::gpu::stand_ins::SceneShape;
use crate::gpu::{Counting, Gl, GpuError, Interpreter, Mode, Program, Sources, Variant, WorkerContext};
use mariana_field::region::Regions;

const NO_UNIVERSAL: &str =
    "this driver cannot compile the universal interpreter: each scene gets an interpreter";

pub(super) struct ProgramLibrary {
    gl: Gl,
    /// The projection that all programs draw.
    projection: Projection,
    /// The universal interpreters, which draw nearly every scene: one for distances and one for other formulas. A GPU
    /// compiles them before the first edit, so that no edit waits for a compiler. A software renderer has none: it
    /// evaluates every branch, so it only uses interpreters made for particular scenes.
    universal: Vec<Interpreter>,
    /// Kept apart: an interpreter of a scene with rare features covers a universal one, but draws more slowly.
    universal_programs: KeptPrograms,
    /// Interpreters made for particular scenes.
    interpreters: KeptPrograms,
    pub(super) tasks: HashMap<u64, Task>,
    next_task: u64,
    /// True after the first frame. Until then scenes get their own interpreters: the universal one compiles slowly.
    pub(super) has_shown: bool,
    // The last field, because its threads draw with objects of the fields above.
    pub(super) compiler: BackgroundCompiler,
}

impl ProgramLibrary {
    /// Starts the compiler threads, which call `wake` after each program.
    pub(super) fn start(
        gl: &Gl,
        contexts: Vec<WorkerContext>,
        sources: Sources,
        projection: Projection,
        wake: impl Fn() + Send + Clone + 'static,
    ) -> Self {
        let compiler = BackgroundCompiler::start(contexts, sources, gl.info(), wake);
        // Without threads, the universal interpreter would be compiled between frames and delay them.
        let has_universal = !gl.info().software && compiler.has_threads();
        Self {
            gl: gl.clone(),
            projection,
            universal: if has_universal {
                [false, true].map(Interpreter::universal).into()
            } else {
                Vec::new()
            },
            universal_programs: KeptPrograms::default(),
            interpreters: KeptPrograms::default(),
            tasks: HashMap::new(),
            next_task: 0,
            has_shown: false,
            compiler,
        }
    }

    /// The next finished program or its compile error, with its task, which is then no longer pending.
    pub(super) fn poll(&mut self) -> Option<(Task, Result<Program, GpuError>)> {
        while let Some(finished) = self.compiler.poll() {
            if let Some(task) = self.tasks.remove(&finished.id) {
                let program = finished.program.and_then(|ready| Program::adopt(&self.gl, &ready));
                return Some((task, program));
            }
        }
        None
    }

    pub(super) fn is_idle(&self) -> bool {
        self.tasks.is_empty()
    }

    pub(super) fn receive_interpreter(&mut self, interpreter: &Interpreter, program: Program) {
        let of = ProgramOf::Interpreted(interpreter.clone());
        if self.universal.contains(interpreter) {
            tracing::info!("the universal interpreter is ready{}", of_kind(interpreter));
            self.universal_programs.add(of, program);
        } else {
            tracing::info!("an interpreter is ready");
            self.interpreters.add(of, program);
        }
    }

    /// Gives up a universal interpreter that the driver has rejected: each scene then gets its own interpreter. Returns
    /// `false` for another interpreter.
    pub(super) fn reject_universal(&mut self, interpreter: &Interpreter, error: &GpuError) -> bool {
        let is_universal = self.universal.contains(interpreter);
        if is_universal {
            self.universal.retain(|one| one != interpreter);
            match error {
                GpuError::GivenUp { .. } => tracing::warn!("{NO_UNIVERSAL}; {error}"),
                _ => {
                    tracing::warn!("{NO_UNIVERSAL}");
                    tracing::info!("{error}");
                }
            }
        }
        is_universal
    }

    pub(super) fn interpreter_for(&mut self, needed: &Interpreter) -> Option<Rc<Program>> {
        let wanted = ProgramOf::Interpreted(needed.clone());
        self.universal_programs.covering(&wanted).or_else(|| self.interpreters.covering(&wanted))
    }

    pub(super) fn is_making(&self, scene: &PreparedScene, mode: Mode) -> bool {
        scene.program_of(mode).is_some_and(|wanted| self.is_asked(ProgramProduct::Frames, &wanted))
    }

    fn is_asked(&self, product: ProgramProduct, wanted: &ProgramOf) -> bool {
        self.tasks.values().any(|task| task.product == product && task.of.covers(wanted))
    }

    /// Gives the pending program of a scene in `alike` to the scene `id`, which needs the same program.
    pub(super) fn make_for(&mut self, alike: &[u64], id: u64) {
        let is_theirs = |task: &&mut Task| {
            let is_one = matches!(task.of, ProgramOf::Compiled(id) if alike.contains(&id));
            is_one && task.product == ProgramProduct::Frames
        };
        if let Some(task) = self.tasks.values_mut().find(is_theirs) {
            task.of = ProgramOf::Compiled(id);
        }
    }

    /// Drops requests for all other scenes. A program already being compiled is dropped when it is finished.
    pub(super) fn forget_all_but(&mut self, kept: &[u64]) {
        self.tasks.retain(|_, task| task.of.may_serve(kept));
        self.compiler.forget(|id| !self.tasks.contains_key(&id));
    }

    /// Requests a scene's own program, even if one without cell lookups exists.
    pub(super) fn request_compiled(&mut self, scene: &PreparedScene, has_cells: bool) {
        let world = scene.resources.world().clone();
        let job = self.job(scene, move || compiled_drawing_variant(&world, has_cells));
        let how = if has_cells { ", with cells" } else { "" };
        tracing::info!("{} is requested, compiled{how}", scene.title());
        self.submit(job, ProgramOf::Compiled(scene.id), has_cells);
    }

    /// Requests an interpreter for a scene, unless one exists or was requested.
    pub(super) fn request_interpreter(&mut self, scene: &PreparedScene) {
        let Some(needed) = &scene.programs.interpreter else { return };
        let of = ProgramOf::Interpreted(needed.clone());
        if self.universal_programs.cover(&of) {
            return;
        }
        let can_wait = self.has_shown || self.is_making(scene, Mode::Compiled);
        let universal = self.universal.iter().find(|one| can_wait && one.covers(needed));
        if universal.is_none() && self.interpreters.cover(&of) {
            return;
        }
        let wanted = universal.unwrap_or(needed).clone();
        self.request_variant(scene, wanted);
    }

    /// Requests a universal interpreter that no scene has needed yet. Its first frame draws `scene`.
    pub(super) fn request_unneeded(&mut self, scene: &PreparedScene) {
        let is_missing =
            |one: &&Interpreter| !self.universal_programs.cover(&ProgramOf::Interpreted((*one).clone()));
        if let Some(universal) = self.universal.iter().find(is_missing).cloned() {
            self.request_variant(scene, universal);
        }
    }

    fn request_variant(&mut self, scene: &PreparedScene, wanted: Interpreter) {
        let is_universal = self.universal.contains(&wanted);
        let is_alike = |task: &Task| match &task.of {
            ProgramOf::Interpreted(asked) => {
                asked.covers(&wanted) && self.universal.contains(asked) == is_universal
            }
            ProgramOf::Compiled(_) => false,
        };
        if self.tasks.values().any(|task| task.product == ProgramProduct::Frames && is_alike(task)) {
            return;
        }
        let variant = wanted.clone();
        let mut job = self.job(scene, move || Ok(variant.variant(Counting::Off)));
        job.can_be_given_up = true;
        match is_universal {
            true => tracing::info!("the universal interpreter is requested{}", of_kind(&wanted)),
            false => tracing::info!("{} is requested, interpreted", scene.title()),
        }
        self.submit(job, ProgramOf::Interpreted(wanted), false);
    }

    /// Requests a program for views or paths, unless an equivalent program is being made.
    pub(super) fn request_special(&mut self, scene: &PreparedScene, product: ProgramProduct, of: ProgramOf) {
        if self.is_asked(product, &of) {
            return;
        }
        let functions = of.clone();
        let (world, has_cells) = (scene.resources.world().clone(), scene.programs.has_cells);
        let mut job = self.job(scene, move || {
            let draws_views = product == ProgramProduct::Views;
            let counting = if draws_views { Counting::On } else { Counting::Off };
            let variant = match functions {
                ProgramOf::Compiled(_) if draws_views => compiled_variant_of(&world, counting)?,
                ProgramOf::Compiled(_) => compiled_drawing_variant(&world, has_cells)?,
                ProgramOf::Interpreted(interpreter) => interpreter.variant(counting),
            };
            Ok(if draws_views { as_views(variant) } else { as_paths(variant) })
        });
        job.product = product;
        tracing::info!("a program for {product:?} of {} is requested", scene.title());
        self.submit(job, of, has_cells);
    }

    fn job(
        &self,
        scene: &PreparedScene,
        variant: impl FnOnce() -> Result<Variant, GpuError> + Send + 'static,
    ) -> ProgramJob {
        let world = scene.resources.world();
        let frame = Frame::new(world, 0.0, mariana_music::Features::SILENCE, (16, 16));
        let projection = self.projection;
        let frame = frame.projected(world, projection);
        ProgramJob {
            id: self.next_task,
            variant: Box::new(move || Ok(projected(variant()?, &projection))),
            block: frame.block(world, &Regions::default(), None),
            picture: frame.picture,
            scene: SceneShape::of(world),
            product: ProgramProduct::Frames,
            can_be_given_up: false,
        }
    }

    fn submit(&mut self, job: ProgramJob, of: ProgramOf, has_cells: bool) {
        self.next_task += 1;
        self.tasks.insert(job.id, Task { product: job.product, of, has_cells });
        self.compiler.submit(job);
    }
}

fn of_kind(interpreter: &Interpreter) -> &'static str {
    if interpreter.is_non_lipschitz() { ", for formulas that are not distances" } else { "" }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use mariana_testing::process::wait_until;

    use super::super::testing::{text, uploaded};
    use super::*;
    use crate::gpu::headless::Headless;
    use crate::gpu::shader_source::ShaderLibrary;

    fn library(gl: &Gl) -> ProgramLibrary {
        let sources = Sources { library: ShaderLibrary::embedded(), cache: Arc::new(()) };
        ProgramLibrary::start(gl, Vec::new(), sources, Projection::default(), || {})
    }

    fn made(programs: &mut ProgramLibrary) -> (Task, Result<Program, GpuError>) {
        let mut found = None;
        wait_until("a program", || {
            found = programs.poll();
            found.is_some()
        });
        found.unwrap()
    }

    #[test]
    fn a_program_arrives_with_its_purpose_and_a_forgotten_one_never_arrives() {
        let context = Headless::new(false).unwrap();
        let mut programs = library(context.gl());
        let [first, second] = [(3, "sphere(p, 1)"), (4, "box(p, 1)")]
            .map(|(id, formula)| uploaded(context.gl(), id, &text(formula)));
        programs.request_compiled(&first, false);
        programs.request_compiled(&second, false);
        assert!(programs.is_making(&first, Mode::Compiled) && !programs.is_making(&first, Mode::Interpreted));
        programs.forget_all_but(&[4]);
        assert!(!programs.is_making(&first, Mode::Compiled) && programs.is_making(&second, Mode::Compiled));
        // Another version of the second scene has the same program.
        programs.make_for(&[4], 9);
        let (task, program) = made(&mut programs);
        assert_eq!((task.product, task.of), (ProgramProduct::Frames, ProgramOf::Compiled(9)));
        assert!(!task.has_cells && program.is_ok());
        assert!(programs.is_idle() && programs.poll().is_none());
    }

    #[test]
    fn an_interpreter_is_requested_once_for_all_scenes_that_it_covers() {
        let context = Headless::new(false).unwrap();
        let mut programs = library(context.gl());
        let [first, second] = [(0, "sphere(p, 1)"), (1, "sphere(p, 2)")]
            .map(|(id, formula)| uploaded(context.gl(), id, &text(formula)));
        programs.request_interpreter(&first);
        programs.request_interpreter(&second);
        assert!(programs.is_making(&second, Mode::Interpreted));
        let (task, program) = made(&mut programs);
        let ProgramOf::Interpreted(variant) = task.of else { panic!("no interpreter") };
        assert!(programs.is_idle(), "both scenes share one interpreter");
        programs.receive_interpreter(&variant, program.unwrap());
        let needed = second.programs.interpreter.as_ref().unwrap();
        assert!(programs.interpreter_for(needed).is_some());
    }

    #[test]
    fn each_universal_interpreter_is_requested_once_and_serves_until_the_driver_rejects_it() {
        let context = Headless::new(false).unwrap();
        let mut programs = library(context.gl());
        assert!(programs.universal.is_empty(), "without threads there is none");
        let [distances, others] = [false, true].map(Interpreter::universal);
        programs.universal = vec![distances.clone(), others.clone()];
        programs.has_shown = true;
        let mut scene = uploaded(context.gl(), 0, &text("sphere(p, 1)"));
        scene.programs.interpreter = Some(others.clone());
        let asked = |programs: &ProgramLibrary, wanted: &Interpreter| {
            let is_it = |task: &&Task| task.of == ProgramOf::Interpreted(wanted.clone());
            programs.tasks.values().filter(is_it).count()
        };
        for _ in 0..2 {
            programs.request_interpreter(&scene);
            assert_eq!((asked(&programs, &others), asked(&programs, &distances)), (1, 0));
        }
        assert!(programs.is_making(&scene, Mode::Interpreted));
        for _ in 0..2 {
            programs.request_unneeded(&scene);
            assert_eq!((asked(&programs, &others), asked(&programs, &distances)), (1, 1), "distances first");
        }
        let error = GpuError::NoWorker("none".to_owned());
        assert!(programs.reject_universal(&others, &error) && !programs.reject_universal(&others, &error));
        assert_eq!(programs.universal, [distances]);
    }
}
