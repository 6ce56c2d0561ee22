//! Render targets: textures that passes draw into.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use std::rc::Rc;

use glow::HasContext;

use super::api::Api;
use super::error::{GpuError, Result};
use super::gl::Gl;
use super::object::{Buffer, Framebuffer, Renderbuffer, Texture};
use crate::faults::{self, Fault};

/// A framebuffer with its colour textures, all of one size, and optionally a stencil.
pub struct Target {
    gl: Gl,
    framebuffer: Framebuffer,
    colors: Vec<Texture>,
    // Freed after the framebuffer that uses it.
    _stencil: Option<Rc<Stencil>>,
    size: (u32, u32),
}

/// The texel format of a colour attachment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Texel {
    /// One byte, stored without conversion.
    R8,
    /// A 16-bit float.
    R16F,
    /// A 32-bit float.
    R32F,
    /// Four bytes, stored without conversion.
    Rgba8,
    /// Four 16-bit floats.
    Rgba16F,
    /// Four 32-bit floats.
    Rgba32F,
}

impl Texel {
    /// The stored format, and the format and kind of the values that OpenGL ES requires for it.
    fn formats(self) -> (u32, u32, u32) {
        match self {
            Texel::R8 => (glow::R8, glow::RED, glow::UNSIGNED_BYTE),
            Texel::R16F => (glow::R16F, glow::RED, glow::HALF_FLOAT),
            Texel::R32F => (glow::R32F, glow::RED, glow::FLOAT),
            Texel::Rgba8 => (glow::RGBA8, glow::RGBA, glow::UNSIGNED_BYTE),
            Texel::Rgba16F => (glow::RGBA16F, glow::RGBA, glow::HALF_FLOAT),
            Texel::Rgba32F => (glow::RGBA32F, glow::RGBA, glow::FLOAT),
        }
    }
}

/// A depth and stencil buffer for a target.
pub struct Stencil(Renderbuffer);

impl Stencil {
    /// Creates a depth and stencil buffer of `size` pixels.
    ///
    /// # Errors
    /// [`GpuError::Object`] if the driver cannot create another object.
    pub fn new(gl: &Gl, size: (u32, u32)) -> Result<Self> {
        let buffer = Renderbuffer::new(gl)?;
        // SAFETY: the renderbuffer was just created in the current context. The target checks sizes against the
        // driver's limit.
        unsafe {
            gl.bind_renderbuffer(glow::RENDERBUFFER, Some(buffer.native()));
            let [width, height] = [size.0, size.1].map(u32::cast_signed);
            gl.renderbuffer_storage(glow::RENDERBUFFER, glow::DEPTH24_STENCIL8, width, height);
        }
        Ok(Self(buffer))
    }
}

impl Target {
    /// Checks that the driver supports targets of `size` pixels.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] if the size exceeds the driver's limit.
    pub fn check_size(gl: &Gl, size: (u32, u32)) -> Result<()> {
        let limit = gl.info().texture_side_max;
        if size.0 > limit || size.1 > limit {
            return Err(GpuError::TooLarge { width: size.0, height: size.1, limit });
        }
        Ok(())
    }

    /// Creates a target of `size` pixels with a colour texture for each of `texels`.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] if `size` exceeds the driver's limit, [`GpuError::Object`] if the driver rejects the
    /// combination.
    pub fn new(gl: &Gl, size: (u32, u32), texels: &[Texel], stencil: Option<Rc<Stencil>>) -> Result<Self> {
        Self::check_size(gl, size)?;
        if faults::strikes(Fault::NoTarget) {
            let reason = "no memory is left (a fault injected by a test)".to_owned();
            return Err(GpuError::Object { what: "a render target", reason });
        }
        Self::made(gl, size, texels, stencil)
    }

    /// Creates a target for linear light, which is filtered linearly.
    ///
    /// # Errors
    /// Same errors as [`Target::new`].
    pub fn of_light(gl: &Gl, size: (u32, u32)) -> Result<Self> {
        Ok(Self::new(gl, size, &[Texel::Rgba16F], None)?.smooth())
    }

    /// Creates a target that replaces a window of `size` pixels. Injected faults do not affect it.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] if `size` exceeds the driver's limit, [`GpuError::Object`] if the driver refuses.
    pub fn of_window(gl: &Gl, size: (u32, u32)) -> Result<Self> {
        Self::check_size(gl, size)?;
        Self::made(gl, size, &[Texel::Rgba8], None)
    }

