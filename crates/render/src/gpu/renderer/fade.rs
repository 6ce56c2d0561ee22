//! Fades one picture into the next: mixes the light of an earlier picture into new ones, before the tone map.

use crate::gpu::target::Target;

/// The light of an earlier picture.
pub(super) struct Fade {
    light: Target,
    share: f32,
}

impl Fade {
    /// With a share of 1.
    pub(super) fn of(light: Target) -> Self {
        Self { light, share: 1.0 }
    }

    /// The light, and its share of new pictures, 0..1.
    pub(super) fn mixed_in(&self) -> (&Target, f32) {
        (&self.light, self.share)
    }

    /// Sets the share of new pictures, 0..1.
    pub(super) fn set_share(&mut self, share: f32) {
        self.share = share.clamp(0.0, 1.0);
    }

    /// The target, for reuse.
    pub(super) fn into_light(self) -> Target {
        self.light
    }
}
