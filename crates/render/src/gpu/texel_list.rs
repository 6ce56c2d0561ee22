//! Lists of texels that shaders read by number (`shaders/texel_lists.glsl`): tapes, regions and sound tables.
//!
//! A list is a texture buffer. OpenGL ES 3.0 has no texture buffers, so there a list fills the rows of a texture.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use std::borrow::Cow;
use std::cell::Cell;

use glow::HasContext;

use super::api::Api;
use super::error::Result;
use super::gl::Gl;
use super::object::{Buffer, Texture};

/// The number of texels in a row is two to this power: every driver has textures of 2,048 texels a side.
pub const ROW_BITS: u32 = 11;

/// The texel format of a list.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ListTexel {
    /// Four words: a `WORD_LIST` in the shaders.
    Rgba32U,
    /// Four floats: a `NUMBER_LIST`.
    Rgba32F,
}

impl ListTexel {
    /// The stored format, the format and kind of the uploaded values, and the bytes of a texel.
    fn formats(self) -> (u32, u32, u32, usize) {
        match self {
            Self::Rgba32U => (glow::RGBA32UI, glow::RGBA_INTEGER, glow::UNSIGNED_INT, 16),
            Self::Rgba32F => (glow::RGBA32F, glow::RGBA, glow::FLOAT, 16),
        }
    }
}

pub(super) struct TexelList {
    gl: Gl,
    texel: ListTexel,
    texture: Texture,
    storage: Storage,
}

enum Storage {
    Buffer(Buffer),
    /// The number of rows of the texture.
    Rows(Cell<usize>),
}

impl TexelList {
    pub(super) fn new(gl: &Gl, texel: ListTexel, bytes: &[u8]) -> Result<Self> {
        let texture = Texture::new(gl)?;
        let target = target_of(gl.info().api);
        // SAFETY: binds a texture that was just created in the current context.
        unsafe { gl.bind_texture(target, Some(texture.native())) }
        let storage = match gl.info().api {
            Api::Desktop => {
                let buffer = Buffer::new(gl)?;
                // SAFETY: the buffer was just created in the current context, and the texture is bound.
                unsafe {
                    gl.bind_buffer(glow::TEXTURE_BUFFER, Some(buffer.native()));
                    gl.tex_buffer(target, texel.formats().0, Some(buffer.native()));
                }
                Storage::Buffer(buffer)
            }
            Api::Embedded => {
                gl.filter(target, glow::NEAREST);
                Storage::Rows(Cell::new(0))
            }
        };
        let list = Self { gl: gl.clone(), texel, texture, storage };
        list.replace(bytes);
        Ok(list)
    }

    pub(super) fn texture(&self) -> glow::Texture {
        self.texture.native()
    }

    pub(super) fn replace(&self, bytes: &[u8]) {
        match &self.storage {
            // SAFETY: `self` owns the buffer, which belongs to the current context.
            Storage::Buffer(buffer) => unsafe {
                self.gl.bind_buffer(glow::TEXTURE_BUFFER, Some(buffer.native()));
                self.gl.buffer_data_u8_slice(glow::TEXTURE_BUFFER, &padded(bytes), glow::STREAM_DRAW);
            },
            Storage::Rows(rows) => self.replace_rows(rows, bytes),
        }
    }

    /// Replaces the first texels and keeps the others. The list must be long enough.
    pub(super) fn replace_start(&self, bytes: &[u8]) {
        match &self.storage {
            // SAFETY: `self` owns the buffer, which belongs to the current context. OpenGL refuses bytes beyond its end.
            Storage::Buffer(buffer) => unsafe {
                self.gl.bind_buffer(glow::TEXTURE_BUFFER, Some(buffer.native()));
                self.gl.buffer_sub_data_u8_slice(glow::TEXTURE_BUFFER, 0, bytes);
            },
            Storage::Rows(rows) => self.replace_rows(rows, bytes),
        }
    }

    fn replace_rows(&self, rows: &Cell<usize>, bytes: &[u8]) {
        let gl = &self.gl;
        let (stored, format, kind, texel_bytes) = self.texel.formats();
        let row_bytes = texel_bytes << ROW_BITS;
        // SAFETY: `self` owns the texture, which belongs to the current context. Each slice has exactly the bytes of
        // its area, and the texture has the rows of all areas.
        unsafe {
            gl.bind_texture(glow::TEXTURE_2D, Some(self.texture.native()));
            let needed = rows_for(bytes.len().div_ceil(row_bytes));
            if needed > rows.get() {
                gl.store_level(0, (stored, format, kind), (1 << ROW_BITS, needed as u32), None);
                rows.set(needed);
            }
            let (whole, rest) = bytes.split_at(bytes.len() - bytes.len() % row_bytes);
            let height = (whole.len() / row_bytes) as u32;
            let of_rest = [0, height, (rest.len() / texel_bytes) as u32, 1];
            for (area, bytes) in [([0, 0, 1 << ROW_BITS, height], whole), (of_rest, rest)] {
                if !bytes.is_empty() {
                    gl.replace_area((stored, format, kind), area, bytes);
                }
            }
        }
    }
}

/// The longest list, in texels, on a driver with textures of `side_max` texels a side.
pub(super) fn texels_in_rows(side_max: u32) -> u32 {
    side_max.saturating_sub(1) << ROW_BITS
}

/// Binds a list's texture to a texture unit.
pub(super) fn bind(gl: &Gl, unit: u32, list: glow::Texture) {
    gl.bind_unit(unit, target_of(gl.info().api), Some(list));
}

fn target_of(api: Api) -> u32 {
    match api {
        Api::Desktop => glow::TEXTURE_BUFFER,
        Api::Embedded => glow::TEXTURE_2D,
    }
}

/// The number of rows of a texture with at least `rows`. It is never a power of two, because Mesa's software renderers
/// would compile another variant of a program.
fn rows_for(rows: usize) -> usize {
    let rows = rows.max(3);
    if rows.is_power_of_two() { rows + 1 } else { rows }
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

    #[test]
    fn the_longest_list_fits_the_texture() {
        for side_max in [2048, 4096, 16_384] {
            let rows = texels_in_rows(side_max) as usize >> ROW_BITS;
            assert!(rows_for(rows) <= side_max as usize && !rows_for(rows).is_power_of_two());
        }
        assert_eq!([1, 3, 4, 5, 2048].map(rows_for), [3, 3, 5, 5, 2049]);
    }
}