    fn made(gl: &Gl, size: (u32, u32), texels: &[Texel], stencil: Option<Rc<Stencil>>) -> Result<Self> {
        let framebuffer = Framebuffer::new(gl)?;
        let mut colors = Vec::with_capacity(texels.len());
        // SAFETY: all names were just created in the current context, and no data is passed.
        unsafe {
            gl.bind_framebuffer(glow::FRAMEBUFFER, Some(framebuffer.native()));
            let mut attachments = Vec::with_capacity(texels.len());
            for (texel, attachment) in texels.iter().zip(glow::COLOR_ATTACHMENT0..) {
                let texture = Texture::new(gl)?;
                let (kind, name) = (glow::TEXTURE_2D, Some(texture.native()));
                gl.bind_texture(kind, name);
                gl.store_level(0, texel.formats(), size, None);
                gl.filter(kind, glow::NEAREST);
                for side in [glow::TEXTURE_WRAP_S, glow::TEXTURE_WRAP_T] {
                    gl.tex_parameter_i32(kind, side, glow::CLAMP_TO_EDGE.cast_signed());
                }
                gl.framebuffer_texture_2d(glow::FRAMEBUFFER, attachment, kind, name, 0);
                attachments.push(attachment);
                colors.push(texture);
            }
            if let Some(stencil) = &stencil {
                let (place, kind) = (glow::DEPTH_STENCIL_ATTACHMENT, glow::RENDERBUFFER);
                gl.framebuffer_renderbuffer(glow::FRAMEBUFFER, place, kind, Some(stencil.0.native()));
            }
            gl.draw_buffers(&attachments);
        }
        gl.check_framebuffer("a render target", &texels)?;
        gl.check("making a render target")?;
        Ok(Self { gl: gl.clone(), framebuffer, colors, _stencil: stencil, size })
    }

    /// Enables linear filtering of colour texture 0.
    pub fn smooth(self) -> Self {
        // SAFETY: `self` owns the texture, which belongs to the current context.
        unsafe { self.gl.bind_texture(glow::TEXTURE_2D, self.texture()) }
        self.gl.filter(glow::TEXTURE_2D, glow::LINEAR);
        self
    }

