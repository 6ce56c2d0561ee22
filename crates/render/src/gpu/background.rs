//! Programs compiled in parallel with the frame loop, on threads with contexts of their own.
//!
//! A driver's work on a large shader takes from tens of milliseconds to many seconds, and part of it waits for the
//! first draw. So a worker links the program and draws a small picture with it, in the same states and with textures
//! of the same kinds that the renderer will use. The drawing thread gets values only, among them the driver's own
//! form of the program; what the driver compiled at the draw it finds in its cache. No object is ever shared between
//! two contexts, because drivers mishandle shared objects ([`super::program::ReadyProgram`]).
//!
//! What a driver made is kept from run to run (`compile_worker`).

#![expect(unsafe_code, reason = "creating contexts is unsafe in glutin")]

mod compile_worker;

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
use super::program::{ProgramTexts, ReadyProgram};
use super::program_store::ProgramStore;
use super::scene_program::SCENE_SHADER;
use super::shader_source::{ShaderLibrary, Variant};
use super::stand_ins::SceneShape;
use crate::faults::{self, Fault};
use crate::frame::block::FrameBlock;
use crate::frame::picture::Picture;
use crate::limits::LIMITS;
use compile_worker::{CompileWorker, Made};

/// A context for a worker, not current anywhere yet.
pub struct WorkerContext {
    display: Display,
    context: NotCurrentContext,
}

impl WorkerContext {
    /// A context of the driver `info` on the display, or on one of its own, that shares nothing with any other.
    ///
    /// **llvmpipe's contexts stay apart.** Before it hands out memory of a texture or buffer, it looks through what all
    /// contexts of the display still draw (`llvmpipe_flush_resource`), and Mesa 22.3 does that while their threads change
    /// it: drawing in one context could crash another.
    ///
    /// # Errors
    /// What EGL says.
    pub fn new(display: &Display, config: &Config, info: &GlInfo) -> glutin::error::Result<Self> {
        #[cfg(all(unix, not(target_os = "macos")))]
        if info.software
            && let Some((display, context)) = super::headless::software_context()
        {
            return Ok(Self { display: Display::Egl(display), context: NotCurrentContext::Egl(context) });
        }
        let attributes = ContextAttributesBuilder::new()
            .with_profile(GlProfile::Core)
            .with_context_api(ContextApi::OpenGl(Some(Version::new(3, 3))))
            .build(None);
        // SAFETY: display and configuration are of one EGL library and alive.
        let context = unsafe { display.create_context(config, &attributes) }?;
        Ok(Self { display: display.clone(), context })
    }

    /// A context on EGL's default display; [`super::headless::Headless`] uses another one. `None` if EGL refuses it.
    pub fn beside_headless() -> Option<Self> {
        #[cfg(target_os = "linux")]
        let made = super::headless::default_context();
        #[cfg(target_os = "linux")]
        return made.map(|(display, context)| Self {
            display: Display::Egl(display),
            context: NotCurrentContext::Egl(context),
        });
        #[cfg(not(target_os = "linux"))]
        None
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
    reported: bool,
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
                state.begun.push(Begun { id: job.id, since: Instant::now(), reported: false });
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
    /// Starts a thread for each context of the driver `info`. `wake` is called after each job, on the worker's thread.
    /// If there is no context or no thread, [`BackgroundCompiler::poll`] gives texts, which are linked between frames.
    pub fn start(
        contexts: Vec<WorkerContext>,
        sources: Sources,
        info: &GlInfo,
        wake: impl Fn() + Send + Clone + 'static,
    ) -> Self {
        let queue = Arc::new(Queue::default());
        let (sender, finished) = channel();
        let mut threads = Vec::with_capacity(contexts.len());
        for context in contexts {
            let (queue, sender, sources, wake) =
                (queue.clone(), sender.clone(), sources.clone(), wake.clone());
            let worker = std::thread::Builder::new().name("compiler".into());
            match worker.spawn(move || work(context, &queue, &sender, &sources, &wake)) {
                Ok(thread) => threads.push(thread),
                Err(error) => {
                    tracing::warn!("no thread to compile on ({error}); the others go on without it")
                }
            }
        }
        Self { queue, finished, threads, library: sources.library, info: info.clone() }
    }

    /// Whether programs are made beside the frame loop.
    pub fn has_threads(&self) -> bool {
        !self.threads.is_empty()
    }

    /// The jobs that a driver has been at for longer than [`crate::limits::Limits::compile_seconds_reported`], each once.
    pub fn slow(&self) -> Vec<u64> {
        let mut state = self.queue.lock();
        let slow = state
            .begun
            .iter_mut()
            .filter(|begun| !begun.reported && begun.since.elapsed() > reported_after());
        slow.map(|begun| {
            begun.reported = true;
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
fn reported_after() -> Duration {
    let is_hurried = [Fault::SlowCompiler, Fault::SlowInterpreter].into_iter().any(faults::is_wanted);
    let seconds = if is_hurried { 0.2 } else { LIMITS.compile_seconds_reported };
    Duration::from_secs_f64(seconds)
}

/// What programs are made from.
#[derive(Clone)]
pub struct Sources {
    /// The shaders' files.
    pub library: ShaderLibrary,
    /// What was kept from earlier runs, and where it is kept for later ones.
    pub cache: Arc<dyn ProgramStore>,
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
    let mut compile_worker = context.as_ref().map_err(Clone::clone).and_then(|(display, _current)| {
        let gl = Gl::load(|name| display.get_proc_address(name), false);
        gl.and_then(|gl| CompileWorker::new(gl, &sources.library)).map_err(|error| error.to_string())
    });
    while let Some(job) = queue.next() {
        let id = job.id;
        let made = match &mut compile_worker {
            // After a panic the caller must not wait for ever.
            Ok(compile_worker) => catch_unwind(AssertUnwindSafe(|| compile_worker.make(sources, job)))
                .unwrap_or_else(|_| {
                    Err(GpuError::NoWorker { reason: "making a program ended with a panic".into() })
                }),
            Err(reason) => Err(GpuError::NoWorker { reason: reason.clone() }),
        };
        let (program, to_keep) = match made {
            Ok(Made { program, to_keep }) => (Ok(program), to_keep),
            Err(error) => (Err(error), None),
        };
        queue.end(id);
        if finished.send(Finished { id, program }).is_err() {
            break;
        }
        wake();
        // Nobody waits for a disk.
        if let Some((key, bytes)) = to_keep {
            sources.cache.save(key, &bytes);
        }
        #[cfg(all(target_os = "linux", target_env = "gnu"))]
        super::heaps::give_back();
    }
}

/// The texts of a scene's program.
fn texts_of(library: &ShaderLibrary, variant: VariantMaker, info: &GlInfo) -> Result<ProgramTexts, GpuError> {
    Ok(ProgramTexts::assemble(library, SCENE_SHADER, &variant()?, info)?)
}
