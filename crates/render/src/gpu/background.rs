//! Compiles programs on worker threads with their own contexts, in parallel with the frame loop.
//!
//! A driver takes from tens of milliseconds to many seconds for a large shader, and does part of the work at the first
//! draw. A worker therefore links the program and draws a small image with it, with the same OpenGL state and kinds of
//! textures as the renderer. The drawing thread receives plain values, such as the driver's binary, because drivers
//! mishandle objects shared between contexts ([`super::program::ReadyProgram`]). `compile_worker` stores compiled
//! programs between runs.

#![expect(unsafe_code, reason = "glutin's functions that create contexts are unsafe")]

mod compile_worker;

use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use glutin::config::Config;
use glutin::context::{NotCurrentContext, PossiblyCurrentContext};
use glutin::display::{Display, GetGlDisplay, GlDisplay};
use glutin::error::ErrorKind;

use super::error::{GpuError, Result};
use super::gl::{Gl, GlInfo};
use super::program::{ProgramTexts, ReadyProgram};
use super::program_store::ProgramStore;
use super::scene_program::{PATH_SHADER, SCENE_SHADER};
use super::shader_source::{ShaderLibrary, Variant};
use super::stand_ins::SceneShape;
use crate::faults::{self, Fault};
use crate::frame::block::FrameBlock;
use crate::frame::picture::Picture;
use crate::limits;
use compile_worker::CompileWorker;

/// A context for a worker. It is not current on any thread yet.
pub struct WorkerContext {
    display: Display,
    context: NotCurrentContext,
}

impl WorkerContext {
    /// Creates contexts for up to `count` workers of a window whose context has this `config` and the driver `info`. The
    /// contexts share no objects. Without any, programs are compiled between frames.
    ///
    /// **llvmpipe gets one context, on a separate display.** Before llvmpipe hands out the memory of a texture or
    /// buffer, it reads lists of unfinished draws, of all contexts of the display (`llvmpipe_flush_resource`). Other
    /// threads may change these lists meanwhile (Mesa 22.3), so drawing in one context could crash another context. EGL
    /// has one display for each device, so a second worker would share the first one's display.
    pub fn beside_window(config: &Config, info: &GlInfo, count: usize) -> Vec<Self> {
        if !Self::are_of(config) {
            return Vec::new();
        }
        #[cfg(all(unix, not(target_os = "macos")))]
        if info.software
            && let Some((display, context)) = super::headless::software_context(info.api)
        {
            return vec![Self { display: Display::Egl(display), context: NotCurrentContext::Egl(context) }];
        }
        let display = config.display();
        let made = (0..count).map(|_| {
            // SAFETY: `display` is alive, and `config` comes from the same library.
            let context = unsafe { info.api.create(&display, config, None) };
            let context = context.map_err(|error| {
                tracing::info!("no second context ({error}); scenes are compiled between frames");
            });
            context.map(|context| Self { display: display.clone(), context })
        });
        made.flatten().collect()
    }

    /// Creates a context on EGL's default display, apart from [`super::headless::Headless`]. `None` if EGL refuses.
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

    /// True if workers can use contexts of the kind of `config`: those of EGL and WGL.
    fn are_of(config: &Config) -> bool {
        match config {
            #[cfg(any(windows, all(unix, not(target_os = "macos"))))]
            Config::Egl(_) => true,
            #[cfg(windows)]
            Config::Wgl(_) => true,
            #[allow(unreachable_patterns, reason = "some systems have one kind only")]
            _ => false,
        }
    }

    /// Makes the context current on this thread, without a window.
    ///
    /// EGL and WGL support that. Contexts of GLX would share the window's connection to the X server. On macOS a
    /// context waits for the main thread.
    fn make_current(self) -> Result<(Display, PossiblyCurrentContext), String> {
        let current: glutin::error::Result<PossiblyCurrentContext> = match self.context {
            #[cfg(any(windows, all(unix, not(target_os = "macos"))))]
            NotCurrentContext::Egl(context) => {
                context.make_current_surfaceless().map(PossiblyCurrentContext::Egl)
            }
            #[cfg(windows)]
            NotCurrentContext::Wgl(context) => {
                context.make_current_surfaceless().map(PossiblyCurrentContext::Wgl)
            }
            #[allow(unreachable_patterns, reason = "some systems have one kind only")]
            _ => Err(ErrorKind::NotSupported("contexts of this kind need a window").into()),
        };
        current.map(|context| (self.display, context)).map_err(|error| error.to_string())
    }
}

/// Generates the text of a shader on the worker's thread.
pub type VariantMaker = Box<dyn FnOnce() -> Result<Variant> + Send>;

/// A program to compile.
pub struct ProgramJob {
    /// The caller's identifier.
    pub id: u64,
    /// The shader text.
    pub variant: VariantMaker,
    /// The frame block of the warm-up image.
    pub block: FrameBlock,
    /// Post-processing of the warm-up image.
    pub picture: Picture,
    /// Textures and buffers that the warm-up image reads.
    pub scene: SceneShape,
    /// The kind of images that the program draws.
    pub product: ProgramProduct,
    /// True if the program must not be tried again after the driver has failed to compile it.
    pub can_be_given_up: bool,
}

