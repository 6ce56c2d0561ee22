//! Bloom: light that the lens and the eye scatter.
//!
//! The image is halved in size repeatedly, then enlarged again and mixed level by level (Jimenez, "Next Generation Post
//! Processing in Call of Duty: Advanced Warfare", 2014). Here every level is a mean of light, and `present.frag`
//! subtracts the scattered light from its origin, so that the image gets no brighter.

use super::error::GpuError;
use super::gl::Gl;
use super::passes::Passes;
use super::program::{LazyProgram, unit_of};
use super::target::{Target, Texel};

/// Maximum number of levels. The sides of the eighth level are a 256th of the image's sides.
const LEVELS_MAX: u32 = 8;
const SMALLEST: u32 = 6;
/// Weight of each level, relative to the level that has twice its width and height.
const FADING: f32 = 0.85;

pub(super) struct Bloom {
    pub(super) first: LazyProgram,
    pub(super) down: LazyProgram,
    pub(super) up: LazyProgram,
}

pub(super) struct BloomTargets {
    levels: Vec<Target>,
}

impl Bloom {
    /// Scatters light. The result has half the width and height.
    pub(super) fn draw<'a>(
        &self,
        passes: &Passes,
        light: &'a Target,
        targets: &'a BloomTargets,
    ) -> Result<&'a Target, GpuError> {
        let levels = &targets.levels;
        let (mut source, mut program) = (light, &self.first);
        let mut largest = None;
        for level in levels {
            source.bind_color(0, unit_of("picture"));
            passes.draw(program, level)?;
            (source, program) = (level, &self.down);
            largest.get_or_insert(level);
        }
        for (index, pair) in levels.windows(2).enumerate().rev() {
            let [larger, smaller] = pair else { continue };
            smaller.bind_color(0, unit_of("picture"));
            passes.mix(&self.up, larger, fraction_of_smaller(levels.len() - index))?;
        }
        Ok(largest.unwrap_or(light))
    }
}

/// Returns the share of the smaller levels when `levels` remain. All weights sum to 1 and decrease level by level.
fn fraction_of_smaller(levels: usize) -> f32 {
    let weights = |from: usize| (from..levels).map(|level| FADING.powi(level as i32)).sum::<f32>();
    weights(1) / weights(0)
}

impl BloomTargets {
    pub(super) fn new(gl: &Gl, size: (u32, u32)) -> Result<Self, GpuError> {
        let level = |size| Ok(Target::new(gl, size, &[Texel::Rgba16F], None)?.smooth());
        Ok(Self { levels: level_sizes(size).into_iter().map(level).collect::<Result<_, GpuError>>()? })
    }
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
