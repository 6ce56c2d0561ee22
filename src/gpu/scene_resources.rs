//! What a scene keeps on the GPU besides its program: its pictures, its tape and the tape's table.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use std::sync::Arc;

use glow::HasContext;

use super::error::GpuError;
use super::gl::Gl;
use super::object::{Buffer, Texture};
use super::program::TEXTURE_UNITS;
use super::texture::{self, Wrap};
use crate::graph::FrameInputs;
use crate::world::{TapeBuffers, World};

/// A world, uploaded.
pub struct SceneResources {
    gl: Gl,
    world: Arc<World>,
    buffers: Arc<TapeBuffers>,
    pictures: Vec<Texture>,
    tape: TextureBuffer,
    table: TextureBuffer,
}

/// A buffer that shaders read as texels.
struct TextureBuffer {
    texture: Texture,
    buffer: Buffer,
}

impl SceneResources {
    /// Uploads a world's pictures and its tape. A tape that the driver has no room for is left out: such a scene can
    /// only be compiled (see [`super::scene_program::Interpreter::fits`]).
    ///
    /// # Errors
    /// What the driver refuses.
    pub fn upload(gl: &Gl, world: Arc<World>, buffers: Arc<TapeBuffers>) -> Result<Self, GpuError> {
        let pictures = world.pictures.iter().map(|picture| texture::upload(gl, picture, Wrap::Repeat));
        let pictures = pictures.collect::<Result<_, _>>()?;
        let fits = super::scene_program::Interpreter::fits(&buffers, gl.info()).is_ok();
        let words: Vec<u8> = if fits {
            buffers.words.iter().flat_map(|word| word.to_ne_bytes()).collect()
        } else {
            vec![0; 16]
        };
        let tape = TextureBuffer::new(gl, glow::RGBA32UI, &words)?;
        let table = TextureBuffer::new(gl, glow::RGBA32F, &[0; 16])?;
        gl.check("uploading a scene")?;
        Ok(Self { gl: gl.clone(), world, buffers, pictures, tape, table })
    }

    /// The world that was uploaded.
    pub fn world(&self) -> &Arc<World> {
        &self.world
    }

    /// Its programs.
    pub fn buffers(&self) -> &Arc<TapeBuffers> {
        &self.buffers
    }

    /// Uploads the table of a frame.
    pub(super) fn upload_table(&self, inputs: &FrameInputs) {
        let bytes: Vec<u8> =
            self.buffers.table_values(inputs).into_iter().flat_map(f32::to_ne_bytes).collect();
        if bytes.is_empty() {
            return;
        }
        // SAFETY: the buffer is ours, and the bytes are those of the table.
        unsafe {
            self.gl.bind_buffer(glow::TEXTURE_BUFFER, Some(self.table.buffer.native()));
            self.gl.buffer_data_u8_slice(glow::TEXTURE_BUFFER, &bytes, glow::STREAM_DRAW);
        }
    }

    /// The driver's names of everything, for any context that shares its objects.
    pub fn names(&self) -> SceneNames {
        SceneNames {
            pictures: self.pictures.iter().map(Texture::native).collect(),
            tape: self.tape.texture.native(),
            table: self.table.texture.native(),
        }
    }
}

/// What is bound for a scene. The names are good while its [`SceneResources`] live; later ones draw something else, or
/// make the driver report an error.
#[derive(Debug, Clone)]
pub struct SceneNames {
    pictures: Vec<glow::NativeTexture>,
    tape: glow::NativeTexture,
    table: glow::NativeTexture,
}

impl SceneNames {
    /// Binds everything to its units.
    pub(super) fn bind(&self, gl: &Gl) {
        // SAFETY: names of another scene or of none at all are an error that the driver reports.
        unsafe {
            for (unit, picture) in (glow::TEXTURE0..).zip(&self.pictures) {
                gl.active_texture(unit);
                gl.bind_texture(glow::TEXTURE_2D, Some(*picture));
            }
            for (name, buffer) in [("tape", self.tape), ("tape_table", self.table)] {
                let unit =
                    TEXTURE_UNITS.iter().find(|(known, _)| *known == name).map_or(0, |(_, unit)| *unit);
                gl.active_texture(glow::TEXTURE0 + unit);
                gl.bind_texture(glow::TEXTURE_BUFFER, Some(buffer));
            }
        }
    }
}

impl TextureBuffer {
    fn new(gl: &Gl, format: u32, bytes: &[u8]) -> Result<Self, GpuError> {
        let (texture, buffer) = (Texture::new(gl)?, Buffer::new(gl)?);
        // SAFETY: both names are ours, made in the current context.
        unsafe {
            gl.bind_buffer(glow::TEXTURE_BUFFER, Some(buffer.native()));
            gl.buffer_data_u8_slice(glow::TEXTURE_BUFFER, bytes, glow::STATIC_DRAW);
            gl.bind_texture(glow::TEXTURE_BUFFER, Some(texture.native()));
            gl.tex_buffer(glow::TEXTURE_BUFFER, format, Some(buffer.native()));
        }
        Ok(Self { texture, buffer })
    }
}
