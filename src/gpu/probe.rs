//! A fragment shader on its own: texture buffers in, floats out. For tests and measurements of generated shaders.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use glow::HasContext;

use super::error::GpuError;
use super::gl::Gl;
use super::object::{Buffer, ProgramObject, Texture, VertexArray};
use super::shader_source::name_places;
use super::target::{Target, Texel};

/// A triangle that covers the target.
const VERTEX: &str = "#version 330 core
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }
";

/// What the texels of a texture buffer are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BufferTexel {
    /// Four words: a `usamplerBuffer`.
    Rgba32U,
    /// One float: a `samplerBuffer`.
    R32F,
    /// Four floats: a `samplerBuffer`.
    Rgba32F,
}

/// A linked fragment shader with its texture buffers and a target of 32-bit floats.
pub struct Probe {
    gl: Gl,
    program: ProgramObject,
    target: Target,
    vertices: VertexArray,
    // Each texture with the buffer that it reads; the place is its unit.
    buffers: Vec<(Texture, Buffer)>,
}

impl Probe {
    /// Compiles and links the whole text of a fragment shader, `#version` included, that writes `outputs` vec4.
    ///
    /// # Errors
    /// What the driver says about the text, with the places in files that [`super::shader_source`] marked.
    pub fn new(gl: &Gl, fragment: &str, size: (u32, u32), outputs: usize) -> Result<Self, GpuError> {
        let program = ProgramObject::new(gl)?;
        // SAFETY: names are made and used in the current context; shaders are freed on every path.
        unsafe {
            for (stage, text) in [(glow::VERTEX_SHADER, VERTEX), (glow::FRAGMENT_SHADER, fragment)] {
                let shader = gl
                    .create_shader(stage)
                    .map_err(|reason| GpuError::Object { what: "a shader", reason })?;
                gl.shader_source(shader, text);
                gl.compile_shader(shader);
                if gl.get_shader_compile_status(shader) {
                    gl.attach_shader(program.native(), shader);
                    gl.delete_shader(shader);
                } else {
                    let log = name_places(&gl.get_shader_info_log(shader), text);
                    gl.delete_shader(shader);
                    return Err(GpuError::Compile { name: "a probe".into(), log });
                }
            }
            gl.link_program(program.native());
            if !gl.get_program_link_status(program.native()) {
                let log = gl.get_program_info_log(program.native());
                return Err(GpuError::Compile { name: "the program of a probe".into(), log });
            }
        }
        let target = Target::new(gl, size, &vec![Texel::Rgba32F; outputs], None)?;
        let vertices = VertexArray::new(gl)?;
        Ok(Self { gl: gl.clone(), program, target, vertices, buffers: Vec::new() })
    }

    /// Adds a texture buffer with these bytes under the name of its uniform. A name that the shader does not
    /// read is ignored.
    ///
    /// # Errors
    /// [`GpuError::Object`] if the driver has no object left.
    pub fn add_buffer(&mut self, name: &str, texel: BufferTexel, bytes: &[u8]) -> Result<(), GpuError> {
        let (gl, unit) = (&self.gl, self.buffers.len() as u32);
        let (texture, buffer) = (Texture::new(gl)?, Buffer::new(gl)?);
        let format = match texel {
            BufferTexel::Rgba32U => glow::RGBA32UI,
            BufferTexel::R32F => glow::R32F,
            BufferTexel::Rgba32F => glow::RGBA32F,
        };
        // SAFETY: all names are ours and made in the current context.
        unsafe {
            gl.bind_buffer(glow::TEXTURE_BUFFER, Some(buffer.native()));
            gl.buffer_data_u8_slice(glow::TEXTURE_BUFFER, bytes, glow::STATIC_DRAW);
            gl.active_texture(glow::TEXTURE0 + unit);
            gl.bind_texture(glow::TEXTURE_BUFFER, Some(texture.native()));
            gl.tex_buffer(glow::TEXTURE_BUFFER, format, Some(buffer.native()));
            gl.use_program(Some(self.program.native()));
            if let Some(location) = gl.get_uniform_location(self.program.native(), name) {
                gl.uniform_1_i32(Some(&location), unit.cast_signed());
            }
        }
        self.buffers.push((texture, buffer));
        self.gl.check("adding a texture buffer")
    }

    /// Sets an integer uniform; a name that the shader does not read is ignored.
    pub fn set_integer(&self, name: &str, value: i32) {
        // SAFETY: the program is linked and ours.
        unsafe {
            self.gl.use_program(Some(self.program.native()));
            if let Some(location) = self.gl.get_uniform_location(self.program.native(), name) {
                self.gl.uniform_1_i32(Some(&location), value);
            }
        }
    }

    /// Draws every pixel once.
    pub fn draw(&self) {
        self.target.bind();
        // SAFETY: program, buffers and target are ours and complete.
        unsafe {
            for ((texture, _), unit) in self.buffers.iter().zip(glow::TEXTURE0..) {
                self.gl.active_texture(unit);
                self.gl.bind_texture(glow::TEXTURE_BUFFER, Some(texture.native()));
            }
            self.gl.use_program(Some(self.program.native()));
            self.gl.bind_vertex_array(Some(self.vertices.native()));
            self.gl.draw_arrays(glow::TRIANGLES, 0, 3);
        }
    }

    /// Output `index` of every pixel, four floats each; the row with `gl_FragCoord.y` 0.5 comes last.
    pub fn read(&self, index: u32) -> Vec<f32> {
        self.target.read_rgba32f(index)
    }
}
