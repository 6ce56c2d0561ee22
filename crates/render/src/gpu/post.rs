//! Post-processing: passes from the scene's samples to the finished image.
//!
//! 1. `resolve.frag` turns the samples of each pixel into its light.
//! 2. `trails.frag` adds the trails of earlier frames (`trails`), in scenes that have trails.
//! 3. `lens_*.frag` blur points that are out of focus (`lens`), in scenes that have a lens.
//! 4. `bloom_down.frag` and `bloom_up.frag` scatter light (`bloom`).
//! 5. `present.frag` mixes in scattered light and a fading scene's light. Then it applies exposure and tone map,
//!    encodes as sRGB, and adds grain.
//!
//! The light has the size of the scene's targets. The finished image has the size of the output.
//!
//! **Light until the last pass.** Until `present.frag`, everything is linear light in 16-bit floats. Brighter samples
//! have a smaller weight in a pixel; otherwise one bright sample would dominate the pixels of an edge. AgX is the
//! default tone map, because it fades bright saturated colours to white, as film does. The AgX look is slightly more
//! saturated than neutral, because emissive scenes depend on colour. Noise does not change from frame to frame, so
//! still parts stay identical, bit for bit.

use super::bloom::{Bloom, BloomTargets};
use super::edge_samples::EdgeSamples;
use super::error::GpuError;
use super::gl::Gl;
use super::lens::{LensBlur, LensTargets};
use super::passes::Passes;
use super::program::{LazyProgram, unit_of};
use super::shader_source::{ShaderLibrary, Variant};
use super::target::{Target, Texel};
use super::trails::{TrailSource, Trails};
use crate::frame::picture::Picture;
use mariana_field::world::ToneMap;

/// The shaders of these passes and their defines. Tests compile all of them.
pub const POST_SHADERS: [(&str, &[&str]); 27] = [
    ("resolve.frag", &[]),
    ("resolve.frag", &["EDGE_LIST"]),
    ("resolve.frag", &["ALL_SAMPLES"]),
    ("lens_down.frag", &[]),
    ("lens_blur.frag", &[]),
    ("lens_mix.frag", &[]),
    ("bloom_down.frag", &["FIRST"]),
    ("bloom_down.frag", &[]),
    ("bloom_up.frag", &[]),
    ("trails.frag", &[]),
    ("trails.frag", &["KEPT"]),
    ("trails.frag", &["MIX"]),
    ("present.frag", &["TONE_MAP 0"]),
    ("present.frag", &["TONE_MAP 1"]),
    ("present.frag", &["TONE_MAP 2"]),
    ("present.frag", &["TONE_MAP 3"]),
    ("present.frag", &["TONE_MAP 0", "FADE"]),
    ("present.frag", &["TONE_MAP 1", "FADE"]),
    ("present.frag", &["TONE_MAP 2", "FADE"]),
    ("present.frag", &["TONE_MAP 3", "FADE"]),
    ("present.frag", &["TONE_MAP 3", "LIGHT"]),
    ("present.frag", &["TONE_MAP 3", "LIGHT", "MEAN"]),
    ("present.frag", &["TONE_MAP 3", "LIGHT", "MEAN", "FADE"]),
    ("present.frag", &["TONE_MAP 0", "MEAN"]),
    ("present.frag", &["TONE_MAP 1", "MEAN"]),
    ("present.frag", &["TONE_MAP 2", "MEAN"]),
    ("present.frag", &["TONE_MAP 3", "MEAN"]),
];

pub(super) struct Post {
    passes: Passes,
    resolve: LazyProgram,
    resolve_all: LazyProgram,
    lens: LensBlur,
    trails: Trails,
    bloom: Bloom,
    /// One program for each tone map, in the order of [`ToneMap::ALL`].
    present: [LazyProgram; 4],
    /// The same programs, for images that fade into another image.
    present_faded: [LazyProgram; 4],
    expose: LazyProgram,
    add_exposure: LazyProgram,
    add_faded_exposure: LazyProgram,
    /// The same programs as `present`, for the mean of exposures.
    present_mean: [LazyProgram; 4],
    tone_map: Option<ToneMap>,
}

