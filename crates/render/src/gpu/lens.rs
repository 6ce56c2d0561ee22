//! Depth of field: points that are out of focus are spread over discs. `scene.frag` writes the radius of each point's
//! disc. In an image of half the size, each pixel gathers the light of the discs that cover the pixel. Points with
//! discs smaller than a pixel stay sharp. The blur has no noise, so equal frames stay equal.

use super::error::GpuError;
use super::gl::Gl;
use super::passes::Passes;
use super::program::{LazyProgram, unit_of};
use super::target::{Target, Texel};
use crate::frame::picture::BLUR_MAX;

/// Maximum number of samples that a pixel gathers: `TAPS_MAX` of `lens_blur.frag`.
const TAPS_MAX: f32 = 80.0;

pub(super) struct LensBlur {
    pub(super) down: LazyProgram,
    pub(super) blur: LazyProgram,
    pub(super) mix: LazyProgram,
}

pub(super) struct LensTargets {
    smaller: Target,
    blurred: Target,
    light: Target,
}

impl LensBlur {
    /// Blurs light. Colour texture 1 of `samples` holds the radius of each point's disc.
    pub(super) fn draw<'a>(
        &self,
        passes: &Passes,
        light: &Target,
        samples: &Target,
        targets: &'a LensTargets,
    ) -> Result<&'a Target, GpuError> {
        let reach = (BLUR_MAX * targets.smaller.size().1 as f32).max(1.0);
        let taps = (0.4 * reach * reach + 12.0).min(TAPS_MAX).floor();
        light.bind_color(0, unit_of("picture"));
        samples.bind_color(1, unit_of("spreads"));
        passes.draw(&self.down, &targets.smaller)?;
        targets.smaller.bind_color(0, unit_of("picture"));
        passes.draw_with(&self.blur, &targets.blurred, [reach, taps])?;
        light.bind_color(0, unit_of("picture"));
        targets.blurred.bind_color(0, unit_of("blurred"));
        passes.draw(&self.mix, &targets.light)?;
        Ok(&targets.light)
    }
}

impl LensTargets {
    pub(super) fn new(gl: &Gl, size: (u32, u32)) -> Result<Self, GpuError> {
        let target = |size| Ok::<_, GpuError>(Target::new(gl, size, &[Texel::Rgba16F], None)?.smooth());
        let half = (size.0.div_ceil(2), size.1.div_ceil(2));
        Ok(Self { smaller: target(half)?, blurred: target(half)?, light: target(size)? })
    }
}
