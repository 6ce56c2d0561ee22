//! One picture fades into the next: a share of light that was kept is mixed into what is drawn, before the tone map.

use crate::gpu::target::Target;

/// Light that fades away.
pub(super) struct Fade {
    light: Target,
    share: f32,
}

impl Fade {
    /// All of a light.
    pub(super) fn of(light: Target) -> Self {
        Self { light, share: 1.0 }
    }

    /// The kept light, and its share of the picture.
    pub(super) fn mixed_in(&self) -> (&Target, f32) {
        (&self.light, self.share)
    }

    /// From now on the light has this share of pictures, 0..1.
    pub(super) fn set_share(&mut self, share: f32) {
        self.share = share.clamp(0.0, 1.0);
    }

    /// Its room for another light.
    pub(super) fn into_light(self) -> Target {
        self.light
    }
}
