//! Flashes of finished pictures, limited where they are shown or in a copy.

use crate::gpu::error::GpuError;
use crate::gpu::flash_pass::FlashPass;
use crate::gpu::gl::Gl;
use crate::gpu::target::{Target, Texel};

/// See the module.
#[derive(Default)]
pub(super) struct Flashes {
    /// The limiter, if there is one.
    pub(super) pass: Option<FlashPass>,
    /// Whether it has taken the finished picture.
    is_limited: bool,
    /// A copy of the picture with its flashes limited.
    copy: Option<Target>,
    /// Whether the copy is of what shows now.
    has_copy: bool,
}

impl Flashes {
    /// Nothing is limited any more.
    pub(super) fn remove(&mut self) {
        self.pass = None;
        self.is_limited = false;
    }

    /// There is a picture that the limiter has not taken.
    pub(super) fn expect_another(&mut self) {
        self.is_limited = false;
    }

    /// The copy is no longer of what shows.
    pub(super) fn forget_copy(&mut self) {
        self.has_copy = false;
    }

    /// Takes a picture that is shown `seconds` after the last one, and decides what to dim in it.
    pub(super) fn take(&mut self, picture: &Target, seconds: f64) {
        if let Some(pass) = &mut self.pass {
            pass.take(picture, seconds);
            self.is_limited = true;
            self.has_copy = false;
        }
    }

    /// The limiter, if it has taken the picture that shows.
    pub(super) fn limiting(&self) -> Option<&FlashPass> {
        self.pass.as_ref().filter(|_| self.is_limited)
    }

    /// The copy with flashes limited, if there is one of what shows.
    pub(super) fn limited(&self) -> Option<&Target> {
        self.copy.as_ref().filter(|_| self.is_limited && self.has_copy)
    }

    /// Makes the copy of `picture` in which flashes are limited, if there is none yet and they are limited.
    ///
    /// # Errors
    /// No room for it.
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
