//! Logarithmic frequency bands: converts the power per bin to band levels and to heights for drawing.

use super::resolution::Resolution;
use super::scale::{BAND_COUNT, LEVEL_FLOOR_DB, spectrum_hz};
use super::spectrum::Spectrum;

const HEIGHT_ZERO_DB: f32 = -66.0;

/// The level that has height 1, in decibels. Music at -14 LUFS has a total level of about -13 dB (0 dB is a full-scale
/// sine in both channels). If this level is spread evenly over 32 bands (pink), each band has -28 dB, a height of 0.63.
/// In most music the bass is near -18 dB (0.8), a kick near -10 dB (0.93) and the treble near -45 dB (0.35).
const HEIGHT_ONE_DB: f32 = -6.0;

/// Returns the lower edge of band `index` in hertz. For `BAND_COUNT`, returns the upper edge of the last band. The
/// edges divide 30 Hz to 16 kHz into equal ratios (1.217, a little over a quarter of an octave) at every sample rate.
pub fn band_edge(index: usize) -> f64 {
    spectrum_hz(index as f64 / BAND_COUNT as f64)
}

/// The weights of the bins in each band. Bin k covers the range from k - ½ to k + ½. Its weight is the fraction of this
/// range inside the band, so no power is lost or counted twice. [`Resolution::fraction`] weights the three windows.
pub(super) struct Bands([[Bins; Resolution::ALL.len()]; BAND_COUNT]);

/// The bins of a band in one window, from the first bin on.
struct Bins {
    first: usize,
    weights: Vec<f32>,
}

impl Bands {
    /// Creates the weights for windows of [`Resolution::hops`] times `hop` frames; 0 above half the sample rate.
    pub(super) fn new(hop: usize, sample_rate: f64) -> Self {
        let bins = |band: usize, resolution: Resolution| {
            let length = hop * resolution.hops();
            let (bin_count, bin_hz) = (length / 2, sample_rate / length as f64);
            let (low, high) = (band_edge(band) / bin_hz, band_edge(band + 1) / bin_hz);
            let shared = |bin: usize| {
                let centre = bin as f64;
                let inside = ((centre + 0.5).min(high) - (centre - 0.5).max(low)).max(0.0);
                (inside * resolution.fraction(centre * bin_hz)) as f32
            };
            let first = (low.round() as usize).min(bin_count);
            let end = (high.round() as usize + 1).min(bin_count);
            // A window without weight in the band is not read: its spectrum may end before the band.
            let range = if (first..end).any(|bin| shared(bin) > 0.0) { first..end } else { 0..0 };
            Bins { first: range.start, weights: range.map(shared).collect() }
        };
        Self(std::array::from_fn(|band| Resolution::ALL.map(|resolution| bins(band, resolution))))
    }

    pub(super) fn powers(&self, spectra: [&[f32]; Resolution::ALL.len()]) -> [f32; BAND_COUNT] {
        self.0.each_ref().map(|of_band| {
            let of_window = |(bins, power): (&Bins, &[f32])| {
                power[bins.first..].iter().zip(&bins.weights).map(|(p, w)| p * w).sum::<f32>()
            };
            of_band.iter().zip(spectra).map(of_window).sum()
        })
    }

    /// Returns the sums of [`Spectrum::stereo`] for each band, on the scale of [`Bands::powers`].
    pub(super) fn stereo(&self, spectra: [&Spectrum; Resolution::ALL.len()]) -> [[f32; 2]; BAND_COUNT] {
        self.0.each_ref().map(|of_band| {
            let of_window = |(bins, spectrum): (&Bins, &Spectrum)| spectrum.stereo(bins.first, &bins.weights);
            let parts = of_band.iter().zip(spectra).map(of_window);
            parts.fold([0.0; 2], |sums, part| [sums[0] + part[0], sums[1] + part[1]])
        })
    }
}

/// Converts a power ratio to decibels, at least [`LEVEL_FLOOR_DB`].
pub(super) fn decibels(power: f32) -> f32 {
    (10.0 * power.log10()).max(LEVEL_FLOOR_DB)
}

/// Converts a level to a height, linearly from -66 dB (0) to -6 dB (1), clamped.
pub(super) fn height(level_db: f32) -> f32 {
    ((level_db - HEIGHT_ZERO_DB) / (HEIGHT_ONE_DB - HEIGHT_ZERO_DB)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::super::scale::{BAND_HIGHEST_HZ, BAND_LOWEST_HZ};
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

    /// White noise gives each band a power in proportion to the bandwidth.
    #[test]
    fn bins_are_divided_without_loss() {
        for (hop, rate) in [(512, 48_000.0), (512, 67_882.0), (8_192, 768_000.0)] {
            let bands = Bands::new(hop, rate);
            let mut given = Resolution::ALL.map(|resolution| vec![0.0_f64; hop * resolution.hops() / 2]);
            for (index, of_band) in bands.0.iter().enumerate() {
                let mut width = 0.0;
                for ((bins, given), resolution) in of_band.iter().zip(&mut given).zip(Resolution::ALL) {
                    let bin_hz = rate / (hop * resolution.hops()) as f64;
                    for (bin, &weight) in (bins.first..).zip(&bins.weights) {
                        given[bin] += f64::from(weight);
                        width += f64::from(weight) * bin_hz;
                    }
                }
                let expected = band_edge(index + 1) - band_edge(index);
                assert!(
                    (width / expected - 1.0).abs() < 1e-2,
                    "band {index} is {width} Hz wide, not {expected}"
                );
            }
            for (given, resolution) in given.iter().zip(Resolution::ALL) {
                let bin_hz = rate / (hop * resolution.hops()) as f64;
                for (bin, fraction) in given.iter().enumerate() {
                    let (low, high) = ((bin as f64 - 0.5) * bin_hz, (bin as f64 + 0.5) * bin_hz);
                    let inside = (high.min(BAND_HIGHEST_HZ) - low.max(BAND_LOWEST_HZ)).max(0.0) / bin_hz;
                    let expected = inside * resolution.fraction(bin as f64 * bin_hz);
                    assert!(
                        (fraction - expected).abs() < 1e-5,
                        "bin {bin} counts {fraction} times, not {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn bands_above_the_last_bin_are_silent() {
        // At a sample rate of 8 kHz, the highest frequency is 4 kHz.
        let powers = Bands::new(64, 8_000.0).powers([&[1.0; 512], &[1.0; 128], &[1.0; 64]]);
        for (index, &power) in powers.iter().enumerate() {
            assert_eq!(power == 0.0, band_edge(index) > 4_000.0, "band {index}: {power}");
        }
    }

    #[test]
    fn heights_run_from_0_to_1() {
        assert_eq!([-120.0, -66.0, -36.0, -6.0, 18.0].map(height), [0.0, 0.0, 0.5, 1.0, 1.0]);
    }
}
