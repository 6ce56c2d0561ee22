//! The spectrum as a curve: heights at many frequencies in equal ratios.

use super::bands::decibels;
use super::resolution::Resolution;
use super::scale::{SPECTRUM_POINTS, spectrum_hz};

const HEIGHT_ZERO_DB: f32 = -84.0;

/// The level that has height 1, in decibels. Single tones of music are 10 to 20 dB below the level of their band.
const HEIGHT_ONE_DB: f32 = -12.0;

/// The factor from a bin's power on Parseval's scale to the power of a tone: Hann's noise bandwidth of 1.5 bins.
const NOISE_BANDWIDTH: f32 = 1.5;

pub(super) struct Lines {
    /// Of the windows of each point, at most two have a part. A point above half the sample rate has no part.
    points: Vec<[Part; 2]>,
}

#[derive(Clone, Copy, Default)]
struct Part {
    window: usize,
    fraction: f32,
    first_bin: usize,
    /// The number of bins. The largest power among the bins is used, unless `between` interpolates between two bins.
    count: usize,
    between: Option<f32>,
}

impl Part {
    fn power(&self, spectrum: &[f32]) -> f32 {
        let bins = spectrum.get(self.first_bin..self.first_bin + self.count).unwrap_or_default();
        let value = match (bins, self.between) {
            ([low, high], Some(between)) => low + (high - low) * between,
            _ => bins.iter().fold(0.0, |largest: f32, power| largest.max(*power)),
        };
        self.fraction * value
    }
}

impl Lines {
    pub(super) fn new(hop: usize, sample_rate: f64) -> Self {
        let steps = (SPECTRUM_POINTS - 1) as f64;
        let points = (0..SPECTRUM_POINTS).map(|index| {
            let hz = spectrum_hz(index as f64 / steps);
            let mut parts = [Part::default(); 2];
            let windows = Resolution::ALL
                .into_iter()
                .enumerate()
                .filter(|(_, resolution)| resolution.fraction(hz) > 0.0 && hz < sample_rate / 2.0);
            for (part, (window, resolution)) in parts.iter_mut().zip(windows) {
                let length = hop * resolution.hops();
                let bin = |place: f64| spectrum_hz(place / steps) * length as f64 / sample_rate;
                let (low, high) = (bin(index as f64 - 0.5).ceil(), bin(index as f64 + 0.5).floor());
                let here = bin(index as f64);
                let (first, count, between) = if high > low {
                    // Several bins are within the point's reach: use the largest power.
                    (low, (high - low) as usize + 1, None)
                } else {
                    (here, 2, Some((here - here.floor()) as f32))
                };
                let fraction = resolution.fraction(hz) as f32;
                *part = Part { window, fraction, first_bin: first as usize, count, between };
            }
            parts
        });
        Self { points: points.collect() }
    }

    /// Writes the height of each point, 0..1, from the power per bin of each window. The height is a tone's amplitude
    /// in decibels (corrected for Hann's coherent gain) plus `gain_db`, mapped from -84..-12 dB. A tone between two
    /// bins is measured up to 1.4 dB too low.
    pub(super) fn heights(
        &self,
        spectra: [&[f32]; Resolution::ALL.len()],
        gain_db: f32,
        heights: &mut [f32; SPECTRUM_POINTS],
    ) {
        for (height, parts) in heights.iter_mut().zip(&self.points) {
            let power: f32 = parts.iter().map(|part| part.power(spectra[part.window])).sum();
            let above = decibels(NOISE_BANDWIDTH * power) + gain_db - HEIGHT_ZERO_DB;
            *height = (above / (HEIGHT_ONE_DB - HEIGHT_ZERO_DB)).clamp(0.0, 1.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flat_power_gives_equal_heights() {
        let lines = Lines::new(512, 48_000.0);
        let mut heights = [0.0; SPECTRUM_POINTS];
        lines.heights([&[1e-4; 4096], &[1e-4; 1024], &[1e-4; 512]], 0.0, &mut heights);
        let expected = (-40.0 + 10.0 * 1.5_f32.log10() + 84.0) / 72.0;
        assert!(heights.iter().all(|height| (height - expected).abs() < 1e-5), "{heights:?}");
        lines.heights([&[1e-4; 4096], &[1e-4; 1024], &[1e-4; 512]], 7.2, &mut heights);
        assert!(heights.iter().all(|height| (height - expected - 0.1).abs() < 1e-5), "{heights:?}");
    }
}
