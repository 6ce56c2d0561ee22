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

use mariana_field::world::ToneMap;

use super::edge_samples::EdgeSamples;
use super::error::Result;
use super::gl::Gl;
use super::passes::{Block, Passes};
use super::program::{LazyProgram, unit_of};
use super::shader_source::{ShaderLibrary, Variant};
use super::target::{Target, Texel};
use super::trails::{TrailSource, Trails};
use crate::frame::picture::{BLUR_MAX, Picture};

/// The shaders of these passes and their defines, in the order of `Post::new`. Tests compile all of them.
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
    pub(super) passes: Passes,
    picture: Block,
    resolve: LazyProgram,
    resolve_all: LazyProgram,
    /// Halve the image, blur it, and mix it with the sharp light.
    lens: [LazyProgram; 3],
    /// Halve the image, halve it further, and enlarge it.
    bloom: [LazyProgram; 3],
    pub(super) trails: Trails,
    /// One program for each tone map, in the order of [`ToneMap::ALL`].
    present: [LazyProgram; 4],
    /// The same programs, for images that fade into another image.
    present_faded: [LazyProgram; 4],
    expose: LazyProgram,
    add_exposure: LazyProgram,
    add_faded_exposure: LazyProgram,
    /// The same programs as `present`, for the mean of exposures.
    present_mean: [LazyProgram; 4],
    pub(super) tone_map: Option<ToneMap>,
}

pub(super) struct PostTargets {
    pub(super) light: Target,
    /// The light with trails, which is then swapped with `light`; made at the first use.
    trailed: Option<Target>,
    lens: Option<LensTargets>,
    /// The levels, largest first.
    bloom: Vec<Target>,
    pub(super) finished: Target,
}

impl Post {
    /// Assembles the shaders. Each shader is compiled at its first use.
    pub(super) fn new(gl: &Gl, library: &ShaderLibrary) -> Result<Self> {
        let mut shaders = POST_SHADERS.into_iter();
        let mut next = || {
            let (name, defines) = shaders.next().unwrap_or_default();
            LazyProgram::new(gl, library, name, &Variant::of(defines))
        };
        let [of_stencil, of_list] = [next()?, next()?];
        let post = Self {
            passes: Passes::new(gl)?,
            picture: Block::new(gl, "PictureBlock")?,
            resolve: if gl.info().software { of_list } else { of_stencil },
            resolve_all: next()?,
            lens: [next()?, next()?, next()?],
            bloom: [next()?, next()?, next()?],
            trails: Trails { add: next()?, keep: next()?, mix: next()? },
            present: [next()?, next()?, next()?, next()?],
            present_faded: [next()?, next()?, next()?, next()?],
            expose: next()?,
            add_exposure: next()?,
            add_faded_exposure: next()?,
            present_mean: [next()?, next()?, next()?, next()?],
            tone_map: None,
        };
        debug_assert!(shaders.next().is_none(), "a shader of the table is not used");
        Ok(post)
    }

    /// Sets the image's settings and the edge contrasts for all passes, including the passes of the scene.
    pub(super) fn bind_picture(&self, picture: &Picture, samples: EdgeSamples) {
        let [surfaces, inner] = samples.contrasts();
        self.picture.set(&[picture.block().as_flattened(), &[surfaces, inner, 0.0, 0.0]].concat());
    }

    /// Resolves the bound samples to light. `block` is the width and height of a pixel's block of further samples.
    pub(super) fn resolve(&self, targets: &PostTargets, block: (u32, u32)) -> Result<()> {
        self.passes.draw_with(&self.resolve, &targets.light, [block.0 as f32, block.1 as f32])
    }

    pub(super) fn resolve_all(&self, targets: &PostTargets) -> Result<()> {
        self.passes.draw(&self.resolve_all, &targets.light)
    }

