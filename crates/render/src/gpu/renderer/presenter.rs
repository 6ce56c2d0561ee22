//! Presents finished images: dims them, limits their flashes and places them in windows. An undimmed image that fills
//! its window is copied byte for byte.

use super::flashes::Flashes;
use super::placing::Placing;
use crate::gpu::error::GpuError;
use crate::gpu::gl::Gl;
use crate::gpu::passes::Passes;
use crate::gpu::picture_reader::PictureReader;
use crate::gpu::program::{LazyProgram, unit_of};
use crate::gpu::shader_source::{ShaderLibrary, Variant};
use crate::gpu::target::Target;
use crate::placement::{Area, Map};

/// The shader that enlarges an image for a window.
pub const UPSCALE_SHADER: &str = "upscale.frag";

#[derive(Default)]
pub(super) struct Presenter {
    /// Enlarges images for a window; `None` without a window.
    upscale: Option<LazyProgram>,
    pub(super) placing: Option<Placing>,
    pub(super) flashes: Flashes,
}

impl Presenter {
    pub(super) fn prepare_for_window(&mut self, gl: &Gl, library: &ShaderLibrary) -> Result<(), GpuError> {
        self.upscale = Some(LazyProgram::new(gl, library, UPSCALE_SHADER, &Variant::default())?);
        Ok(())
    }

    pub(super) fn is_for_window(&self) -> bool {
        self.upscale.is_some()
    }

    pub(super) fn dim(
        &mut self,
        passes: &Passes,
        finished: Option<&Target>,
        gain: f32,
    ) -> Result<(), GpuError> {
        let Some(placing) = &mut self.placing else { return Ok(()) };
        if self.upscale.is_some() {
            self.flashes.forget_copy();
        }
        placing.dim(passes, finished, gain)
    }

    pub(super) fn limit_flashes(
        &mut self,
        gl: &Gl,
        finished: Option<&Target>,
        seconds: f64,
    ) -> Result<(), GpuError> {
        let Self { upscale, placing, flashes } = self;
        let Some(picture) = bright(placing.as_ref(), finished) else { return Ok(()) };
        flashes.measure(picture, seconds);
        if upscale.is_none() { flashes.make_copy(gl, picture) } else { Ok(()) }
    }

    pub(super) fn show(
        &self,
        passes: &Passes,
        finished: Option<&Target>,
        window: (u32, u32),
    ) -> Result<(), GpuError> {
        let Some(picture) = bright(self.placing.as_ref(), finished) else { return Ok(()) };
        if self.upscale.is_some() && picture.size() != window {
            self.enlarge(passes, picture, window, None)?;
        } else {
            picture.blit_to_window(window);
        }
        if let Some(limiter) = self.flashes.limiting() {
            limiter.limit_in_window(picture, window);
        }
        Ok(())
    }

    /// Enlarges an image to the window's framebuffer of `window` pixels, or to an area of it.
    fn enlarge(
        &self,
        passes: &Passes,
        picture: &Target,
        window: (u32, u32),
        area: Option<[i32; 4]>,
    ) -> Result<(), GpuError> {
        let Some(upscale) = &self.upscale else { return Ok(()) };
        picture.bind_color(0, unit_of("picture"));
        passes.bind_vertices();
        passes.draw_in_window(upscale, window, area)
    }

    pub(super) fn show_in_part(
        &mut self,
        passes: &Passes,
        finished: Option<&Target>,
        window: (u32, u32),
        area: Area,
        map: &Map,
        part: Area,
    ) -> Result<(), GpuError> {
        let Some((placing, picture)) = self.placed(passes, finished)? else { return Ok(()) };
        placing.place(passes, picture, window, area, map, part)
    }

    /// Sends an image to `reader`. Returns `false` if the reader is still busy with earlier images.
    pub(super) fn send(
        &mut self,
        passes: &Passes,
        finished: Option<&Target>,
        reader: &mut PictureReader,
        map: &Map,
        part: Area,
    ) -> Result<bool, GpuError> {
        let Some((placing, picture)) = self.placed(passes, finished)? else { return Ok(false) };
        placing.place_in(passes, picture, reader.target(), map, part)?;
        Ok(reader.begin())
    }

    fn placed<'a>(
        &'a mut self,
        passes: &Passes,
        finished: Option<&'a Target>,
    ) -> Result<Option<(&'a Placing, &'a Target)>, GpuError> {
        let Self { placing, flashes, .. } = self;
        let Some(picture) = bright(placing.as_ref(), finished) else { return Ok(None) };
        flashes.make_copy(&passes.gl, picture)?;
        Ok(placing.as_ref().map(|placing| (placing, flashes.limited().unwrap_or(picture))))
    }

    pub(super) fn read(&self, finished: Option<&Target>) -> Vec<u8> {
        let shown = self.flashes.limited().or(bright(self.placing.as_ref(), finished));
        shown.map_or_else(Vec::new, |picture| picture.read_rgba8(0))
    }

    /// Draws once with every program that a window's first image needs, until `is_wanted` returns false.
    pub(super) fn warm_up(
        &mut self,
        passes: &Passes,
        finished: &Target,
        is_wanted: &mut dyn FnMut() -> bool,
    ) -> Result<(), GpuError> {
        self.enlarge(passes, finished, finished.size(), Some([0; 4]))?;
        self.flashes.pass.iter_mut().for_each(|pass| pass.warm_up(finished, is_wanted));
        Ok(())
    }
}

/// The dimmed image, or the finished image at full brightness. Its flashes are not limited yet.
fn bright<'a>(placing: Option<&'a Placing>, finished: Option<&'a Target>) -> Option<&'a Target> {
    placing.and_then(Placing::dimmed).or(finished)
}
