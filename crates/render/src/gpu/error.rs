//! Errors of the GPU side.

use std::path::PathBuf;

use super::program_store::GivenUp;
use mariana_field::world::WorldError;

/// A result of the GPU side.
pub(crate) type Result<T, E = GpuError> = std::result::Result<T, E>;

/// An error of the GPU side. Each message names the problem, the place where it occurred, and a remedy.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// The system provides no OpenGL context without a window.
    #[error(
        "OpenGL without a window is not available on this system ({0}): install a driver with EGL \
         (Debian: libegl1 and libgl1-mesa-dri, which also bring a software renderer)"
    )]
    NoHeadlessContext(String),
    /// The driver is older than OpenGL 3.3 and than OpenGL ES 3.0.
    #[error(
        "OpenGL {0} is too old; Mariana needs OpenGL 3.3 core, or OpenGL ES 3.0 with EXT_color_buffer_float: update \
         the graphics driver, or set LIBGL_ALWAYS_SOFTWARE=1 to use Mesa's software renderer"
    )]
    TooOld(String),
    /// The variable that chooses OpenGL ES has an unknown value.
    #[error("the variable MARIANA_GL is '{0}': set it to es to draw with OpenGL ES, or unset it")]
    UnknownApi(String),
    /// A shader text is missing or malformed.
    #[error(transparent)]
    Source(#[from] ShaderSourceError),
    /// The driver rejected a shader.
    #[error("the driver rejects {name}: correct the lines in its log\n{log}")]
    Compile {
        /// The shader file or the program.
        name: String,
        /// The driver's log, with the names of the files.
        log: String,
    },
    /// The driver failed to compile a program in an earlier run.
    #[error("{}", why.sentence(mark))]
    GivenUp {
        /// The kind of failure.
        why: GivenUp,
        /// The file with the record of the failure.
        mark: PathBuf,
    },
    /// The scene cannot be translated into a shader.
    #[error(transparent)]
    World(#[from] WorldError),
    /// The scene's tape exceeds the driver's limits.
    #[error(transparent)]
    DoesNotFit(#[from] DoesNotFit),
    /// The compiler thread has no context.
    #[error(
        "the driver provides no second context to compile in ({0}): scenes are compiled between frames instead"
    )]
    NoWorker(String),
    /// The driver could not create an object.
    #[error("the driver could not create {what}: {reason}")]
    Object {
        /// The kind of object.
        what: &'static str,
        /// The driver's error.
        reason: String,
    },
    /// An image beyond the driver's limits.
    #[error(
        "an image of {width}x{height} pixels exceeds this driver's limit of {limit} a side: choose a smaller size"
    )]
    TooLarge {
        /// Requested width in pixels.
        width: u32,
        /// Requested height in pixels.
        height: u32,
        /// The driver's largest side.
        limit: u32,
    },
    /// The context is lost, for example because the GPU was reset.
    #[error("the driver has lost its context while {0}: restart Mariana if no image appears")]
    ContextLost(&'static str),
    /// The driver reported an error.
    #[error("OpenGL reports {what} while {doing}")]
    Driver {
        /// The GL error.
        what: String,
        /// The operation that failed.
        doing: &'static str,
    },
}

/// The reason why a driver cannot interpret a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum DoesNotFit {
    /// The tapes are too long for the driver's lists.
    #[error(
        "the scene's tape needs {needed} texels of a list, but the driver has {available}: the scene is compiled \
         instead"
    )]
    Texels {
        /// Texels needed.
        needed: usize,
        /// Texels that the driver supports.
        available: usize,
    },
    /// The scene needs more values at once than a tape has registers.
    #[error(
        "the scene needs more than 256 values at once, but a tape has 256 registers: the scene is compiled instead"
    )]
    Registers,
}

/// An error in the assembly of a shader's text.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct ShaderSourceError(pub(super) String);
