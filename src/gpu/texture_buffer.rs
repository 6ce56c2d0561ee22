//! Buffers that shaders read as texels.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use std::borrow::Cow;

use glow::HasContext;

use super::error::GpuError;
use super::gl::Gl;
use super::object::{Buffer, Texture};

/// The texel format of a texture buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BufferTexel {
    /// Four words: a `usamplerBuffer`.
    Rgba32U,
    /// One float: a `samplerBuffer`.
    R32F,
    /// Four floats: a `samplerBuffer`.
    Rgba32F,
}

/// A buffer and the texture that reads it.
pub(super) struct TextureBuffer {
    gl: Gl,
    texture: Texture,
    buffer: Buffer,
}

impl TextureBuffer {
    /// A texture buffer that holds these bytes.
    ///
    /// # Errors
    /// [`GpuError::Object`] if the driver has no object left.
    pub(super) fn new(gl: &Gl, texel: BufferTexel, bytes: &[u8]) -> Result<Self, GpuError> {
        let format = match texel {
            BufferTexel::Rgba32U => glow::RGBA32UI,
            BufferTexel::R32F => glow::R32F,
            BufferTexel::Rgba32F => glow::RGBA32F,
        };
        let (texture, buffer) = (Texture::new(gl)?, Buffer::new(gl)?);
        // SAFETY: both names are ours, made in the current context.
        unsafe {
            gl.bind_buffer(glow::TEXTURE_BUFFER, Some(buffer.native()));
            gl.buffer_data_u8_slice(glow::TEXTURE_BUFFER, &padded(bytes), glow::STATIC_DRAW);
            gl.bind_texture(glow::TEXTURE_BUFFER, Some(texture.native()));
            gl.tex_buffer(glow::TEXTURE_BUFFER, format, Some(buffer.native()));
        }
        Ok(Self { gl: gl.clone(), texture, buffer })
    }

    /// The driver's name of the texture.
    pub(super) fn texture(&self) -> glow::NativeTexture {
        self.texture.native()
    }

    /// Replaces its content, for a frame.
    pub(super) fn replace(&self, bytes: &[u8]) {
        // SAFETY: the buffer is ours.
        unsafe {
            self.gl.bind_buffer(glow::TEXTURE_BUFFER, Some(self.buffer.native()));
            self.gl.buffer_data_u8_slice(glow::TEXTURE_BUFFER, &padded(bytes), glow::STREAM_DRAW);
        }
    }
}

/// Most bytes of a texel.
const TEXEL_BYTES: usize = 16;

/// The bytes, with a texel appended if their number is a power of two. Mesa's software renderers compile a program
/// once more for buffers of such sizes, which tapes and regions have now and then by chance: in the middle of a show,
/// for seconds.
fn padded(bytes: &[u8]) -> Cow<'_, [u8]> {
    if bytes.len().is_power_of_two() {
        // One texel and one more would make two, again a power of two.
        let more = if bytes.len() == TEXEL_BYTES { 2 } else { 1 };
        Cow::Owned([bytes, &vec![0; more * TEXEL_BYTES]].concat())
    } else {
        Cow::Borrowed(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_buffer_whose_size_was_a_power_of_two_was_compiled_for_once_more() {
        for bytes in [16, 1024, 1 << 16] {
            let buffer = vec![1; bytes];
            let stored = padded(&buffer);
            assert!(!stored.len().is_power_of_two() && stored.starts_with(&buffer));
        }
        assert_eq!(padded(&[1; 48]).len(), 48);
    }
}
