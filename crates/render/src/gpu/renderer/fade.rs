//! Fades one picture into the next: mixes the light of an earlier picture into new ones, before the tone map.

use crate::gpu::target::Target;

/// The light of an earlier picture.
pub(super) struct Fade {
    light: Target,
    fraction: f32,
}

impl Fade {
    /// With a share of 1.
    pub(super) fn of(light: Target) -> Self {
        Self { light, fraction: 1.0 }
    }

    /// The light, and its share of new pictures, 0..1.
    pub(super) fn mixed_in(&self) -> (&Target, f32) {
        (&self.light, self.fraction)
    }

    /// Sets the share of new pictures, 0..1.
    pub(super) fn set_fraction(&mut self, fraction: f32) {
        self.fraction = fraction.clamp(0.0, 1.0);
    }

    /// The target, for reuse.
    pub(super) fn into_light(self) -> Target {
        self.light
    }
}