    /// Adds trails to the resolved light.
    pub(super) fn add_trails(&self, targets: &mut PostTargets, trails: &TrailSource) -> Result<()> {
        let made = || Target::of_light(&self.passes.gl, targets.light.size());
        let trailed = targets.trailed.take().map_or_else(made, Ok)?;
        trails.draw(&self.passes, &self.trails.add, &targets.light, &trailed)?;
        targets.trailed = Some(std::mem::replace(&mut targets.light, trailed));
        Ok(())
    }

    /// Finishes the image. `samples` are the first samples; `fade` is the light of another image and its fraction.
    pub(super) fn finish(
        &self,
        targets: &PostTargets,
        picture: &Picture,
        samples: &Target,
        fade: Weighted<'_>,
    ) -> Result<()> {
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
    ) -> Result<()> {
        self.bind_light(targets, picture, samples)?;
        let program = if fade.is_some() { &self.add_faded_exposure } else { &self.add_exposure };
        let (mean, weight) = earlier.unwrap_or((&targets.light, 1.0));
        mean.bind_color(0, unit_of("mean"));
        self.passes.draw_with(program, output, [bound_fade(fade), weight])
    }

    /// Finishes an image from the mean of its exposures.
    pub(super) fn finish_mean(&self, targets: &PostTargets, picture: &Picture, mean: &Target) -> Result<()> {
        mean.bind_color(0, unit_of("mean"));
        self.passes.draw(self.with_tone_map(picture, &self.present_mean), &targets.finished)
    }

    fn with_tone_map<'a>(&self, picture: &Picture, programs: &'a [LazyProgram; 4]) -> &'a LazyProgram {
        &programs[self.tone_map.unwrap_or(picture.tone_map) as usize]
    }

    /// Writes the exposed linear light of the last finished image to a target of the same size, without a tone map.
    pub(super) fn expose(
        &self,
        targets: &PostTargets,
        picture: &Picture,
        samples: &Target,
        output: &Target,
    ) -> Result<()> {
        self.bind_light(targets, picture, samples)?;
        self.passes.draw(&self.expose, output)
    }

    fn bind_light(&self, targets: &PostTargets, picture: &Picture, samples: &Target) -> Result<()> {
        let light = match &targets.lens {
            Some(lens) => self.blur(&targets.light, samples, lens)?,
            None => &targets.light,
        };
        // Without bloom the fraction is 0, so any texture can be bound.
        let scattered = match picture.bloom {
            fraction if fraction > 0.0 => self.scatter(light, &targets.bloom)?,
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
    pub(super) fn new(gl: &Gl, size: (u32, u32), has_lens: bool, output: (u32, u32)) -> Result<Self> {
        let levels = level_sizes(size).into_iter().map(|size| Target::of_light(gl, size));
        Ok(Self {
            lens: has_lens.then(|| LensTargets::new(gl, size)).transpose()?,
            light: Target::of_light(gl, size)?,
            trailed: None,
            bloom: levels.collect::<Result<_>>()?,
            finished: Target::new(gl, output, &[Texel::Rgba8], None)?,
        })
    }
}

// Bloom: light that the lens and the eye scatter.
//
// The image is halved in size repeatedly, then enlarged again and mixed level by level (Jimenez, "Next Generation Post
// Processing in Call of Duty: Advanced Warfare", 2014). Here every level is a mean of light, and `present.frag`
// subtracts the scattered light from its origin, so that the image gets no brighter.

/// Maximum number of levels. The sides of the eighth level are a 256th of the image's sides.
const LEVELS_MAX: u32 = 8;
const SMALLEST: u32 = 6;
/// Weight of each level, relative to the level that has twice its width and height.
const FADING: f32 = 0.85;

impl Post {
    /// Scatters light. The result has half the width and height.
    fn scatter<'a>(&self, light: &'a Target, levels: &'a [Target]) -> Result<&'a Target> {
        let [first, down, up] = &self.bloom;
        let (mut source, mut program) = (light, first);
        let mut largest = None;
        for level in levels {
            source.bind_color(0, unit_of("picture"));
            self.passes.draw(program, level)?;
            (source, program) = (level, down);
            largest.get_or_insert(level);
        }
        for (index, pair) in levels.windows(2).enumerate().rev() {
            let [larger, smaller] = pair else { continue };
            smaller.bind_color(0, unit_of("picture"));
            self.passes.mix(up, larger, fraction_of_smaller(levels.len() - index))?;
        }
        Ok(largest.unwrap_or(light))
    }
}

/// Returns the share of the smaller levels when `levels` remain. All weights sum to 1 and decrease level by level.
fn fraction_of_smaller(levels: usize) -> f32 {
    let weights = |from: usize| (from..levels).map(|level| FADING.powi(level as i32)).sum::<f32>();
    weights(1) / weights(0)
}

/// Sizes of the levels, largest first. There is at least one level.
fn level_sizes(size: (u32, u32)) -> Vec<(u32, u32)> {
    let mut sizes = vec![(size.0.div_ceil(2).max(1), size.1.div_ceil(2).max(1))];
    while let Some(&(width, height)) = sizes.last()
        && width.min(height) >= 2 * SMALLEST
        && sizes.len() < LEVELS_MAX as usize
    {
        sizes.push((width.div_ceil(2), height.div_ceil(2)));
    }
    sizes
}

// Depth of field: points that are out of focus are spread over discs. `scene.frag` writes the radius of each point's
// disc. In an image of half the size, each pixel gathers the light of the discs that cover the pixel. Points with
// discs smaller than a pixel stay sharp. The blur has no noise, so equal frames stay equal.

/// Maximum number of samples that a pixel gathers: `TAPS_MAX` of `lens_blur.frag`.
const TAPS_MAX: f32 = 80.0;

pub(super) struct LensTargets {
    smaller: Target,
    blurred: Target,
    light: Target,
}

impl Post {
    /// Blurs light. Colour texture 1 of `samples` holds the radius of each point's disc.
    fn blur<'a>(&self, light: &Target, samples: &Target, targets: &'a LensTargets) -> Result<&'a Target> {
        let (passes, [down, blur, mix]) = (&self.passes, &self.lens);
        let reach = (BLUR_MAX * targets.smaller.size().1 as f32).max(1.0);
        let taps = (0.4 * reach * reach + 12.0).min(TAPS_MAX).floor();
        light.bind_color(0, unit_of("picture"));
        samples.bind_color(1, unit_of("spreads"));
        passes.draw(down, &targets.smaller)?;
        targets.smaller.bind_color(0, unit_of("picture"));
        passes.draw_with(blur, &targets.blurred, [reach, taps])?;
        light.bind_color(0, unit_of("picture"));
        targets.blurred.bind_color(0, unit_of("blurred"));
        passes.draw(mix, &targets.light)?;
        Ok(&targets.light)
    }
}

