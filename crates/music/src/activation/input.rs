//! The input of the network: compressed levels of frequency bands and their rises.

use crate::scale::band_bins;

/// The number of bands, in equal ratios from 30 Hz to 16 kHz.
pub(super) const BANDS: usize = 40;
/// Two numbers for each band.
pub(super) const NUMBERS: usize = 2 * BANDS;

/// Time constants of the loudest amplitude and of the mean level, in seconds.
const LOUDEST_SECONDS: f64 = 4.0;
const MEAN_SECONDS: f64 = 1.5;
/// Amplitudes below this (-70 dB) count as silence.
const AMPLITUDE_MIN: f32 = 3e-4;
const COMPRESSION: f32 = 100.0;

/// Measures the bands of spectra.
pub(super) struct Input {
    edges: Vec<usize>,
    last: [f32; BANDS],
    means: [f32; BANDS],
    loudest: f32,
    kept: f32,
    learned: f32,
}

impl Input {
    /// Creates the bands of spectra with `bins` bins of `bin_hz` hertz, `step_seconds` apart.
    pub(super) fn new(bins: usize, bin_hz: f64, step_seconds: f64) -> Self {
        Self {
            edges: band_bins(BANDS, bin_hz, bins),
            last: [0.0; BANDS],
            means: [0.0; BANDS],
            loudest: 0.0,
            kept: (-step_seconds / LOUDEST_SECONDS).exp() as f32,
            learned: (step_seconds / MEAN_SECONDS) as f32,
        }
    }

    /// Forgets all moments.
    pub(super) fn restart(&mut self) {
        (self.last, self.means, self.loudest) = ([0.0; BANDS], [0.0; BANDS], 0.0);
    }

    /// Returns the levels relative to their recent means, then the rises.
    pub(super) fn follow(&mut self, power: &[f32]) -> [f32; NUMBERS] {
        let mut numbers = [0.0; NUMBERS];
        let amplitude =
            |from: usize, to: usize| power.get(from..to).unwrap_or_default().iter().sum::<f32>().sqrt();
        let all = amplitude(self.edges[0], self.edges[BANDS]);
        self.loudest = all.max(self.loudest * self.kept).max(AMPLITUDE_MIN);
        for band in 0..BANDS {
            let level = amplitude(self.edges[band], self.edges[band + 1]) / self.loudest;
            let height = (1.0 + COMPRESSION * level).ln();
            numbers[band] = height - self.means[band];
            numbers[BANDS + band] = (height - self.last[band]).max(0.0);
            self.means[band] += self.learned * (height - self.means[band]);
            self.last[band] = height;
        }
        numbers
    }
}