pub(super) struct PostTargets {
    light: Target,
    /// The light with trails, which is then swapped with `light`; made at the first use.
    trailed: Option<Target>,
    lens: Option<LensTargets>,
    bloom: BloomTargets,
    finished: Target,
}

impl Post {
    /// Assembles the shaders. Each shader is compiled at its first use.
    pub(super) fn new(gl: &Gl, library: &ShaderLibrary) -> Result<Self, GpuError> {
        let programs = POST_SHADERS
            .map(|(name, defines)| move || LazyProgram::new(gl, library, name, &Variant::of(defines)));
        let [of_stencil, of_list, of_all, halve, blur, mix, first, down, up, rest @ ..] = programs;
        let [trails, kept_trails, mixed_frames, presents @ ..] = rest;
        let [agx, aces, reinhard, none, agx_faded, aces_faded, reinhard_faded, none_faded, lights @ ..] =
            presents;
        let [expose, add, add_faded, agx_mean, aces_mean, reinhard_mean, none_mean] = lights;
        Ok(Self {
            passes: Passes::new(gl)?,
            resolve: if gl.info().software { of_list() } else { of_stencil() }?,
            resolve_all: of_all()?,
            lens: LensBlur { down: halve()?, blur: blur()?, mix: mix()? },
            trails: Trails { add: trails()?, keep: kept_trails()?, mix: mixed_frames()? },
            bloom: Bloom { first: first()?, down: down()?, up: up()? },
            present: [agx()?, aces()?, reinhard()?, none()?],
            present_faded: [agx_faded()?, aces_faded()?, reinhard_faded()?, none_faded()?],
            expose: expose()?,
            add_exposure: add()?,
            add_faded_exposure: add_faded()?,
            present_mean: [agx_mean()?, aces_mean()?, reinhard_mean()?, none_mean()?],
            tone_map: None,
        })
    }

    pub(super) fn passes(&self) -> &Passes {
        &self.passes
    }

    pub(super) fn set_tone_map(&mut self, tone_map: Option<ToneMap>) {
        self.tone_map = tone_map;
    }

    /// Sets the image's settings and the edge contrasts for all passes, including the passes of the scene.
    pub(super) fn bind_picture(&self, picture: &Picture, samples: EdgeSamples) {
        let [surfaces, inner] = samples.contrasts();
        self.passes.set_picture(&[picture.block().as_flattened(), &[surfaces, inner, 0.0, 0.0]].concat());
    }

    /// Resolves the bound samples to light. `block` is the width and height of a pixel's block of further samples.
    pub(super) fn resolve(&self, targets: &PostTargets, block: (u32, u32)) -> Result<(), GpuError> {
        self.passes.draw_with(&self.resolve, &targets.light, [block.0 as f32, block.1 as f32])
    }

    pub(super) fn resolve_all(&self, targets: &PostTargets) -> Result<(), GpuError> {
        self.passes.draw(&self.resolve_all, &targets.light)
    }

    /// Adds trails to the resolved light.
    pub(super) fn add_trails(&self, targets: &mut PostTargets, trails: &TrailSource) -> Result<(), GpuError> {
        let trailed = match targets.trailed.take() {
            Some(trailed) => trailed,
            None => Target::new(&self.passes.gl, targets.light.size(), &[Texel::Rgba16F], None)?.smooth(),
        };
        self.trails.add(&self.passes, &targets.light, trails, &trailed)?;
        targets.trailed = Some(std::mem::replace(&mut targets.light, trailed));
        Ok(())
    }

    pub(super) fn programs_of_trails(&self) -> &Trails {
        &self.trails
    }

    /// Finishes the image. `samples` are the first samples; `fade` is the light of another image and its fraction.
    pub(super) fn finish(
        &self,
        targets: &PostTargets,
        picture: &Picture,
        samples: &Target,
        fade: Weighted<'_>,
    ) -> Result<(), GpuError> {
        self.bind_light(targets, picture, samples)?;
        let programs = if fade.is_some() { &self.present_faded } else { &self.present };
        let present = self.with_tone_map(picture, programs);
        self.passes.draw_with(present, &targets.finished, [bound_fade(fade), 0.0])
    }

