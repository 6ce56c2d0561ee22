//! The pass of media: fog, smoke and clouds, in half of the frame's width and height.
//!
//! `scene.frag` computes the light of the media along each ray, with few steps at different places in neighbouring
//! rays. `media_filter.frag` computes the mean of neighbouring rays, and every sample of the frame reads that mean.

use super::error::Result;
use super::gl::Gl;
use super::passes::Passes;
use super::program::{LazyProgram, unit_of};
use super::shader_source::{ShaderLibrary, Variant};
use super::target::{Target, Texel};
use crate::frame::block::block_defines;

/// The shader that computes the mean of neighbouring rays.
pub const MEDIA_FILTER_SHADER: &str = "media_filter.frag";

/// The shader variant of [`MEDIA_FILTER_SHADER`].
pub fn media_filter_variant() -> Variant {
    Variant { defines: block_defines().into(), ..Variant::default() }
}

pub(super) struct MediaFilter(LazyProgram);

/// The light of media, what is left of the light behind them, and the ends of rays.
pub(super) struct MediaTargets {
    pub(super) rays: Target,
    pub(super) mean: Target,
}

impl MediaFilter {
    pub(super) fn new(gl: &Gl, library: &ShaderLibrary) -> Result<Self> {
        Ok(Self(LazyProgram::new(gl, library, MEDIA_FILTER_SHADER, &media_filter_variant())?))
    }

    pub(super) fn draw(&self, passes: &Passes, targets: &MediaTargets) -> Result<()> {
        bind(&targets.rays);
        passes.draw(&self.0, &targets.mean)
    }
}

impl MediaTargets {
    /// Creates targets for frames of `size` pixels. `texels` are the outputs of the scene's program, `layers` the
    /// number of layers.
    pub(super) fn new(gl: &Gl, size: (u32, u32), texels: &[Texel], layers: u32) -> Result<Self> {
        let half = (size.0.div_ceil(2), size.1.div_ceil(2));
        let mut texels = texels.to_vec();
        // On software renderers the target of beams, which is also the last one, holds the ends of rays: their drivers
        // compile a program once for each combination of formats.
        if !gl.info().software {
            texels.push(Texel::R32F);
        }
        Ok(Self {
            rays: Target::new(gl, (half.0, half.1 * layers), &texels, None)?,
            mean: Target::new(gl, half, &[Texel::Rgba16F, Texel::R32F], None)?,
        })
    }

    /// Binds the means, which the scene's program reads.
    pub(super) fn bind_mean(&self) {
        bind(&self.mean);
    }
}

fn bind(target: &Target) {
    target.bind_color(0, unit_of("medium_light"));
    target.bind_color(target.colors().saturating_sub(1), unit_of("medium_end"));
}
