//! The level of a band of frequencies, whitened and compressed, and how sudden its rise is.

/// Strength of the logarithmic compression of a band's level: log(1 + `COMPRESSION` · level).
const COMPRESSION: f32 = 20.0;

/// Amplitudes below this (-70 dB) are too weak for an onset.
const AMPLITUDE_MIN: f32 = 3e-4;

/// Time constant of the decay of the loudest amplitudes, in seconds.
const LOUDEST_SECONDS: f64 = 4.0;
/// A band's loudest amplitude counts as at least this fraction of the total amplitude (-50 dB).
const BAND_MIN: f32 = 3e-3;

/// Time constant of the mean rise of a band, in seconds.
const USUAL_SECONDS: f64 = 2.0;
/// The initial mean rise. Noise has about this mean rise.
const USUAL_AT_FIRST: f32 = 0.2;
/// The maximum rise that enters a band's mean, relative to the mean, so that onsets do not raise the mean much.
const TEACHES_MOST: f32 = 3.0;

/// How all bands of a spectrum are whitened (Stowell and Plumbley 2007), and how they learn their usual rises.
pub(super) struct Whitening {
    /// At 1 each band is scaled by its loudest recent amplitude; at 0 no band is scaled. Whitening makes quiet changes
    /// detectable while other bands play a loud chord.
    strength: f32,
    /// A band's mean rise counts as at least this much.
    usual_min: f32,
    kept: f32,
    learned: f32,
}

/// The recent past of one band.
#[derive(Clone, Copy)]
pub(super) struct Band {
    loudest: f32,
    usual: f32,
}

impl Band {
    pub(super) const AT_FIRST: Self = Self { loudest: 0.0, usual: USUAL_AT_FIRST };
}

impl Whitening {
    pub(super) fn new(strength: f32, usual_min: f32, hop_seconds: f64) -> Self {
        let kept = (-hop_seconds / LOUDEST_SECONDS).exp() as f32;
        Self { strength, usual_min, kept, learned: (hop_seconds / USUAL_SECONDS) as f32 }
    }

    /// Returns the loudest recent amplitude of all bands together: `before` is the last result, `now` the amplitude.
    pub(super) fn loudest(&self, before: f32, now: f32) -> f32 {
        now.max(before * self.kept).max(AMPLITUDE_MIN)
    }

    /// Returns the compressed level of a band with this amplitude, relative to the loudest amplitude of all bands.
    pub(super) fn height(&self, band: &mut Band, amplitude: f32, loudest_of_all: f32) -> f32 {
        band.loudest = amplitude.max(band.loudest * self.kept);
        let of_band = (band.loudest / loudest_of_all).clamp(BAND_MIN, 1.0);
        let level = amplitude / loudest_of_all / of_band.powf(self.strength);
        (1.0 + COMPRESSION * level).ln()
    }

    /// Returns a rise of the band's height relative to its mean rise, and adds it to the mean.
    pub(super) fn sudden(&self, band: &mut Band, rise: f32) -> f32 {
        let usual = self.usual_min + band.usual;
        band.usual += self.learned * (rise.min(TEACHES_MOST * usual) - band.usual);
        rise / usual
    }
}