    /// Writes the exposed light of the last finished image, mixed with the mean of earlier exposures, to `output`.
    /// `earlier` is this mean and the weight of the new exposure.
    pub(super) fn add_exposure(
        &self,
        targets: &PostTargets,
        picture: &Picture,
        samples: &Target,
        fade: Weighted<'_>,
        earlier: Weighted<'_>,
        output: &Target,
    ) -> Result<(), GpuError> {
        self.bind_light(targets, picture, samples)?;
        let program = if fade.is_some() { &self.add_faded_exposure } else { &self.add_exposure };
        let (mean, weight) = earlier.unwrap_or((&targets.light, 1.0));
        mean.bind_color(0, unit_of("mean"));
        self.passes.draw_with(program, output, [bound_fade(fade), weight])
    }

    /// Finishes an image from the mean of its exposures.
    pub(super) fn finish_mean(
        &self,
        targets: &PostTargets,
        picture: &Picture,
        mean: &Target,
    ) -> Result<(), GpuError> {
        mean.bind_color(0, unit_of("mean"));
        self.passes.draw(self.with_tone_map(picture, &self.present_mean), &targets.finished)
    }

    fn with_tone_map<'a>(&self, picture: &Picture, programs: &'a [LazyProgram; 4]) -> &'a LazyProgram {
        let [agx, aces, reinhard, none] = programs;
        match self.tone_map.unwrap_or(picture.tone_map) {
            ToneMap::Agx => agx,
            ToneMap::Aces => aces,
            ToneMap::Reinhard => reinhard,
            ToneMap::None => none,
        }
    }

    /// Writes the exposed linear light of the last finished image to a target of the same size, without a tone map.
    pub(super) fn expose(
        &self,
        targets: &PostTargets,
        picture: &Picture,
        samples: &Target,
        output: &Target,
    ) -> Result<(), GpuError> {
        self.bind_light(targets, picture, samples)?;
        self.passes.draw(&self.expose, output)
    }

    fn bind_light(&self, targets: &PostTargets, picture: &Picture, samples: &Target) -> Result<(), GpuError> {
        let passes = &self.passes;
        let light = match &targets.lens {
            Some(lens) => self.lens.draw(passes, &targets.light, samples, lens)?,
            None => &targets.light,
        };
        // Without bloom the fraction is 0, so any texture can be bound.
        let scattered = match picture.bloom {
            fraction if fraction > 0.0 => self.bloom.draw(passes, light, &targets.bloom)?,
            _ => light,
        };
        light.bind_color(0, unit_of("picture"));
        scattered.bind_color(0, unit_of("bloom"));
        Ok(())
    }
}

/// Light with its weight, 0..1.
type Weighted<'a> = Option<(&'a Target, f32)>;

/// Binds the light that an image fades into, and returns its fraction.
fn bound_fade(fade: Weighted<'_>) -> f32 {
    fade.map_or(0.0, |(before, fraction)| {
        before.bind_color(0, unit_of("before"));
        fraction
    })
}

impl PostTargets {
    pub(super) fn new(
        gl: &Gl,
        size: (u32, u32),
        has_lens: bool,
        output: (u32, u32),
    ) -> Result<Self, GpuError> {
        Ok(Self {
            lens: has_lens.then(|| LensTargets::new(gl, size)).transpose()?,
            light: Target::new(gl, size, &[Texel::Rgba16F], None)?.smooth(),
            trailed: None,
            bloom: BloomTargets::new(gl, size)?,
            finished: Target::new(gl, output, &[Texel::Rgba8], None)?,
        })
    }

    /// The resolved light.
    pub(super) fn light(&self) -> &Target {
        &self.light
    }

    pub(super) fn finished(&self) -> &Target {
        &self.finished
    }

    pub(super) fn into_finished(self) -> Target {
        self.finished
    }
}
