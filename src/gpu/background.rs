//! Programs compiled in parallel with the frame loop, on threads with contexts of their own.
//!
//! A driver's work on a large shader takes from tens of milliseconds to many seconds, and part of it waits for the
//! first draw. So a worker links the program and draws a small picture with it, in the same states and with textures
//! of the same kinds that the renderer will use. The drawing thread gets values only, among them the driver's own
//! form of the program; what the driver compiled at the draw it finds in its cache. No object is ever shared between
//! two contexts, because drivers mishandle shared objects ([`super::program::ReadyProgram`]).
//!
//! **What a driver made is kept** from run to run ([`crate::program_cache`]): from the second start on a worker only
//! hands it to the driver again. A driver that dies of its own form of a program compiles it the next time; an
//! interpreter that it refuses or dies of is not tried again, because the scene can be drawn in other ways.

#![expect(unsafe_code, reason = "creating contexts is unsafe in glutin")]

use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use glutin::config::Config;
use glutin::context::{
    ContextApi, ContextAttributesBuilder, GlProfile, NotCurrentContext, PossiblyCurrentContext, Version,
};
use glutin::display::{Display, GlDisplay};

use super::error::GpuError;
use super::gl::{Gl, GlInfo};
use super::program::{Program, ProgramBinary, ProgramTexts, ReadyProgram};
use super::renderer::{Counting, Renderer};
use super::scene_program::SCENE_SHADER;
use super::shader_source::{ShaderLibrary, Variant};
use super::stand_ins::{SceneShape, StandIns};
use crate::faults::{self, Fault};
use crate::frame::block::FrameBlock;
use crate::frame::picture::Picture;
use crate::limits::LIMITS;
use crate::program_cache::{GivenUp, ProgramCache, Work};

/// A context for a worker, not current anywhere yet.
pub struct WorkerContext {
    display: Display,
    context: NotCurrentContext,
}

impl WorkerContext {
    /// A context on the display that shares nothing with any other.
    ///
    /// # Errors
    /// What EGL says.
    pub fn new(display: &Display, config: &Config) -> glutin::error::Result<Self> {
        let attributes = ContextAttributesBuilder::new()
            .with_profile(GlProfile::Core)
            .with_context_api(ContextApi::OpenGl(Some(Version::new(3, 3))))
            .build(None);
        // SAFETY: display and configuration are of one EGL library and alive.
        let context = unsafe { display.create_context(config, &attributes) }?;
        Ok(Self { display: display.clone(), context })
    }

    /// Makes it current on this thread. Without a window only EGL can do that.
    fn make_current(self) -> Result<(Display, PossiblyCurrentContext), String> {
        let current = match self.context {
            #[cfg(any(windows, all(unix, not(target_os = "macos"))))]
            NotCurrentContext::Egl(context) => {
                context.make_current_surfaceless().map(PossiblyCurrentContext::Egl)
            }
            #[allow(unreachable_patterns, reason = "some systems have one kind only")]
            _ => return Err("contexts without a window need EGL".into()),
        };
        current.map(|context| (self.display, context)).map_err(|error| error.to_string())
    }
}

/// Makes the text of a shader, on the worker's thread.
pub type VariantMaker = Box<dyn FnOnce() -> Result<Variant, GpuError> + Send>;

/// A program to be made.
pub struct ProgramJob {
    /// The caller's name for it.
    pub id: u64,
    /// Its text.
    pub variant: VariantMaker,
    /// What the picture that warms it up shows.
    pub block: FrameBlock,
    /// What happens to its light.
    pub picture: Picture,
    /// What that picture reads.
    pub scene: SceneShape,
    /// Whether it is a program of views.
    pub draws_views: bool,
    /// Whether it is not tried again once the driver has failed at it.
    pub can_be_given_up: bool,
}

/// A job that is done.
pub struct Finished {
    /// The caller's name for it.
    pub id: u64,
    /// The program, as values.
    pub program: Result<ReadyProgram, GpuError>,
}

/// Size of the pictures that warm a program up: no power of two, because those of windows are none either (see
/// [`super::stand_ins`]).
const WARM_UP_SIZE: (u32, u32) = (18, 14);

/// How long a driver takes that a test makes slow.
const SLOW_COMPILER: Duration = Duration::from_secs(2);

/// How long the end waits for drivers at work: a process that ends while one compiles may crash.
const END_WAIT: Duration = Duration::from_secs(4);

/// The workers and their jobs.
pub struct BackgroundCompiler {
    queue: Arc<Queue>,
    finished: Receiver<Finished>,
    threads: Vec<JoinHandle<()>>,
    /// What the texts of programs are made from, if there are no threads.
    library: ShaderLibrary,
    info: GlInfo,
}

#[derive(Default)]
struct Queue {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    jobs: VecDeque<ProgramJob>,
    /// The jobs that threads are at.
    begun: Vec<Begun>,
    over: bool,
}

