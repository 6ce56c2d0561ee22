//! Limits the flashes of finished images, in the window or in a copy.

use crate::gpu::error::GpuError;
use crate::gpu::flash_pass::FlashPass;
use crate::gpu::gl::Gl;
use crate::gpu::target::{Target, Texel};

#[derive(Default)]
pub(super) struct Flashes {
    pub(super) pass: Option<FlashPass>,
    is_limited: bool,
    copy: Option<Target>,
    has_copy: bool,
}

impl Flashes {
    pub(super) fn remove(&mut self) {
        self.pass = None;
        self.is_limited = false;
    }

    pub(super) fn expect_another(&mut self) {
        self.is_limited = false;
    }

    pub(super) fn forget_copy(&mut self) {
        self.has_copy = false;
    }

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
    pub(super) fn make_copy(&mut self, gl: &Gl, picture: &Target) -> Result<(), GpuError> {
        if self.has_copy || !self.is_limited {
            return Ok(());
        }
        let room = self.copy.take();
        let Some(pass) = &self.pass else { return Ok(()) };
        let copy = match room.filter(|copy| copy.size() == picture.size()) {
            Some(copy) => copy,
            None => Target::new(gl, picture.size(), &[Texel::Rgba8], None)?,
        };
        picture.blit_to(&copy);
        pass.limit(picture, &copy);
        self.copy = Some(copy);
        self.has_copy = true;
        Ok(())
    }
}
