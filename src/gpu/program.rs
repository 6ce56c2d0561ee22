//! A linked program: a full-screen vertex shader and one fragment shader.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use glow::HasContext;

use super::error::GpuError;
use super::gl::Gl;
use super::object::ProgramObject;
use super::shader_source::{DRIVER_PREAMBLE, ShaderLibrary, name_places};

/// The uniform blocks of the shaders, with their binding points (see `shaders/README.md`).
pub const UNIFORM_BLOCKS: [(&str, u32); 2] = [("FrameBlock", 0), ("PassBlock", 1)];

/// The textures of the shaders, with their units (see `shaders/README.md`).
pub const TEXTURE_UNITS: [(&str, u32); 4] =
    [("wood", 0), ("mallard", 1), ("picture", 2), ("extra_samples", 3)];

/// The vertex shader that all passes share.
pub const VERTEX_SHADER: &str = "fullscreen.vert";

/// A linked program, its blocks and textures bound to their fixed places.
pub struct Program {
    gl: Gl,
    object: ProgramObject,
}

impl Program {
    /// Assembles, compiles and links `fragment` of `library` with `defines`.
    ///
    /// # Errors
    /// Missing shader files, and what the driver says about malformed ones.
    pub fn link(
        gl: &Gl,
        library: &ShaderLibrary,
        fragment: &str,
        defines: &[&str],
    ) -> Result<Self, GpuError> {
        let object = ProgramObject::new(gl)?;
        let program = object.native();
        let stages = [(glow::VERTEX_SHADER, VERTEX_SHADER), (glow::FRAGMENT_SHADER, fragment)];
        // SAFETY: names are made and used in the current context; shaders are freed on every path.
        unsafe {
            for (stage, name) in stages {
                let source = library.assemble(name, DRIVER_PREAMBLE, defines)?;
                let shader = gl
                    .create_shader(stage)
                    .map_err(|reason| GpuError::Object { what: "a shader", reason })?;
                gl.shader_source(shader, &source);
                gl.compile_shader(shader);
                let compiled = gl.get_shader_compile_status(shader);
                let log = if compiled {
                    String::new()
                } else {
                    name_places(&gl.get_shader_info_log(shader), &source)
                };
                if compiled {
                    gl.attach_shader(program, shader);
                }
                // A shader that is attached lives on until its program goes.
                gl.delete_shader(shader);
                if !compiled {
                    return Err(GpuError::Compile { name: name.into(), log });
                }
            }
            gl.link_program(program);
            if !gl.get_program_link_status(program) {
                let log = gl.get_program_info_log(program);
                return Err(GpuError::Compile { name: format!("the program of {fragment}"), log });
            }
            for (block, binding) in UNIFORM_BLOCKS {
                if let Some(index) = gl.get_uniform_block_index(program, block) {
                    gl.uniform_block_binding(program, index, binding);
                }
            }
            gl.use_program(Some(program));
            for (texture, unit) in TEXTURE_UNITS {
                if let Some(location) = gl.get_uniform_location(program, texture) {
                    gl.uniform_1_i32(Some(&location), unit.cast_signed());
                }
            }
        }
        Ok(Self { gl: gl.clone(), object })
    }

    /// Makes this the program of the following draws.
    pub fn bind(&self) {
        // SAFETY: the program is linked and ours.
        unsafe { self.gl.use_program(Some(self.object.native())) }
    }
}
