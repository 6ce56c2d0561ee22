//! Passes over whole images, and uniform blocks.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use glow::HasContext;

use super::error::Result;
use super::gl::Gl;
use super::object::{Buffer, VertexArray};
use super::program::{LazyProgram, binding_of};
use super::target::Target;

/// Maximum number of pixels of one draw. Larger passes are split, so that no watchdog mistakes a draw for a hang.
const BAND_PIXELS: u32 = 1 << 21;

pub(super) struct Passes {
    pub(super) gl: Gl,
    vertices: VertexArray,
    pub(super) post: Block,
}

impl Passes {
    pub(super) fn new(gl: &Gl) -> Result<Self> {
        Ok(Self { gl: gl.clone(), vertices: VertexArray::new(gl)?, post: Block::new(gl, "PostBlock")? })
    }

    pub(super) fn prepare(&self) {
        // SAFETY: sets state of the current context, to which the vertex array of `self` belongs.
        unsafe {
            let gl = &*self.gl;
            gl.bind_vertex_array(Some(self.vertices.native()));
            gl.disable(glow::DEPTH_TEST);
            gl.disable(glow::CULL_FACE);
            gl.disable(glow::SCISSOR_TEST);
            gl.clear_color(0.0, 0.0, 0.0, 0.0);
            gl.disable(glow::STENCIL_TEST);
            gl.disable(glow::BLEND);
        }
        self.gl.store_colors_unchanged();
    }

    pub(super) fn draw(&self, program: &LazyProgram, target: &Target) -> Result<()> {
        self.draw_with(program, target, [0.0; 2])
    }

    /// Draws over the window's framebuffer of `window` pixels, or over an `area` of the window, given by left and lower
    /// edge, width and height in pixels.
    pub(super) fn draw_in_window(
        &self,
        program: &LazyProgram,
        window: (u32, u32),
        area: Option<[i32; 4]>,
    ) -> Result<()> {
        self.prepare();
        self.gl.bind_output(self.gl.window(), window);
        let whole = [0, 0, window.0.cast_signed(), window.1.cast_signed()];
        self.draw_area(program, window, [0.0; 2], area.unwrap_or(whole))
    }

    pub(super) fn draw_with(&self, program: &LazyProgram, target: &Target, numbers: [f32; 2]) -> Result<()> {
        self.gl.replacing(|| self.cover(program, target, numbers))
    }

    /// Draws over an `area` of a target: left and lower edge, width and height in pixels.
    pub(super) fn draw_within(
        &self,
        program: &LazyProgram,
        target: &Target,
        numbers: [f32; 2],
        area: [i32; 4],
    ) -> Result<()> {
        target.bind();
        self.draw_area(program, target.size(), numbers, area)
    }

    /// Draws over an area of the bound framebuffer, which has `size` pixels.
    fn draw_area(
        &self,
        program: &LazyProgram,
        size: (u32, u32),
        numbers: [f32; 2],
        [x, y, width, height]: [i32; 4],
    ) -> Result<()> {
        self.post.set(&[1.0 / size.0.max(1) as f32, 1.0 / size.1.max(1) as f32, numbers[0], numbers[1]]);
        program.bind(&self.gl)?;
        // SAFETY: sets state and draws without attributes into the bound framebuffer, in the current context.
        unsafe {
            self.gl.enable(glow::SCISSOR_TEST);
            self.gl.scissor(x, y, width.max(0), height.max(0));
            self.gl.replacing(|| self.gl.draw_arrays(glow::TRIANGLES, 0, 3));
            self.gl.disable(glow::SCISSOR_TEST);
        }
        Ok(())
    }

    /// Mixes a `fraction`, 0..1, of a program's result into a whole target.
    pub(super) fn mix(&self, program: &LazyProgram, target: &Target, fraction: f32) -> Result<()> {
        // SAFETY: sets state of the current context.
        unsafe {
            self.gl.enable(glow::BLEND);
            self.gl.blend_func(glow::CONSTANT_ALPHA, glow::ONE_MINUS_CONSTANT_ALPHA);
            self.gl.blend_color(0.0, 0.0, 0.0, fraction);
        }
        let drawn = self.cover(program, target, [0.0; 2]);
        // SAFETY: sets state of the current context.
        unsafe { self.gl.disable(glow::BLEND) }
        drawn
    }

    fn cover(&self, program: &LazyProgram, target: &Target, numbers: [f32; 2]) -> Result<()> {
        let (width, height) = target.size();
        self.post.set(&[1.0 / width as f32, 1.0 / height as f32, numbers[0], numbers[1]]);
        target.bind();
        program.bind(&self.gl)?;
        let rows = (BAND_PIXELS / width.max(1)).max(1);
        // SAFETY: sets state and draws without attributes into the target bound above, in the current context.
        unsafe {
            if rows >= height {
                self.gl.draw_arrays(glow::TRIANGLES, 0, 3);
                return Ok(());
            }
            self.gl.enable(glow::SCISSOR_TEST);
            for y in (0..height).step_by(rows as usize) {
                self.gl.scissor(0, y.cast_signed(), width.cast_signed(), rows.cast_signed());
                self.gl.draw_arrays(glow::TRIANGLES, 0, 3);
                // Submit each band separately, so that the driver does not combine them.
                self.gl.flush();
            }
            self.gl.disable(glow::SCISSOR_TEST);
        }
        Ok(())
    }
}

pub(super) struct Block {
    gl: Gl,
    buffer: Buffer,
    binding: u32,
}

impl Block {
    pub(super) fn new(gl: &Gl, name: &str) -> Result<Self> {
        Ok(Self { gl: gl.clone(), buffer: Buffer::new(gl)?, binding: binding_of(name) })
    }

    pub(super) fn set(&self, numbers: &[f32]) {
        let (kind, buffer) = (glow::UNIFORM_BUFFER, Some(self.buffer.native()));
        // SAFETY: `self` owns the buffer, which belongs to the current context.
        unsafe {
            self.gl.bind_buffer(kind, buffer);
            self.gl.buffer_data_u8_slice(kind, bytemuck::cast_slice(numbers), glow::STREAM_DRAW);
            self.gl.bind_buffer_base(kind, self.binding, buffer);
        }
    }
}
