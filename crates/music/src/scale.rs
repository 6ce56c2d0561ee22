//! The scales of features: the numbers of values, and their ranges in frequency and level.

/// Lower edge of the lowest band, in hertz.
pub const BAND_LOWEST_HZ: f64 = 30.0;

/// Upper edge of the highest band, in hertz.
pub const BAND_HIGHEST_HZ: f64 = 16_000.0;

/// Number of frequency bands.
pub const BAND_COUNT: usize = 32;

/// The lowest level, in decibels. Silence has this level.
pub const LEVEL_FLOOR_DB: f32 = -120.0;

/// The number of points of the spectrum's curve.
pub const SPECTRUM_POINTS: usize = 512;

/// The number of notes: the semitones from A0 (27.5 Hz) to C8 (4186 Hz), as on a piano.
pub const NOTE_COUNT: usize = 88;

/// The number of waveform samples per hop (11.6 to 12.3 kHz at sample rates of 44.1 and 48 kHz and their multiples).
pub const WAVE_PER_HOP: usize = 128;

/// Returns the frequency at `u` in hertz: 30 Hz at 0, 16 kHz at 1, in equal ratios between.
pub fn spectrum_hz(u: f64) -> f64 {
    BAND_LOWEST_HZ * (BAND_HIGHEST_HZ / BAND_LOWEST_HZ).powf(u)
}

/// Returns the position of a frequency on the spectrum's axis, clamped to 0..1. This inverts [`spectrum_hz`].
pub fn spectrum_place(hz: f64) -> f64 {
    let octaves = (hz.max(1e-9) / BAND_LOWEST_HZ).ln() / (BAND_HIGHEST_HZ / BAND_LOWEST_HZ).ln();
    octaves.clamp(0.0, 1.0)
}

/// Returns the edges of `count` bands in equal ratios from 30 Hz to 16 kHz, as bins, at most `bins`. Each band has at
/// least one bin, so the edges of the low bands are higher than equal ratios would give.
pub(super) fn band_bins(count: usize, bin_hz: f64, bins: usize) -> Vec<usize> {
    let mut least = 1;
    let edge = |band: usize| {
        let hz = spectrum_hz(band as f64 / count as f64);
        let edge = ((hz / bin_hz).round() as usize).max(least).min(bins);
        least = edge + 1;
        edge
    };
    (0..=count).map(edge).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_and_frequencies_are_inverse() {
        for (place, hz) in [(0.0, BAND_LOWEST_HZ), (0.5, 692.820_323), (1.0, BAND_HIGHEST_HZ)] {
            assert!((spectrum_hz(place) - hz).abs() < 1e-5, "{place}: {} Hz", spectrum_hz(place));
            assert!((spectrum_place(hz) - place).abs() < 1e-9, "{hz} Hz: {}", spectrum_place(hz));
        }
        assert_eq!([0.0, -1.0, 1e9].map(spectrum_place), [0.0, 0.0, 1.0]);
    }
}
