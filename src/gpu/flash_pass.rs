//! Limits the flashes of finished pictures: measures their cells, and dims those that [`Limiter`] names.
//!
//! The cells are read back, some 27 kB. The picture waits for that, because the picture that shows the fourth flash
//! must itself be dimmed. A picture in which nothing is limited stays as it is.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use glow::HasContext;

use super::error::GpuError;
use super::gl::Gl;
use super::object::Texture;
use super::program::{Program, unit_of};
use super::shader_source::{ShaderLibrary, Variant};
use super::target::{Target, Texel};
use crate::flash::{CELLS, COLUMNS, Correction, Grid, Limiter, ROWS};

/// The shaders of this pass.
pub const FLASH_SHADERS: [&str; 2] = ["cells.frag", "limit_flashes.frag"];

/// The limiter, and what it needs on the GPU.
pub(super) struct FlashPass {
    gl: Gl,
    measure: Program,
    limit: Program,
    cells: Target,
    corrections: Texture,
    limiter: Limiter,
    /// The last picture, limited, if there was anything to limit.
    limited: Option<Target>,
    is_limited: bool,
}

impl FlashPass {
    /// Compiles the shaders.
    ///
    /// # Errors
    /// What the driver refuses, with its log.
    pub(super) fn new(gl: &Gl, library: &ShaderLibrary) -> Result<Self, GpuError> {
        let [measure, limit] =
            FLASH_SHADERS.map(|shader| Program::link(gl, library, shader, &Variant::default()));
        let pass = Self {
            gl: gl.clone(),
            measure: measure?,
            limit: limit?,
            cells: Target::new(gl, (COLUMNS as u32, ROWS as u32), &[Texel::Rgba32F], None)?,
            corrections: Texture::new(gl)?,
            limiter: Limiter::default(),
            limited: None,
            is_limited: false,
        };
        pass.upload(&vec![[0.0; 4]; CELLS]);
        gl.check("setting up the flash limiter")?;
        Ok(pass)
    }

    /// Forgets the last picture, because another one is drawn.
    pub(super) fn begin(&mut self) {
        self.is_limited = false;
    }

    /// Starts afresh: what comes next is another kind of picture, which the user asked for.
    pub(super) fn forget(&mut self) {
        self.limiter = Limiter::default();
    }

    /// Takes a finished picture that is shown `seconds` after the last one.
    ///
    /// # Errors
    /// No room for another picture.
    pub(super) fn take(&mut self, finished: &Target, seconds: f64) -> Result<(), GpuError> {
        finished.bind_color(0, unit_of("picture"));
        self.draw(&self.measure, &self.cells);
        let texels = self.cells.read_rgba32f(0);
        let grid = Grid::new(texels.as_chunks::<4>().0.iter().map(|[r, g, b, _]| [*r, *g, *b]));
        let Some(corrections) = self.limiter.limit(seconds, &grid) else { return Ok(()) };
        // OpenGL's first row is the lowest one.
        let texel = |c: &Correction| [c.gain, c.grey, f32::from(u8::from(c.limited)), 0.0];
        let texels: Vec<[f32; 4]> = corrections.chunks(COLUMNS).rev().flatten().map(texel).collect();
        let limited = match self.limited.take().filter(|limited| limited.size() == finished.size()) {
            Some(limited) => limited,
            None => Target::new(&self.gl, finished.size(), &[Texel::Rgba8], None)?,
        };
        self.upload(&texels);
        finished.bind_color(0, unit_of("picture"));
        self.draw(&self.limit, &limited);
        self.limited = Some(limited);
        self.is_limited = true;
        Ok(())
    }

    /// The last picture, if there was anything to limit.
    pub(super) fn limited(&self) -> Option<&Target> {
        self.limited.as_ref().filter(|_| self.is_limited)
    }

    fn draw(&self, program: &Program, target: &Target) {
        target.bind();
        program.bind();
        // SAFETY: a plain draw on objects of ours, in the current context.
        unsafe {
            self.gl.active_texture(glow::TEXTURE0 + unit_of("corrections"));
            self.gl.bind_texture(glow::TEXTURE_2D, Some(self.corrections.native()));
            self.gl.draw_arrays(glow::TRIANGLES, 0, 3);
        }
    }

    fn upload(&self, texels: &[[f32; 4]]) {
        let bytes: Vec<u8> = texels.as_flattened().iter().flat_map(|value| value.to_ne_bytes()).collect();
        let gl = &*self.gl;
        // SAFETY: the texture is ours; the slice holds a texel of four floats for each cell.
        unsafe {
            gl.active_texture(glow::TEXTURE0 + unit_of("corrections"));
            gl.bind_texture(glow::TEXTURE_2D, Some(self.corrections.native()));
            gl.pixel_store_i32(glow::UNPACK_ALIGNMENT, 1);
            gl.tex_image_2d(
                glow::TEXTURE_2D,
                0,
                glow::RGBA32F.cast_signed(),
                COLUMNS as i32,
                ROWS as i32,
                0,
                glow::RGBA,
                glow::FLOAT,
                glow::PixelUnpackData::Slice(Some(&bytes)),
            );
            for name in [glow::TEXTURE_MIN_FILTER, glow::TEXTURE_MAG_FILTER] {
                gl.tex_parameter_i32(glow::TEXTURE_2D, name, glow::NEAREST.cast_signed());
            }
            for name in [glow::TEXTURE_WRAP_S, glow::TEXTURE_WRAP_T] {
                gl.tex_parameter_i32(glow::TEXTURE_2D, name, glow::CLAMP_TO_EDGE.cast_signed());
            }
        }
    }
}
