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

pub(super) struct TextureBuffer {
    gl: Gl,
    texture: Texture,
    buffer: Buffer,
}

impl TextureBuffer {
    pub(super) fn new(gl: &Gl, texel: BufferTexel, bytes: &[u8]) -> Result<Self, GpuError> {
        let format = match texel {
            BufferTexel::Rgba32U => glow::RGBA32UI,
            BufferTexel::R32F => glow::R32F,
            BufferTexel::Rgba32F => glow::RGBA32F,
        };
        let (texture, buffer) = (Texture::new(gl)?, Buffer::new(gl)?);
        // SAFETY: texture and buffer were just created in the current context.
        unsafe {
            gl.bind_buffer(glow::TEXTURE_BUFFER, Some(buffer.native()));
            gl.buffer_data_u8_slice(glow::TEXTURE_BUFFER, &padded(bytes), glow::STATIC_DRAW);
            gl.bind_texture(glow::TEXTURE_BUFFER, Some(texture.native()));
            gl.tex_buffer(glow::TEXTURE_BUFFER, format, Some(buffer.native()));
        }
        Ok(Self { gl: gl.clone(), texture, buffer })
    }

    pub(super) fn texture(&self) -> glow::NativeTexture {
        self.texture.native()
    }

    pub(super) fn replace(&self, bytes: &[u8]) {
        // SAFETY: `self` owns the buffer, which belongs to the current context.
        unsafe {
            self.gl.bind_buffer(glow::TEXTURE_BUFFER, Some(self.buffer.native()));
            self.gl.buffer_data_u8_slice(glow::TEXTURE_BUFFER, &padded(bytes), glow::STREAM_DRAW);
        }
    }
}

const TEXEL_BYTES: usize = 16;

/// Pads the bytes if their length is unusual, because Mesa's software renderers would compile another variant of a
/// program, which takes seconds during a show. Powers of two are unusual, and lengths whose remainder modulo 65,536 is
/// below 256: Mesa reads the second byte of the length as the number of a texture's last mip level.
fn padded(bytes: &[u8]) -> Cow<'_, [u8]> {
    let length = bytes.len();
    let stored = if length & 0xff00 == 0 {
        (length & !0xffff) + 0x100 + TEXEL_BYTES
    } else if length.is_power_of_two() {
        length + TEXEL_BYTES
    } else {
        return Cow::Borrowed(bytes);
    };
    let mut stored_bytes = bytes.to_vec();
    stored_bytes.resize(stored, 0);
    Cow::Owned(stored_bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn buffer_sizes_that_need_another_program_are_padded() {
        for length in [0, 16, 48, 240, 256, 1024, 1 << 16, (1 << 16) + 16, (1 << 20) + 240] {
            let buffer = vec![1; length];
            let stored = padded(&buffer);
            assert!(!stored.len().is_power_of_two() && stored.len() % 65_536 >= 256, "{length}");
            assert!(stored.starts_with(&buffer) && stored.len() < length + 512);
        }
        assert_eq!(padded(&[1; 272]).len(), 272);
    }
}
