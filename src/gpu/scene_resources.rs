//! What a scene keeps on the GPU besides its program: its pictures, its tape and the tape's table.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use std::rc::Rc;
use std::sync::Arc;

use glow::HasContext;
use image::RgbaImage;

use super::error::GpuError;
use super::gl::Gl;
use super::object::Texture;
use super::program::unit_of;
use super::scene_program::Interpreter;
use super::texture;
use super::texture_buffer::{BufferTexel, TextureBuffer};
use crate::graph::FrameInputs;
use crate::world::{TapeBuffers, World};

/// A world, uploaded.
pub struct SceneResources {
    world: Arc<World>,
    buffers: Arc<TapeBuffers>,
    /// Those of the world; scenes that were loaded one after the other share what they both read.
    pictures: Vec<Rc<Texture>>,
    tape: TextureBuffer,
    table: TextureBuffer,
}

impl SceneResources {
    /// Uploads a world's pictures and its tape. A tape that the driver has no room for is left out: such a scene can
    /// only be compiled (see [`Interpreter::fits`]).
    ///
    /// # Errors
    /// What the driver refuses.
    pub fn upload(gl: &Gl, world: Arc<World>, buffers: Arc<TapeBuffers>) -> Result<Self, GpuError> {
        Self::upload_after(None, gl, world, buffers)
    }

    /// The same, without uploading pictures again that `last` has.
    ///
    /// # Errors
    /// What the driver refuses.
    pub fn upload_after(
        last: Option<&Self>,
        gl: &Gl,
        world: Arc<World>,
        buffers: Arc<TapeBuffers>,
    ) -> Result<Self, GpuError> {
        let pictures = world.pictures.iter().map(|picture| {
            let known = last.and_then(|last| {
                last.pictures_with_textures().find(|(known, _)| Arc::ptr_eq(known, picture))
            });
            match known {
                Some((_, texture)) => Ok(texture.clone()),
                None => texture::upload(gl, picture).map(Rc::new),
            }
        });
        let pictures = pictures.collect::<Result<_, _>>()?;
        let fits = Interpreter::fits(&buffers, gl.info()).is_ok();
        let words: Vec<u8> = if fits {
            buffers.words.iter().flat_map(|word| word.to_ne_bytes()).collect()
        } else {
            vec![0; 16]
        };
        let tape = TextureBuffer::new(gl, BufferTexel::Rgba32U, &words)?;
        let table = TextureBuffer::new(gl, BufferTexel::Rgba32F, &[0; 16])?;
        gl.check("uploading a scene")?;
        Ok(Self { world, buffers, pictures, tape, table })
    }

    fn pictures_with_textures(&self) -> impl Iterator<Item = (&Arc<RgbaImage>, &Rc<Texture>)> {
        self.world.pictures.iter().zip(&self.pictures)
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
        self.table.replace(&bytes);
    }

    /// The driver's names of everything, for any context that shares its objects.
    pub fn names(&self) -> SceneNames {
        SceneNames {
            pictures: self.pictures.iter().map(|picture| picture.native()).collect(),
            tape: self.tape.texture(),
            table: self.table.texture(),
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
                gl.active_texture(glow::TEXTURE0 + unit_of(name));
                gl.bind_texture(glow::TEXTURE_BUFFER, Some(buffer));
            }
        }
    }
}
