//! From the scene's samples to the finished picture: passes over light, after all rays.
//!
//! 1. `resolve.frag` makes one light of each pixel's samples.
//! 2. `present.frag` exposes it, maps it to the screen's range, encodes it as sRGB and dithers.
//!
//! Light has the size of the scene's targets, the finished picture that of the output.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use glow::HasContext;

use super::error::GpuError;
use super::gl::Gl;
use super::object::Buffer;
use super::program::{Program, binding_of, unit_of};
use super::shader_source::{ShaderLibrary, Variant};
use super::target::{Target, Texel};
use crate::frame::picture::{PICTURE_BLOCK_VECTORS, Picture};
use crate::world::ToneMap;

/// The shaders of these passes and their defines.
pub const POST_SHADERS: [(&str, &[&str]); 4] = [
    ("resolve.frag", &[]),
    ("resolve.frag", &["EDGE_LIST"]),
    ("present.frag", &["TONE_MAP 2"]),
    ("present.frag", &["TONE_MAP 3"]),
];

/// The programs of these passes.
pub(super) struct Post {
    gl: Gl,
    resolve: Program,
    reinhard: Program,
    unmapped: Program,
    picture_buffer: Buffer,
}

/// What depends on the picture's size.
pub(super) struct PostTargets {
    light: Target,
    finished: Target,
}

impl Post {
    /// Compiles the shaders.
    ///
    /// # Errors
    /// What the driver refuses, with its log.
    pub(super) fn new(gl: &Gl, library: &ShaderLibrary) -> Result<Self, GpuError> {
        let [of_stencil, of_list, reinhard, unmapped] = POST_SHADERS;
        let link = |(name, defines): (&str, &[&str])| Program::link(gl, library, name, &Variant::of(defines));
        Ok(Self {
            gl: gl.clone(),
            resolve: link(if gl.info().software { of_list } else { of_stencil })?,
            reinhard: link(reinhard)?,
            unmapped: link(unmapped)?,
            picture_buffer: Buffer::new(gl)?,
        })
    }

    /// Tells all passes how the picture is made.
    pub(super) fn bind_picture(&self, picture: &Picture) {
        let mut bytes = Vec::with_capacity(PICTURE_BLOCK_VECTORS * 16);
        bytes.extend(picture.block().as_flattened().iter().flat_map(|value| value.to_ne_bytes()));
        let (gl, buffer) = (&*self.gl, Some(self.picture_buffer.native()));
        // SAFETY: the buffer is ours; the bytes are those of the block.
        unsafe {
            gl.bind_buffer(glow::UNIFORM_BUFFER, buffer);
            gl.buffer_data_u8_slice(glow::UNIFORM_BUFFER, &bytes, glow::STREAM_DRAW);
            gl.bind_buffer_base(glow::UNIFORM_BUFFER, binding_of("PictureBlock"), buffer);
        }
    }

    /// Finishes the picture. The scene's samples are bound.
    pub(super) fn draw(&self, targets: &PostTargets, picture: &Picture) {
        self.pass(&self.resolve, &targets.light);
        targets.light.bind_color(0, unit_of("picture"));
        let present = match picture.tone_map {
            ToneMap::Reinhard => &self.reinhard,
            ToneMap::None => &self.unmapped,
        };
        self.pass(present, &targets.finished);
    }

    fn pass(&self, program: &Program, target: &Target) {
        target.bind();
        program.bind();
        // SAFETY: a plain draw on objects of ours, in the current context.
        unsafe { self.gl.draw_arrays(glow::TRIANGLES, 0, 3) }
    }
}

impl PostTargets {
    /// For light of `size` pixels and finished pictures of `output`.
    ///
    /// # Errors
    /// As [`Target::new`].
    pub(super) fn new(gl: &Gl, size: (u32, u32), output: (u32, u32)) -> Result<Self, GpuError> {
        Ok(Self {
            light: Target::new(gl, size, &[Texel::Rgba16F], None)?,
            finished: Target::new(gl, output, &[Texel::Rgba8], None)?,
        })
    }

    /// The finished picture.
    pub(super) fn finished(&self) -> &Target {
        &self.finished
    }
}
