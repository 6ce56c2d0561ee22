//! The state of the paths of light of an area, which a pass of `path.frag` reads and another one writes.

#![expect(unsafe_code, reason = "every OpenGL call is unsafe in glow")]

use glow::HasContext;

use super::error::GpuError;
use super::gl::Gl;
use super::kept_paths::{KeptPaths, LAYERS, TEXEL, Tag};
use super::object::{Framebuffer, Texture};
use super::program::unit_of;
use super::target::Target;

/// Two states, one of which is the current one.
pub(super) struct PathState {
    gl: Gl,
    states: [(Framebuffer, Texture); 2],
    current: usize,
    size: (u32, u32),
}

impl PathState {
    /// Creates a state for `size` pixels.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] if the size exceeds the driver's limit, [`GpuError::Object`] if the driver has no memory for
    /// it or cannot draw 32-bit floats.
    pub(super) fn new(gl: &Gl, size: (u32, u32)) -> Result<Self, GpuError> {
        Target::check_size(gl, size)?;
        let states = [state(gl, size)?, state(gl, size)?];
        gl.check("making the state of paths")?;
        Ok(Self { gl: gl.clone(), states, current: 0, size })
    }

    pub(super) fn size(&self) -> (u32, u32) {
        self.size
    }

    /// Makes draws read the current state and write the other one.
    pub(super) fn bind(&self) {
        self.bind_current("path_state");
        let (framebuffer, _) = &self.states[1 - self.current];
        // SAFETY: `self` owns the complete framebuffer, which belongs to the current context.
        unsafe {
            self.gl.bind_framebuffer(glow::FRAMEBUFFER, Some(framebuffer.native()));
            self.gl.viewport(0, 0, self.size.0.cast_signed(), self.size.1.cast_signed());
        }
    }

    /// Makes draws read the current state as the texture `name`.
    pub(super) fn bind_current(&self, name: &str) {
        let (_, texture) = &self.states[self.current];
        // SAFETY: `self` owns the texture, which belongs to the current context.
        unsafe {
            self.gl.active_texture(glow::TEXTURE0 + unit_of(name));
            self.gl.bind_texture(glow::TEXTURE_2D_ARRAY, Some(texture.native()));
        }
    }

    /// Makes the written state the current one.
    pub(super) fn swap(&mut self) {
        self.current = 1 - self.current;
    }

    /// Reads the number of finished paths of each pixel, lowest row first, and whether more follow.
    pub(super) fn read(&self) -> Vec<(u32, bool)> {
        let tag = |texel| {
            let tag = Tag::of(texel);
            (tag.paths(), !tag.is_finished())
        };
        self.layer(0).as_chunks::<TEXEL>().0.iter().map(tag).collect()
    }

    /// Reads the current state.
    pub(super) fn kept(&self) -> KeptPaths {
        KeptPaths { layers: std::array::from_fn(|layer| self.layer(layer as u32)) }
    }

    /// Reads the texels of a layer, lowest row first.
    fn layer(&self, layer: u32) -> Vec<u8> {
        let (framebuffer, _) = &self.states[self.current];
        let mut bytes = vec![0; TEXEL * self.size.0 as usize * self.size.1 as usize];
        // SAFETY: `self` owns the framebuffer, and the slice holds exactly its texels in this format.
        unsafe {
            self.gl.bind_framebuffer(glow::READ_FRAMEBUFFER, Some(framebuffer.native()));
            self.gl.read_buffer(glow::COLOR_ATTACHMENT0 + layer);
            self.gl.pixel_store_i32(glow::PACK_ALIGNMENT, 1);
            let pixels = glow::PixelPackData::Slice(Some(&mut bytes));
            let (width, height) = (self.size.0.cast_signed(), self.size.1.cast_signed());
            self.gl.read_pixels(0, 0, width, height, glow::RGBA, glow::FLOAT, pixels);
        }
        bytes
    }

    /// Fills the current state. Paths of another size are ignored.
    pub(super) fn fill(&self, kept: &KeptPaths) {
        let (_, texture) = &self.states[self.current];
        let [width, height] = [self.size.0, self.size.1].map(u32::cast_signed);
        let length = TEXEL * self.size.0 as usize * self.size.1 as usize;
        for (layer, bytes) in (0..).zip(&kept.layers).filter(|(_, bytes)| bytes.len() == length) {
            let pixels = glow::PixelUnpackData::Slice(Some(bytes));
            // SAFETY: `self` owns the texture, and the slice holds exactly the texels of a layer.
            unsafe {
                self.gl.active_texture(glow::TEXTURE0 + unit_of("path_state"));
                self.gl.bind_texture(glow::TEXTURE_2D_ARRAY, Some(texture.native()));
                self.gl.tex_sub_image_3d(
                    glow::TEXTURE_2D_ARRAY,
                    0,
                    0,
                    0,
                    layer,
                    width,
                    height,
                    1,
                    glow::RGBA,
                    glow::FLOAT,
                    pixels,
                );
            }
        }
    }
}

fn state(gl: &Gl, size: (u32, u32)) -> Result<(Framebuffer, Texture), GpuError> {
    let (framebuffer, texture) = (Framebuffer::new(gl)?, Texture::new(gl)?);
    // SAFETY: both names were just created in the current context, and no data is passed.
    unsafe {
        gl.bind_texture(glow::TEXTURE_2D_ARRAY, Some(texture.native()));
        let [width, height, layers] = [size.0, size.1, LAYERS as u32].map(u32::cast_signed);
        let none = glow::PixelUnpackData::Slice(None);
        let format = glow::RGBA32F.cast_signed();
        gl.tex_image_3d(
            glow::TEXTURE_2D_ARRAY,
            0,
            format,
            width,
            height,
            layers,
            0,
            glow::RGBA,
            glow::FLOAT,
            none,
        );
        for name in [glow::TEXTURE_MIN_FILTER, glow::TEXTURE_MAG_FILTER] {
            gl.tex_parameter_i32(glow::TEXTURE_2D_ARRAY, name, glow::NEAREST.cast_signed());
        }
        gl.bind_framebuffer(glow::FRAMEBUFFER, Some(framebuffer.native()));
        let attachments: Vec<u32> = (0..LAYERS as u32).map(|layer| glow::COLOR_ATTACHMENT0 + layer).collect();
        for (layer, attachment) in (0..).zip(&attachments) {
            let texture = Some(texture.native());
            gl.framebuffer_texture_layer(glow::FRAMEBUFFER, *attachment, texture, 0, layer);
        }
        gl.draw_buffers(&attachments);
        let status = gl.check_framebuffer_status(glow::FRAMEBUFFER);
        if status != glow::FRAMEBUFFER_COMPLETE {
            let reason = format!("incomplete ({status:#06x})");
            return Err(GpuError::Object { what: "the state of paths", reason });
        }
    }
    Ok((framebuffer, texture))
}
