//! Fades between images: mixes the light of an earlier image into new images, before the tone map.

use crate::gpu::target::Target;

pub(super) struct Fade {
    light: Target,
    fraction: f32,
}

impl Fade {
    pub(super) fn of(light: Target) -> Self {
        Self { light, fraction: 1.0 }
    }

    pub(super) fn mixed_in(&self) -> (&Target, f32) {
        (&self.light, self.fraction)
    }

    pub(super) fn set_fraction(&mut self, fraction: f32) {
        self.fraction = fraction.clamp(0.0, 1.0);
    }

    pub(super) fn into_light(self) -> Target {
        self.light
    }
}
