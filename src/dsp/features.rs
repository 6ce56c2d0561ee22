//! What the analysis tells of one moment of sound.

use serde::Serialize;

/// Number of frequency bands.
pub const BAND_COUNT: usize = 32;

/// The lowest level that is told, in decibels: silence reads this, nothing reads less.
pub const LEVEL_FLOOR_DB: f32 = -120.0;

/// The features of one moment. Every number is finite, whatever the samples were.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Features {
    /// Loudness of the left and the right channel: the mean of |sample| (thesis, section 5, eq. 1), followed with
    /// attack and release. 0 is silence, a full-scale sine reads 2/π = 0.637, a full-scale square wave 1;
    /// only samples beyond full scale read more than 1 (at most 8).
    pub volume: [f32; 2],
    /// Height of each band for drawing, 0..1: its level from -66 dB to -6 dB, linear in decibels, followed with
    /// attack and release. Low frequencies first; the edges are [`band_edge`](super::band_edge)'s.
    pub bands: [f32; BAND_COUNT],
    /// Level of the power in each band in decibels, both channels together, as measured: not smoothed.
    /// A sine of amplitude a in both channels reads 20·log10(a) dB in sum over the bands it falls into, in one
    /// channel alone 3.01 dB less, whatever the phase between the channels. Not below [`LEVEL_FLOOR_DB`].
    pub band_levels_db: [f32; BAND_COUNT],
}

impl Features {
    /// Features of silence.
    pub const SILENCE: Self =
        Self { volume: [0.0; 2], bands: [0.0; BAND_COUNT], band_levels_db: [LEVEL_FLOOR_DB; BAND_COUNT] };

    /// The straight line from `self` (`amount` 0) to `other` (`amount` 1), number by number.
    pub fn lerp(&self, other: &Self, amount: f32) -> Self {
        let mix = |a: f32, b: f32| a + (b - a) * amount;
        Self {
            volume: std::array::from_fn(|i| mix(self.volume[i], other.volume[i])),
            bands: std::array::from_fn(|i| mix(self.bands[i], other.bands[i])),
            band_levels_db: std::array::from_fn(|i| mix(self.band_levels_db[i], other.band_levels_db[i])),
        }
    }
}

impl Default for Features {
    fn default() -> Self {
        Self::SILENCE
    }
}

/// Features and the moment they belong to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedFeatures {
    /// Seconds of stream time: the centre of the stretch of samples that was analysed.
    pub time: f64,
    /// The features of that moment.
    pub features: Features,
}
