//! Resets the samplers before each draw of a scene's program, so that each texture slot always holds the same sampler
//! (`shaders/samplers.frag` explains the reason). Only software renderers need this.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use glow::HasContext;

use super::error::Result;
use super::gl::Gl;
use super::program::LazyProgram;
use super::shader_source::{ShaderLibrary, Variant};
use super::target::{Target, Texel};

/// A shader that reads as many textures as any program may read.
pub const SAMPLERS_SHADER: &str = "samplers.frag";

/// Maximum number of textures of a program, each in its own unit.
pub(super) const SLOTS: u32 = 16;

pub(super) struct Samplers {
    program: LazyProgram,
    texel: Target,
}

impl Samplers {
    pub(super) fn new(gl: &Gl, library: &ShaderLibrary) -> Result<Self> {
        let program = LazyProgram::new(gl, library, SAMPLERS_SHADER, &Variant::default())?;
        Ok(Self { program, texel: Target::new(gl, (1, 1), &[Texel::Rgba8], None)? })
    }

    /// Sets the same samplers in all slots and unbinds the texture units. `target` is the target of the next draw; its
    /// content does not change. The vertices of a full-screen triangle must be bound.
    pub(super) fn settle(&self, gl: &Gl, target: &Target) -> Result<()> {
        (0..SLOTS).for_each(|unit| self.texel.bind_color(0, unit));
        target.bind();
        self.program.bind(gl)?;
        // SAFETY: sets state and draws without attributes into the bound target, with an empty scissor, in the current
        // context.
        unsafe {
            gl.enable(glow::SCISSOR_TEST);
            gl.scissor(0, 0, 0, 0);
            gl.draw_arrays(glow::TRIANGLES, 0, 3);
            gl.disable(glow::SCISSOR_TEST);
        }
        Ok(())
    }
}
