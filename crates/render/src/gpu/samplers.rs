//! The samplers that a scene's program finds in its slots, the same ones before each of its draws
//! (`shaders/samplers.frag` tells why). Needed on software renderers only.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use glow::HasContext;

use super::error::GpuError;
use super::gl::Gl;
use super::program::LazyProgram;
use super::shader_source::{ShaderLibrary, Variant};
use super::target::{Target, Texel};

/// Reads as many textures as any program may.
pub const SAMPLERS_SHADER: &str = "samplers.frag";

/// Textures that a program may read, each at a unit of its own.
const SLOTS: u32 = 16;

/// See the module.
pub(super) struct Samplers {
    program: LazyProgram,
    /// What all of its slots read.
    texel: Target,
}

impl Samplers {
    /// Assembles the shader.
    ///
    /// # Errors
    /// A missing shader file, or no object left.
    pub(super) fn new(gl: &Gl, library: &ShaderLibrary) -> Result<Self, GpuError> {
        let program = LazyProgram::new(gl, library, SAMPLERS_SHADER, &Variant::default())?;
        Ok(Self { program, texel: Target::new(gl, (1, 1), &[Texel::Rgba8], None)? })
    }

    /// Puts the same samplers into all slots. `target` is what is drawn into next; nothing of it changes. The
    /// vertices of a full-screen triangle are bound; what was bound to the texture units is not any more.
    ///
    /// # Errors
    /// What the driver says about a malformed shader.
    pub(super) fn settle(&self, gl: &Gl, target: &Target) -> Result<(), GpuError> {
        (0..SLOTS).for_each(|unit| self.texel.bind_color(0, unit));
        target.bind();
        self.program.bind(gl)?;
        // SAFETY: plain state and a draw on objects of ours, none of whose pixels is within the scissor.
        unsafe {
            gl.enable(glow::SCISSOR_TEST);
            gl.scissor(0, 0, 0, 0);
            gl.draw_arrays(glow::TRIANGLES, 0, 3);
            gl.disable(glow::SCISSOR_TEST);
        }
        Ok(())
    }
}