/// A job that a thread is at.
struct Begun {
    id: u64,
    since: Instant,
    /// Whether it was told that it takes long.
    told: bool,
}

impl Queue {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The next job; none when the compiler ends.
    fn next(&self) -> Option<ProgramJob> {
        let mut state = self.lock();
        loop {
            if state.over {
                return None;
            }
            if let Some(job) = state.jobs.pop_front() {
                state.begun.push(Begun { id: job.id, since: Instant::now(), told: false });
                return Some(job);
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn end(&self, id: u64) {
        self.lock().begun.retain(|begun| begun.id != id);
    }
}

impl BackgroundCompiler {
    /// Starts a thread for each context of the driver `info`, which keep what they make in `cache`. `wake` is called
    /// after each job, on the worker's thread. If there is no context or no thread, [`BackgroundCompiler::poll`] gives
    /// texts, which are linked between frames.
    pub fn start(
        contexts: Vec<WorkerContext>,
        library: &ShaderLibrary,
        info: &GlInfo,
        cache: &ProgramCache,
        wake: impl Fn() + Send + Clone + 'static,
    ) -> Self {
        let queue = Arc::new(Queue::default());
        let (sender, finished) = channel();
        let mut threads = Vec::with_capacity(contexts.len());
        for context in contexts {
            let (queue, sender, wake) = (queue.clone(), sender.clone(), wake.clone());
            let sources = Sources { library: library.clone(), cache: cache.clone() };
            let worker = std::thread::Builder::new().name("compiler".into());
            match worker.spawn(move || work(context, &queue, &sender, &sources, &wake)) {
                Ok(thread) => threads.push(thread),
                Err(error) => {
                    tracing::warn!("no thread to compile on ({error}); the others go on without it")
                }
            }
        }
        Self { queue, finished, threads, library: library.clone(), info: info.clone() }
    }

    /// Whether programs are made beside the frame loop.
    pub fn has_threads(&self) -> bool {
        !self.threads.is_empty()
    }

    /// The jobs that a driver has been at for longer than [`crate::limits::Limits::compile_seconds_told`], each once.
    pub fn slow(&self) -> Vec<u64> {
        let mut state = self.queue.lock();
        let slow = state.begun.iter_mut().filter(|begun| !begun.told && begun.since.elapsed() > told_after());
        slow.map(|begun| {
            begun.told = true;
            begun.id
        })
        .collect()
    }

    /// Requests a program, after those that were requested before.
    pub fn submit(&self, job: ProgramJob) {
        self.queue.lock().jobs.push_back(job);
        self.queue.changed.notify_one();
    }

    /// Drops the jobs that `obsolete` names and that were not begun.
    pub fn forget(&self, obsolete: impl Fn(u64) -> bool) {
        self.queue.lock().jobs.retain(|job| !obsolete(job.id));
    }

    /// A job that is done, if there is one; does not wait.
    pub fn poll(&self) -> Option<Finished> {
        if self.threads.is_empty() {
            let job = self.queue.lock().jobs.pop_front()?;
            let program = texts_of(&self.library, job.variant, &self.info).map(ReadyProgram::from);
            return Some(Finished { id: job.id, program });
        }
        self.finished.try_recv().ok()
    }
}

impl Drop for BackgroundCompiler {
    fn drop(&mut self) {
        let mut state = self.queue.lock();
        state.over = true;
        state.jobs.clear();
        drop(state);
        self.queue.changed.notify_all();
        let until = Instant::now() + END_WAIT;
        for thread in self.threads.drain(..) {
            while !thread.is_finished() && Instant::now() < until {
                std::thread::sleep(Duration::from_millis(2));
            }
            // A driver cannot be interrupted, and may need minutes for a large scene. Nothing in its context belongs
            // to the window's, so the window's can go without it.
            if !thread.is_finished() {
                tracing::info!("a driver is still compiling: the program ends without it");
                continue;
            }
            if thread.join().is_err() {
                tracing::warn!("a compiling thread ended with a panic");
            }
        }
    }
}

/// When it is told that a job takes long.
fn told_after() -> Duration {
    let seconds = if faults::is_wanted(Fault::SlowCompiler) { 0.2 } else { LIMITS.compile_seconds_told };
    Duration::from_secs_f64(seconds)
}

/// What programs are made from.
struct Sources {
    library: ShaderLibrary,
    cache: ProgramCache,
}

fn work(
    worker: WorkerContext,
    queue: &Queue,
    finished: &Sender<Finished>,
    sources: &Sources,
    wake: &dyn Fn(),
) {
    // Kept current to the end of the thread, until everything that was made in it is gone.
    let context = worker.make_current();
    let mut studio = context.as_ref().map_err(Clone::clone).and_then(|(display, _current)| {
        let gl = Gl::load(|name| display.get_proc_address(name), false).map_err(|error| error.to_string())?;
        let renderer =
            Renderer::new(&gl, &sources.library, Counting::Off).map_err(|error| error.to_string())?;
        let stand_ins = StandIns::new(&gl).map_err(|error| error.to_string())?;
        Ok(Studio { gl, renderer, stand_ins })
    });
    while let Some(job) = queue.next() {
        let id = job.id;
        let program = match &mut studio {
            // After a panic the caller must not wait for ever.
            Ok(studio) => catch_unwind(AssertUnwindSafe(|| studio.make(sources, job))).unwrap_or_else(|_| {
                Err(GpuError::NoWorker { reason: "making a program ended with a panic".into() })
            }),
            Err(reason) => Err(GpuError::NoWorker { reason: reason.clone() }),
        };
        queue.end(id);
        if finished.send(Finished { id, program }).is_err() {
            break;
        }
        wake();
    }
}

/// The texts of a scene's program.
fn texts_of(library: &ShaderLibrary, variant: VariantMaker, info: &GlInfo) -> Result<ProgramTexts, GpuError> {
    Ok(ProgramTexts::assemble(library, SCENE_SHADER, &variant()?, info)?)
}

/// The picture that warms a program up.
struct Asked {
    block: FrameBlock,
    picture: Picture,
    scene: SceneShape,
    draws_views: bool,
}

/// Everything of a worker's context.
struct Studio {
    gl: Gl,
    renderer: Renderer,
    stand_ins: StandIns,
}

impl Studio {
    /// Makes a program: from what was kept of it or else from its texts.
    fn make(&mut self, sources: &Sources, job: ProgramJob) -> Result<ReadyProgram, GpuError> {
        let Sources { library, cache } = sources;
        if faults::strikes(Fault::SlowCompiler) {
            std::thread::sleep(SLOW_COMPILER);
        }
        let texts = texts_of(library, job.variant, self.gl.info())?;
        let key = texts.key(self.gl.info());
        let asked =
            Asked { block: job.block, picture: job.picture, scene: job.scene, draws_views: job.draws_views };
        let died = cache.death(key);
        if job.can_be_given_up {
            if died == Some(Work::Compiling) {
                cache.give_up(key, GivenUp::Died);
            }
            if let Some((why, mark)) = cache.given_up(key) {
                return Err(GpuError::GivenUp { why, mark });
            }
        }
        if died.is_some() {
            cache.discard(key);
        }
        if self.gl.info().program_binaries
            && let Some(bytes) = cache.load(key)
        {
            let _attempt = cache.attempt(key, Work::Taking);
            let start = Instant::now();
            let binary = ProgramBinary::from_bytes(&bytes);
            let taken = binary.and_then(|binary| Program::take(&self.gl, &binary).transpose()).transpose()?;
            if let Some(program) = taken {
                let ready = self.warm_up(&program, &asked, texts)?;
                tracing::info!(
                    "a kept program is there after {:.0} ms",
                    1000.0 * start.elapsed().as_secs_f64()
                );
                return Ok(ready);
            }
            tracing::info!("the driver does not take a program that was kept: it compiles it again");
            cache.discard(key);
        }
        let _attempt = cache.attempt(key, Work::Compiling);
        if job.can_be_given_up && faults::strikes(Fault::DeadlyInterpreter) {
            std::process::abort();
        }
        let start = Instant::now();
        let compiled = match Program::of(&self.gl, &texts) {
            _ if job.can_be_given_up && faults::strikes(Fault::NoInterpreter) => Err(GpuError::Compile {
                name: SCENE_SHADER.to_owned(),
                log: "a fault that a test causes".to_owned(),
            }),
            compiled => compiled,
        };
        if job.can_be_given_up && matches!(compiled, Err(GpuError::Compile { .. })) {
            cache.give_up(key, GivenUp::Refused);
        }
        let ready = self.warm_up(&compiled?, &asked, texts)?;
        tracing::info!("a program is compiled after {:.0} ms", 1000.0 * start.elapsed().as_secs_f64());
        if let Some(binary) = ready.binary() {
            cache.save(key, &binary.to_bytes());
        }
        Ok(ready)
    }

    /// Draws with a program, so that the driver has nothing left to do. Afterwards it can be dropped, with everything
    /// that the driver keeps for it in this context.
    fn warm_up(
        &mut self,
        program: &Program,
        asked: &Asked,
        texts: ProgramTexts,
    ) -> Result<ReadyProgram, GpuError> {
        let scene = self.stand_ins.names(&asked.scene)?;
        let blocks = (&asked.block, &asked.picture);
        let drawn = if asked.draws_views {
            let view = [[0.0, 1.0, 0.0, 0.0]; 2];
            self.renderer.draw_view_block(WARM_UP_SIZE, blocks, &scene, program, &view)
        } else {
            self.renderer.draw_block(WARM_UP_SIZE, blocks, &scene, program)
        };
        // The program is usable all the same.
        if let Err(error) = drawn {
            tracing::debug!("warming up a program: {error}");
        }
        self.gl.finish();
        let ready = program.ready(texts);
        program.unbind();
        Ok(ready)
    }
}
