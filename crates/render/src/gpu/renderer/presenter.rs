//! Presents finished images: dims them, limits their flashes and places them in windows. An undimmed image that fills
//! its window is copied byte for byte.

use super::placing::Placing;
use crate::gpu::error::Result;
use crate::gpu::flash_pass::FlashPass;
use crate::gpu::gl::Gl;
use crate::gpu::passes::Passes;
use crate::gpu::program::{LazyProgram, unit_of};
use crate::gpu::target::{Target, Texel};

/// The shader that enlarges an image for a window.
pub const UPSCALE_SHADER: &str = "upscale.frag";

#[derive(Default)]
pub(super) struct Presenter {
    /// Enlarges images for a window; `None` without a window.
    pub(super) upscale: Option<LazyProgram>,
    pub(super) placing: Option<Placing>,
    pub(super) flashes: Flashes,
}

impl Presenter {
    pub(super) fn dim(&mut self, passes: &Passes, finished: Option<&Target>, gain: f32) -> Result<()> {
        let Some(placing) = &mut self.placing else { return Ok(()) };
        if self.upscale.is_some() {
            self.flashes.has_copy = false;
        }
        placing.dim(passes, finished, gain)
    }

    pub(super) fn limit_flashes(&mut self, gl: &Gl, finished: Option<&Target>, seconds: f64) -> Result<()> {
        let Self { upscale, placing, flashes } = self;
        let Some(picture) = bright(placing.as_ref(), finished) else { return Ok(()) };
        flashes.measure(picture, seconds);
        if upscale.is_none() { flashes.make_copy(gl, picture) } else { Ok(()) }
    }

    pub(super) fn show(&self, passes: &Passes, finished: Option<&Target>, window: (u32, u32)) -> Result<()> {
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
    ) -> Result<()> {
        let Some(upscale) = &self.upscale else { return Ok(()) };
        picture.bind_color(0, unit_of("picture"));
        passes.draw_in_window(upscale, window, area)
    }

    /// The image with limited flashes and the programs that place it; `None` without either.
    pub(super) fn placed<'a>(
        &'a mut self,
        passes: &Passes,
        finished: Option<&'a Target>,
    ) -> Result<Option<(&'a Placing, &'a Target)>> {
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
    ) -> Result<()> {
        self.enlarge(passes, finished, finished.size(), Some([0; 4]))?;
        self.flashes.pass.iter_mut().for_each(|pass| pass.warm_up(finished, is_wanted));
        Ok(())
    }
}

/// The dimmed image, or the finished image at full brightness. Its flashes are not limited yet.
fn bright<'a>(placing: Option<&'a Placing>, finished: Option<&'a Target>) -> Option<&'a Target> {
    placing.and_then(|placing| placing.dimmed.as_ref()).or(finished)
}

// Fades between images: mixes the light of an earlier image into new images, before the tone map.

pub(super) struct Fade {
    pub(super) light: Target,
    pub(super) fraction: f32,
}

// Limits the flashes of finished images, in the window or in a copy.

#[derive(Default)]
pub(super) struct Flashes {
    pub(super) pass: Option<FlashPass>,
    pub(super) is_limited: bool,
    copy: Option<Target>,
    pub(super) has_copy: bool,
}

impl Flashes {
    pub(super) fn measure(&mut self, picture: &Target, seconds: f64) {
        if let Some(pass) = &mut self.pass {
            pass.measure(picture, seconds);
            self.is_limited = true;
            self.has_copy = false;
        }
    }

    pub(super) fn limiting(&self) -> Option<&FlashPass> {
        self.pass.as_ref().filter(|_| self.is_limited)
    }

    pub(super) fn limited(&self) -> Option<&Target> {
        self.copy.as_ref().filter(|_| self.is_limited && self.has_copy)
    }

    /// Copies `picture` and limits the flashes of the copy, unless the copy is up to date or limiting is off.
    pub(super) fn make_copy(&mut self, gl: &Gl, picture: &Target) -> Result<()> {
        if self.has_copy || !self.is_limited {
            return Ok(());
        }
        let room = self.copy.take().filter(|copy| copy.size() == picture.size());
        let Some(pass) = &self.pass else { return Ok(()) };
        let copy = room.map_or_else(|| Target::new(gl, picture.size(), &[Texel::Rgba8], None), Ok)?;
        picture.blit_to(&copy);
        pass.limit(picture, &copy);
        self.copy = Some(copy);
        self.has_copy = true;
        Ok(())
    }
}