impl LensTargets {
    pub(super) fn new(gl: &Gl, size: (u32, u32)) -> Result<Self> {
        let target = |size| Target::of_light(gl, size);
        let half = (size.0.div_ceil(2), size.1.div_ceil(2));
        Ok(Self { smaller: target(half)?, blurred: target(half)?, light: target(size)? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_size_has_its_levels() {
        assert_eq!(level_sizes((1, 1)), [(1, 1)]);
        assert_eq!(level_sizes((16384, 1)), [(8192, 1)]);
        assert_eq!(level_sizes((640, 360)), [(320, 180), (160, 90), (80, 45), (40, 23), (20, 12), (10, 6)]);
        assert_eq!(level_sizes((16384, 16384)).len(), LEVELS_MAX as usize);
    }

    #[test]
    fn the_weights_of_the_levels_sum_to_one_and_decrease() {
        for count in 1..=8 {
            let (mut left, mut weights) = (1.0, Vec::new());
            for index in 0..count {
                let fraction = if index + 1 < count { fraction_of_smaller(count - index) } else { 0.0 };
                weights.push(left * (1.0 - fraction));
                left *= fraction;
            }
            assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-5, "{weights:?}");
            assert!(weights.is_sorted_by(|a, b| (b / a - FADING).abs() < 1e-4), "{weights:?}");
        }
    }
}
