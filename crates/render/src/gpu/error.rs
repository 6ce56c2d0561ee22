//! What can go wrong on the way to a picture.

use std::path::PathBuf;

use super::program_store::GivenUp;
use mariana_field::world::WorldError;

/// An error of the GPU side. Each message says what, where and what to do.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// No OpenGL without a window on this system.
    #[error(
        "OpenGL without a window is not available here ({reason}): install a driver with EGL \
         (Debian: libegl1 and libgl1-mesa-dri, which also bring a software renderer)"
    )]
    NoHeadlessContext {
        /// What the system said.
        reason: String,
    },
    /// The driver is older than OpenGL 3.3.
    #[error(
        "OpenGL {found} is too old: Mariana needs 3.3 core; update the graphics driver, or set \
         LIBGL_ALWAYS_SOFTWARE=1 to use Mesa's software renderer"
    )]
    TooOld {
        /// The driver's version string.
        found: String,
    },
    /// Shader text is missing or malformed.
    #[error(transparent)]
    Source(#[from] ShaderSourceError),
    /// The driver refused a shader.
    #[error("the driver rejects {name}: correct the lines that it names\n{log}")]
    Compile {
        /// The shader file, or the program.
        name: String,
        /// The driver's log, with the files' names.
        log: String,
    },
    /// The driver failed at a program in an earlier run.
    #[error("{}", why.sentence(mark))]
    GivenUp {
        /// How it failed.
        why: GivenUp,
        /// The file that remembers it.
        mark: PathBuf,
    },
    /// The scene cannot be made into a shader.
    #[error(transparent)]
    World(#[from] WorldError),
    /// The scene's tape is too large for the driver.
    #[error(transparent)]
    DoesNotFit(#[from] DoesNotFit),
    /// The thread that compiles has no context.
    #[error(
        "the driver provides no second context to compile in ({reason}): scenes are compiled between frames instead"
    )]
    NoWorker {
        /// What the driver said.
        reason: String,
    },
    /// The driver could not make an object.
    #[error("the driver could not make {what}: {reason}")]
    Object {
        /// What was asked for.
        what: &'static str,
        /// What the driver said.
        reason: String,
    },
    /// A picture beyond what the driver can hold.
    #[error(
        "a picture of {width}x{height} pixels is more than this driver allows ({limit} a side): choose a smaller one"
    )]
    TooLarge {
        /// Asked width in pixels.
        width: u32,
        /// Asked height in pixels.
        height: u32,
        /// The driver's largest side.
        limit: u32,
    },
    /// The driver was reset, or has lost the context for another reason.
    #[error(
        "the driver has lost its context while {doing}: start Mariana again if the picture does not come back"
    )]
    ContextLost {
        /// What was being done.
        doing: &'static str,
    },
    /// The driver reported an error.
    #[error("OpenGL reports {what} while {doing}")]
    Driver {
        /// The GL error.
        what: String,
        /// What was being done.
        doing: &'static str,
    },
}

/// Why a scene cannot be interpreted by a driver.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum DoesNotFit {
    /// Its programs are too long for a texture buffer.
    #[error(
        "the scene's tape needs {needed} texels of a texture buffer, but the driver has {available}: it is compiled \
         instead"
    )]
    Texels {
        /// Texels that are needed.
        needed: usize,
        /// Texels that the driver reports.
        available: usize,
    },
    /// Its distance keeps more values at once than a tape has registers.
    #[error(
        "the scene's distance keeps more than 256 values at once, which no region's tape can do: it is compiled instead"
    )]
    Registers,
}

/// Why shader text could not be put together.
#[derive(Debug, thiserror::Error)]
pub enum ShaderSourceError {
    /// The folder of `--shaders` lacks a file, or it cannot be read.
    #[error(
        "the shader file {path} cannot be read: give --shaders a folder that holds every file of shaders/"
    )]
    Unreadable {
        /// The file that was looked for.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// No embedded file has that name.
    #[error(
        "there is no shader file '{name}' (included by {asked_by}): correct the name in the #include line"
    )]
    Unknown {
        /// The name as it was written.
        name: String,
        /// The file and line that ask for it.
        asked_by: String,
    },
    /// An include line that is not of the form `#include "name"`.
    #[error("{file}:{line}: write the include as #include \"name.glsl\", just a name, without folders")]
    BadInclude {
        /// The file with the line.
        file: String,
        /// Its line, from 1.
        line: usize,
    },
    /// Includes nested deeper than [`mariana_field::limits::Limits::include_depth_max`].
    #[error("{file}: shader includes are nested deeper than {limit}: take some out")]
    TooDeep {
        /// The file at which the limit was met.
        file: String,
        /// The limit.
        limit: usize,
    },
    /// More text than [`crate::limits::Limits::shader_bytes_max`].
    #[error("{file}: the shader is longer than {limit} bytes with its includes: take some out")]
    TooLong {
        /// The shader.
        file: String,
        /// The limit.
        limit: usize,
    },
}