/// The kind of images that a program draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ProgramProduct {
    /// Frames.
    Frames,
    /// Diagnostic views.
    Views,
    /// Frames by paths of light.
    Paths,
}

impl ProgramProduct {
    fn shader(self) -> &'static str {
        match self {
            Self::Frames | Self::Views => SCENE_SHADER,
            Self::Paths => PATH_SHADER,
        }
    }
}

/// A finished job.
pub struct Finished {
    /// The caller's identifier.
    pub id: u64,
    /// The program as plain values.
    pub program: Result<ReadyProgram>,
}

/// Maximum wait for busy drivers at exit. A process that exits while a driver compiles may crash.
const END_WAIT: Duration = Duration::from_secs(4);

/// The queue of programs to compile and its worker threads.
pub struct BackgroundCompiler {
    queue: Arc<Queue>,
    finished: Receiver<Finished>,
    threads: Vec<JoinHandle<()>>,
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
    begun: Vec<Begun>,
    over: bool,
}

struct Begun {
    id: u64,
    since: Instant,
    reported: bool,
}

impl Queue {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

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
    /// Starts a thread for each context of the driver `info`. Each worker calls `wake` after each job. If there are no
    /// contexts or threads, [`BackgroundCompiler::poll`] returns texts, which the caller compiles between frames.
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
                    tracing::warn!("cannot start a compiler thread ({error}): compiling with fewer threads")
                }
            }
        }
        Self { queue, finished, threads, library: sources.library, info: info.clone() }
    }

    /// True if programs are compiled in parallel with the frame loop.
    pub fn has_threads(&self) -> bool {
        !self.threads.is_empty()
    }

    /// Returns the jobs that take longer than [`crate::limits::COMPILE_SECONDS_REPORTED`], each job only once.
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

    /// Adds a program to the end of the queue.
    pub fn submit(&self, job: ProgramJob) {
        self.queue.lock().jobs.push_back(job);
        self.queue.changed.notify_one();
    }

    /// Drops queued jobs for which `obsolete` returns true.
    pub fn forget(&self, obsolete: impl Fn(u64) -> bool) {
        self.queue.lock().jobs.retain(|job| !obsolete(job.id));
    }

    /// Returns a finished job, if any, without waiting.
    pub fn poll(&self) -> Option<Finished> {
        if self.threads.is_empty() {
            let job = self.queue.lock().jobs.pop_front()?;
            let texts = texts_of(&self.library, job.variant, job.product, &self.info);
            let program = texts.map(|texts| ReadyProgram::new(texts, None));
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
            // Do not wait longer: a driver may need minutes. Its thread may outlive the window, which it does not use.
            if !thread.is_finished() {
                tracing::info!("a driver is still compiling: Mariana exits without waiting for it");
                continue;
            }
            if thread.join().is_err() {
                tracing::warn!("a compiler thread panicked");
            }
        }
    }
}

fn reported_after() -> Duration {
    let is_hurried = [Fault::SlowCompiler, Fault::SlowInterpreter].into_iter().any(faults::is_wanted);
    let seconds = if is_hurried { 0.2 } else { limits::COMPILE_SECONDS_REPORTED };
    Duration::from_secs_f64(seconds)
}

/// The inputs of compilation.
#[derive(Clone)]
pub struct Sources {
    /// The shader files.
    pub library: ShaderLibrary,
    /// The store of programs from earlier runs.
    pub cache: Arc<dyn ProgramStore>,
}

fn work(
    worker: WorkerContext,
    queue: &Queue,
    finished: &Sender<Finished>,
    sources: &Sources,
    wake: &dyn Fn(),
) {
    // The context stays current until everything made in it is dropped.
    let context = worker.make_current();
    let mut compile_worker = context.as_ref().map_err(Clone::clone).and_then(|(display, _current)| {
        let gl = Gl::load(|name| display.get_proc_address(name), false);
        gl.and_then(|gl| CompileWorker::new(gl, &sources.library)).map_err(|error| error.to_string())
    });
    while let Some(job) = queue.next() {
        let id = job.id;
        let made = match &mut compile_worker {
            // Send a result even after a panic, because the caller waits for the result.
            Ok(compile_worker) => catch_unwind(AssertUnwindSafe(|| compile_worker.make(sources, job)))
                .unwrap_or_else(|_| Err(GpuError::NoWorker("compiling a program panicked".into()))),
            Err(reason) => Err(GpuError::NoWorker(reason.clone())),
        };
        let (program, to_keep) =
            made.map_or_else(|error| (Err(error), None), |made| (Ok(made.program), made.to_keep));
        queue.end(id);
        if finished.send(Finished { id, program }).is_err() {
            break;
        }
        wake();
        // Send the result before saving it, because writing to a disk may be slow.
        if let Some((key, bytes)) = to_keep {
            sources.cache.save(key, &bytes);
        }
        #[cfg(all(target_os = "linux", target_env = "gnu"))]
        super::heaps::give_back();
    }
}

fn texts_of(
    library: &ShaderLibrary,
    variant: VariantMaker,
    product: ProgramProduct,
    info: &GlInfo,
) -> Result<ProgramTexts> {
    Ok(ProgramTexts::assemble(library, product.shader(), &variant()?, info)?)
}

#[cfg(all(test, target_os = "linux"))]
mod tests;
