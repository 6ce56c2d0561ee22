//! Runs a single fragment shader with lists of texels as inputs and floats as outputs. Tests and measurements of
//! generated shaders use it.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use glow::HasContext;

use super::error::Result;
use super::gl::Gl;
use super::object::{ProgramObject, VertexArray};
use super::program::link_texts;
use super::shader_source::driver_preamble;
use super::target::{Target, Texel};
use super::texel_list::{self, ListTexel, TexelList};

const VERTEX: &str =
    "void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }
";

/// A linked fragment shader with its lists and a target of 32-bit floats.
pub struct Probe {
    gl: Gl,
    program: ProgramObject,
    target: Target,
    vertices: VertexArray,
    /// Lists of texels. The index of a list is its texture unit.
    lists: Vec<TexelList>,
}

impl Probe {
    /// Compiles and links the complete text of a fragment shader, including `#version`, that writes `outputs` vec4.
    ///
    /// # Errors
    /// Fails with the driver's log. Its line numbers refer to the files that [`super::shader_source`] marked.
    pub fn new(gl: &Gl, fragment: &str, size: (u32, u32), outputs: usize) -> Result<Self> {
        let vertex = driver_preamble(gl.info()) + VERTEX;
        let program = link_texts(gl, ("a probe's vertex shader", &vertex), ("a probe", fragment))?;
        let target = Target::new(gl, size, &vec![Texel::Rgba32F; outputs], None)?;
        let vertices = VertexArray::new(gl)?;
        Ok(Self { gl: gl.clone(), program, target, vertices, lists: Vec::new() })
    }

    /// Adds a list with these bytes for the uniform `name`, which is ignored if the shader does not use it.
    ///
    /// # Errors
    /// [`GpuError::Object`] if the driver cannot create another object.
    pub fn add_list(&mut self, name: &str, texel: ListTexel, bytes: &[u8]) -> Result<()> {
        let list = TexelList::new(&self.gl, texel, bytes)?;
        self.set_integer(name, self.lists.len() as i32);
        self.lists.push(list);
        self.gl.check("adding a list")
    }

    /// Sets an integer uniform, which is ignored if the shader does not use it.
    pub fn set_integer(&self, name: &str, value: i32) {
        // SAFETY: `self` owns the linked program, which belongs to the current context.
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
        for (list, unit) in self.lists.iter().zip(0..) {
            texel_list::bind(&self.gl, unit, list.texture());
        }
        // SAFETY: `self` owns the program and vertices; the complete target is bound; all belong to the current
        // context.
        unsafe {
            self.gl.use_program(Some(self.program.native()));
            self.gl.bind_vertex_array(Some(self.vertices.native()));
            self.gl.draw_arrays(glow::TRIANGLES, 0, 3);
        }
    }

    /// Output `index` of every pixel, four floats each, from the top row to the row with `gl_FragCoord.y` 0.5.
    pub fn read(&self, index: u32) -> Vec<f32> {
        self.target.read_rgba32f(index)
    }
}
