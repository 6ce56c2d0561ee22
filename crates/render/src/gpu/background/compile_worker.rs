//! A worker with its own context: loads or compiles programs, and draws once with each program. If the driver crashed
//! while it loaded a stored program, the program is compiled again. If the driver rejected an interpreter, or crashed
//! twice while compiling it, that interpreter is not tried again ([`crate::gpu::program_store`]).

use std::time::{Duration, Instant};

use super::{ProgramJob, ProgramProduct, Sources, texts_of};
use crate::faults::{self, Fault};
use crate::frame::block::FrameBlock;
use crate::frame::picture::Picture;
use crate::gpu::error::{GpuError, Result};
use crate::gpu::gl::Gl;
use crate::gpu::program::{Program, ProgramBinary, ReadyProgram};
use crate::gpu::program_store::{ProgramKey, Work};
use crate::gpu::renderer::{Counting, Renderer};
use crate::gpu::shader_source::ShaderLibrary;
use crate::gpu::stand_ins::{SceneShape, StandIns};

/// Size of the warm-up images. Like the sides of most windows, these are no powers of two (see
/// [`crate::gpu::stand_ins`]).
const WARM_UP_SIZE: (u32, u32) = (18, 14);

const SLOW_COMPILER: Duration = Duration::from_secs(2);
/// Duration of a compilation that a test makes endless. It applies to programs longer than `LONG_PROGRAM` bytes.
const ENDLESS_COMPILER: Duration = Duration::from_secs(3600);
const LONG_PROGRAM: usize = 200_000;

struct Asked {
    block: FrameBlock,
    picture: Picture,
    scene: SceneShape,
    product: ProgramProduct,
}

pub(super) struct CompileWorker {
    gl: Gl,
    renderer: Renderer,
    stand_ins: StandIns,
}

pub(super) struct Made {
    pub(super) program: ReadyProgram,
    /// The binary to store and its key; `None` if it is stored already.
    pub(super) to_keep: Option<(ProgramKey, Vec<u8>)>,
}

impl CompileWorker {
    pub(super) fn new(gl: Gl, library: &ShaderLibrary) -> Result<Self> {
        let renderer = Renderer::new(&gl, library, Counting::Off)?;
        let stand_ins = StandIns::new(&gl)?;
        Ok(Self { gl, renderer, stand_ins })
    }

    pub(super) fn make(&mut self, sources: &Sources, job: ProgramJob) -> Result<Made> {
        let Sources { library, cache } = sources;
        let is_interpreter = job.can_be_given_up;
        if faults::strikes(Fault::SlowCompiler) || is_interpreter && faults::strikes(Fault::SlowInterpreter) {
            std::thread::sleep(SLOW_COMPILER);
        }
        let texts = texts_of(library, job.variant, job.product, self.gl.info())?;
        if texts.len() > LONG_PROGRAM && faults::strikes(Fault::EndlessCompiler) {
            std::thread::sleep(ENDLESS_COMPILER);
        }
        let key = texts.key(self.gl.info());
        let asked = Asked { block: job.block, picture: job.picture, scene: job.scene, product: job.product };
        let died = cache.death(key);
        if is_interpreter {
            if died == Some(Work::Compiling) {
                cache.record_crash(key);
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
            let taken = match ProgramBinary::from_bytes(&bytes) {
                Some(binary) => Program::load(&self.gl, &binary)?.map(|program| (program, binary)),
                None => None,
            };
            if let Some((program, binary)) = taken {
                self.warm_up(&program, &asked)?;
                tracing::info!("loaded a stored program in {:.0} ms", 1000.0 * start.elapsed().as_secs_f64());
                return Ok(Made { program: ReadyProgram::new(texts, Some(binary)), to_keep: None });
            }
            tracing::info!("the driver rejects a stored program: compiling it again");
            cache.discard(key);
        }
        let _attempt = cache.attempt(key, Work::Compiling);
        if is_interpreter && faults::strikes(Fault::DeadlyInterpreter) {
            std::process::abort();
        }
        let start = Instant::now();
        let compiled = match Program::of(&self.gl, &texts) {
            _ if is_interpreter && faults::strikes(Fault::NoInterpreter) => Err(GpuError::Compile {
                name: asked.product.shader().to_owned(),
                log: "a fault injected by a test".to_owned(),
            }),
            compiled => compiled,
        };
        if is_interpreter && matches!(compiled, Err(GpuError::Compile { .. })) {
            cache.record_refused(key);
        }
        let compiled = compiled?;
        if is_interpreter {
            cache.record_compiled(key);
        }
        let ready = compiled.ready(texts);
        // The window's context loads this binary. Mesa's software renderers find cached machine code only if it was
        // made from the same binary. Therefore draw with a program that was loaded from the binary.
        let again = ready.binary().map(|binary| Program::load(&self.gl, binary)).transpose()?.flatten();
        self.warm_up(again.as_ref().unwrap_or(&compiled), &asked)?;
        tracing::info!("compiled a program in {:.0} ms", 1000.0 * start.elapsed().as_secs_f64());
        let to_keep = ready.binary().map(|binary| (key, binary.to_bytes()));
        Ok(Made { program: ready, to_keep })
    }

    /// Draws with a program, so that the driver finishes compiling. All data in this context can be dropped afterwards.
    fn warm_up(&mut self, program: &Program, asked: &Asked) -> Result<()> {
        let scene = self.stand_ins.names(&asked.scene)?;
        let (block, picture) = (&asked.block, &asked.picture);
        let drawn = if asked.product == ProgramProduct::Paths {
            self.renderer.draw_path_block(WARM_UP_SIZE, block, picture, &scene, program)
        } else {
            let view = (asked.product == ProgramProduct::Views).then_some(&[[0.0, 1.0, 0.0, 0.0]; 2]);
            self.renderer.draw_block(WARM_UP_SIZE, block, picture, &scene, program, view)
        };
        if let Err(error) = drawn {
            tracing::debug!("warming up a program: {error}");
        }
        self.gl.finish();
        program.unbind();
        Ok(())
    }
}