    /// Width and height in pixels.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    pub(super) fn colors(&self) -> usize {
        self.colors.len()
    }

    /// Directs the following draws to the whole target.
    pub fn bind(&self) {
        self.gl.bind_output(Some(self.native()), self.size);
    }

    /// Binds colour texture `index` to texture unit `unit`.
    pub fn bind_color(&self, index: usize, unit: u32) {
        self.gl.bind_unit(unit, glow::TEXTURE_2D, self.colors.get(index).map(Texture::native));
    }

    /// Fills all colours with 0.
    pub(super) fn clear(&self) {
        self.bind();
        // SAFETY: clears the target bound above, in the current context.
        unsafe {
            self.gl.clear_color(0.0, 0.0, 0.0, 0.0);
            self.gl.clear(glow::COLOR_BUFFER_BIT);
        }
    }

    /// The name of colour texture 0.
    pub(super) fn texture(&self) -> Option<glow::Texture> {
        self.colors.first().map(Texture::native)
    }

    pub(super) fn native(&self) -> glow::Framebuffer {
        self.framebuffer.native()
    }

    /// Copies colour attachment 0 to the window's framebuffer of `window` pixels. Enlarges it if the window is larger.
    pub fn blit_to_window(&self, window: (u32, u32)) {
        self.blit(self.gl.window(), window);
    }

    /// Copies colour attachment 0 to colour attachment 0 of another target.
    pub fn blit_to(&self, other: &Target) {
        self.blit(Some(other.framebuffer.native()), other.size);
    }

    fn blit(&self, other: Option<glow::Framebuffer>, size: (u32, u32)) {
        let filter = if size == self.size { glow::NEAREST } else { glow::LINEAR };
        let [width, height] = [self.size.0, self.size.1].map(u32::cast_signed);
        let [across, down] = [size.0, size.1].map(u32::cast_signed);
        self.gl.store_colors_unchanged();
        // SAFETY: both framebuffers are complete and belong to the current context.
        unsafe {
            self.gl.bind_framebuffer(glow::READ_FRAMEBUFFER, Some(self.framebuffer.native()));
            self.gl.bind_framebuffer(glow::DRAW_FRAMEBUFFER, other);
            let colors = glow::COLOR_BUFFER_BIT;
            self.gl.blit_framebuffer(0, 0, width, height, 0, 0, across, down, colors, filter);
        }
    }

    /// Draws an image over colour attachment 0. `place` is the position of the image's left and upper edge. The image
    /// has `size` pixels of four bytes, top row first. An image that does not fit is not drawn at all.
    pub fn put_rgba8(&self, place: (u32, u32), size: (u32, u32), rgba: &[u8]) {
        let row = size.0 as usize * 4;
        let fits = place.0 + size.0 <= self.size.0 && place.1 + size.1 <= self.size.1;
        let Some(texture) = self.colors.first().filter(|_| fits && rgba.len() == row * size.1 as usize)
        else {
            return;
        };
        let mut bytes = rgba.to_vec();
        flip_rows(&mut bytes, row);
        let y = self.size.1 - place.1 - size.1;
        // SAFETY: `self` owns the texture, the area is inside it, and `bytes` holds exactly the area's texels, as
        // checked above.
        unsafe {
            self.gl.bind_texture(glow::TEXTURE_2D, Some(texture.native()));
            self.gl.replace_area(Texel::Rgba8.formats(), [place.0, y, size.0, size.1], &bytes);
        }
    }

    /// Reads colour attachment `index` as bytes, four per pixel, top row first.
    pub fn read_rgba8(&self, index: u32) -> Vec<u8> {
        let row = self.size.0 as usize * 4;
        let mut bytes = vec![0; row * self.size.1 as usize];
        self.read(index, glow::RGBA, glow::UNSIGNED_BYTE, &mut bytes);
        flip_rows(&mut bytes, row);
        bytes
    }

    /// Reads the red channel of the last colour attachment as floats, lowest row first.
    pub fn read_last_red32f(&self) -> Vec<f32> {
        let last = self.colors.len().saturating_sub(1) as u32;
        let words = self.read_red_of::<4>(last, glow::FLOAT);
        words.into_iter().map(f32::from_ne_bytes).collect()
    }

    /// Reads the red channel of colour attachment 0 as bytes, lowest row first.
    pub fn read_red(&self) -> Vec<u8> {
        self.read_red_of::<1>(0, glow::UNSIGNED_BYTE).into_flattened()
    }

    /// Reads red values of `BYTES` bytes. OpenGL ES guarantees only that all four channels can be read.
    fn read_red_of<const BYTES: usize>(&self, index: u32, kind: u32) -> Vec<[u8; BYTES]> {
        let (format, channels) = match self.gl.info().api {
            Api::Desktop => (glow::RED, 1),
            Api::Embedded => (glow::RGBA, 4),
        };
        let mut bytes = vec![0; channels * BYTES * self.size.0 as usize * self.size.1 as usize];
        self.read(index, format, kind, &mut bytes);
        bytes.as_chunks().0.iter().step_by(channels).copied().collect()
    }

    /// Reads colour attachment `index` as floats, four per pixel, top row first.
    pub fn read_rgba32f(&self, index: u32) -> Vec<f32> {
        let row = self.size.0 as usize * 4;
        let mut bytes = vec![0; row * 4 * self.size.1 as usize];
        self.read(index, glow::RGBA, glow::FLOAT, &mut bytes);
        let (words, _) = bytes.as_chunks::<4>();
        let mut floats: Vec<f32> = words.iter().map(|word| f32::from_ne_bytes(*word)).collect();
        flip_rows(&mut floats, row);
        floats
    }

    /// Copies colour attachment 0 into a driver buffer, four bytes per pixel, lowest row first.
    pub(super) fn read_into(&self, buffer: &Buffer) {
        // SAFETY: both objects belong to the current context; the caller provides a buffer with four bytes per pixel.
        unsafe {
            self.gl.bind_buffer(glow::PIXEL_PACK_BUFFER, Some(buffer.native()));
            self.read_pixels(0, glow::RGBA, glow::UNSIGNED_BYTE, glow::PixelPackData::BufferOffset(0));
            self.gl.bind_buffer(glow::PIXEL_PACK_BUFFER, None);
        }
    }

    fn read(&self, index: u32, format: u32, kind: u32, bytes: &mut [u8]) {
        // SAFETY: the callers pass a slice that holds exactly the texels in this format.
        unsafe { self.read_pixels(index, format, kind, glow::PixelPackData::Slice(Some(bytes))) }
    }

    /// Reads colour attachment `index`.
    ///
    /// # Safety
    /// `to` must have room for all texels in this format.
    // SAFETY: the duties of the caller are above.
    unsafe fn read_pixels(&self, index: u32, format: u32, kind: u32, to: glow::PixelPackData<'_>) {
        let [width, height] = [self.size.0, self.size.1].map(u32::cast_signed);
        // SAFETY: `self` owns the framebuffer, and the caller guarantees the room.
        unsafe {
            self.gl.bind_framebuffer(glow::READ_FRAMEBUFFER, Some(self.framebuffer.native()));
            self.gl.read_buffer(glow::COLOR_ATTACHMENT0 + index);
            self.gl.pixel_store_i32(glow::PACK_ALIGNMENT, 1);
            self.gl.read_pixels(0, 0, width, height, format, kind, to);
            self.gl.read_buffer(glow::COLOR_ATTACHMENT0);
        }
    }
}

/// Reverses the order of rows. OpenGL's first row is the lowest row, an image's first row is the top row.
fn flip_rows<T: Copy>(values: &mut [T], row: usize) {
    if row == 0 {
        return;
    }
    let rows = values.len() / row;
    for y in 0..rows / 2 {
        let (upper, lower) = values.split_at_mut((rows - 1 - y) * row);
        upper[y * row..(y + 1) * row].swap_with_slice(&mut lower[..row]);
    }
}

#[cfg(test)]
mod tests {
    use super::flip_rows;

    #[test]
    fn rows_are_flipped_for_odd_and_even_heights() {
        let mut odd = [1, 2, 3, 4, 5, 6];
        flip_rows(&mut odd, 2);
        assert_eq!(odd, [5, 6, 3, 4, 1, 2]);
        let mut even = [1, 2, 3, 4];
        flip_rows(&mut even, 2);
        assert_eq!(even, [3, 4, 1, 2]);
    }
}
