//! Logarithmic frequency bands: from the power per bin to the level of each band and its height for drawing.

use super::features::{BAND_COUNT, LEVEL_FLOOR_DB};

/// Lower edge of the lowest band, in hertz.
pub const BAND_LOWEST_HZ: f64 = 30.0;

/// Upper edge of the highest band, in hertz.
pub const BAND_HIGHEST_HZ: f64 = 16_000.0;

/// The level that is drawn with height 0, in decibels.
const HEIGHT_ZERO_DB: f32 = -66.0;

/// The level that is drawn with height 1, in decibels.
///
/// Music mastered at -14 LUFS has about -13 dB in all (0 dB: a full-scale sine in both channels). Spread evenly
/// over 32 bands (pink) that is -28 dB each, a height of 0.63; the usual fall of music towards the treble
/// puts the bass near -18 dB (0.8), a kick near -10 dB (0.93) and the treble near -45 dB (0.35).
const HEIGHT_ONE_DB: f32 = -6.0;

/// Lower edge of band `index` in hertz; that of `BAND_COUNT` is the upper edge of the last band.
///
/// The edges divide 30 Hz to 16 kHz into equal ratios (1.217, a little over a quarter of an octave) and do not
/// depend on the sample rate: a tone stands in the same band at every rate.
pub fn band_edge(index: usize) -> f64 {
    BAND_LOWEST_HZ * (BAND_HIGHEST_HZ / BAND_LOWEST_HZ).powf(index as f64 / BAND_COUNT as f64)
}

/// Which bins make up which band.
///
/// Bin k stands for the interval [k - ½, k + ½] bins. A band takes of each bin the share of that interval that
/// lies within its edges, so bands share the bins on their common edges and no power is lost or counted twice.
pub(super) struct Bands {
    bands: Vec<Band>,
    weights: Vec<f32>,
}

/// The bins `first_bin..` weighted by `weights[first_weight..first_weight + count]`.
struct Band {
    first_bin: usize,
    first_weight: usize,
    count: usize,
}

impl Bands {
    /// For `bin_count` bins of `bin_hz` hertz each, from 0 Hz. A band that reaches above the last bin is cut
    /// there; one wholly above it is silent.
    pub(super) fn new(bin_count: usize, bin_hz: f64) -> Self {
        let mut weights = Vec::with_capacity(bin_count + 2 * BAND_COUNT);
        let bands = (0..BAND_COUNT)
            .map(|index| {
                let (low, high) = (band_edge(index) / bin_hz, band_edge(index + 1) / bin_hz);
                let first_bin = (low.round() as usize).min(bin_count);
                let end_bin = (high.round() as usize + 1).min(bin_count);
                let first_weight = weights.len();
                weights.extend((first_bin..end_bin).map(|bin| {
                    let centre = bin as f64;
                    ((centre + 0.5).min(high) - (centre - 0.5).max(low)).max(0.0) as f32
                }));
                Band { first_bin, first_weight, count: weights.len() - first_weight }
            })
            .collect();
        Self { bands, weights }
    }

    /// The level of each band in decibels, from the power per bin; not below [`LEVEL_FLOOR_DB`].
    pub(super) fn levels_db(&self, power: &[f32]) -> [f32; BAND_COUNT] {
        let mut levels = [LEVEL_FLOOR_DB; BAND_COUNT];
        for (level, band) in levels.iter_mut().zip(&self.bands) {
            let weights = &self.weights[band.first_weight..][..band.count];
            let sum: f32 = power[band.first_bin..].iter().zip(weights).map(|(p, w)| p * w).sum();
            *level = decibels(sum);
        }
        levels
    }
}

/// A power ratio in decibels, not below [`LEVEL_FLOOR_DB`].
fn decibels(power: f32) -> f32 {
    (10.0 * power.log10()).max(LEVEL_FLOOR_DB)
}

/// The height 0..1 at which a level is drawn: linear in decibels from -66 dB to -6 dB, clamped.
pub(super) fn height(level_db: f32) -> f32 {
    ((level_db - HEIGHT_ZERO_DB) / (HEIGHT_ONE_DB - HEIGHT_ZERO_DB)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_run_from_lowest_to_highest_in_equal_ratios() {
        assert_eq!(band_edge(0), BAND_LOWEST_HZ);
        assert!((band_edge(BAND_COUNT) - BAND_HIGHEST_HZ).abs() < 1e-6);
        for index in 1..BAND_COUNT {
            let below = band_edge(index) / band_edge(index - 1);
            let above = band_edge(index + 1) / band_edge(index);
            assert!((below - above).abs() < 1e-9, "at edge {index}: {below} and {above}");
        }
    }

    /// Power that lies evenly over frequency comes out as bandwidth, and each bin is given out once.
    #[test]
    fn bins_are_shared_without_loss() {
        for (bin_count, bin_hz) in
            [(2048, 48_000.0 / 4096.0), (2048, 67_882.0 / 4096.0), (32_768, 768_000.0 / 65_536.0)]
        {
            let bands = Bands::new(bin_count, bin_hz);
            let mut given = vec![0.0_f64; bin_count];
            for (index, band) in bands.bands.iter().enumerate() {
                let weights = &bands.weights[band.first_weight..][..band.count];
                let width: f64 = weights.iter().map(|&w| f64::from(w)).sum();
                let expected = (band_edge(index + 1) - band_edge(index)) / bin_hz;
                assert!((width - expected).abs() < 1e-4, "band {index} is {width} bins wide, not {expected}");
                for (bin, &weight) in (band.first_bin..).zip(weights) {
                    given[bin] += f64::from(weight);
                }
            }
            for (bin, share) in given.iter().enumerate() {
                let (low, high) = ((bin as f64 - 0.5) * bin_hz, (bin as f64 + 0.5) * bin_hz);
                let expected = (high.min(BAND_HIGHEST_HZ) - low.max(BAND_LOWEST_HZ)).max(0.0) / bin_hz;
                assert!((share - expected).abs() < 1e-5, "bin {bin} is given {share} times, not {expected}");
            }
        }
    }

    #[test]
    fn bands_above_the_last_bin_are_silent() {
        // 8 kHz: the highest frequency is 4 kHz.
        let levels = Bands::new(256, 8_000.0 / 512.0).levels_db(&[1.0; 256]);
        for (index, &level) in levels.iter().enumerate() {
            assert_eq!(level == LEVEL_FLOOR_DB, band_edge(index) > 4_000.0, "band {index}: {level} dB");
        }
    }

    #[test]
    fn heights_run_from_0_to_1() {
        assert_eq!([-120.0, -66.0, -36.0, -6.0, 18.0].map(height), [0.0, 0.0, 0.5, 1.0, 1.0]);
    }
}
