//! What the analysis tells of one moment of sound.

use serde::Serialize;

use super::lines::SPECTRUM_POINTS;
use super::tables::WAVE_PER_HOP;

/// Number of frequency bands.
pub const BAND_COUNT: usize = 32;

/// The lowest level that is told, in decibels: silence reads this, nothing reads less.
pub const LEVEL_FLOOR_DB: f32 = -120.0;

/// The features of one moment. Every number is finite, whatever the samples were.
///
/// What is told in decibels and hertz is measured; the others are for pictures: levelled by [`Gain`](super::Gain) and
/// smoothed with attack and release.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Features {
    /// Loudness of the left and the right channel: the mean of |sample| over a sixtieth of a second (thesis, section 5,
    /// eq. 1), times the gain, followed with attack and release. 0 is silence, a full-scale sine reads 2/π = 0.637 at a
    /// gain of 0 dB, a full-scale square wave 1; only samples beyond full scale read more than 1 (at most 8).
    pub volume: [f32; 2],
    /// The same of what both channels share, (left + right) / 2.
    pub volume_mid: f32,
    /// The same of that in which they differ, (left - right) / 2: 0 for mono, much for wide stereo.
    pub volume_side: f32,
    /// Height of each band for drawing, 0..1: its level plus the gain from -66 dB to -6 dB, linear in decibels, followed
    /// with attack and release. Low frequencies first; the edges are [`band_edge`](super::band_edge)'s.
    pub bands: [f32; BAND_COUNT],
    /// Mean height of the bands below 144 Hz, 0..1.
    pub bass: f32,
    /// Mean height of the bands from 144 Hz to 1.85 kHz, 0..1.
    pub mid: f32,
    /// Mean height of the bands from 1.85 kHz to 16 kHz, 0..1.
    pub treble: f32,
    /// 1 at the onset of a sound, then falling by e in 0.15 s.
    pub beat: f32,
    /// Beats per minute; 0 while unknown.
    pub tempo: f32,
    /// Way from the last beat to the next, 0 up to 1; 0 while the tempo is unknown. The next beat is foretold for
    /// 60 · (1 - phase) / tempo seconds later.
    pub phase: f32,
    /// The integral of `bass` over time in seconds, of which all but 1/e is forgotten in 4 s: b' = bass - b / 4 s. Time
    /// plus this runs with the bass: faster with each low note, and as fast as time in the mean.
    pub bass_drive: f32,
    /// The gain that the above were levelled by, in decibels; 0 if it is off.
    pub gain_db: f32,
    /// Level of everything from 30 Hz to 16 kHz in decibels, as the bands'.
    pub level_db: f32,
    /// Frequency of the strongest tone in hertz, to a hundredth of a bin of the long window (0.06 Hz); 0 below -80 dB.
    pub peak_hz: f32,
    /// Level of the power in each band in decibels, both channels together, as measured: not smoothed.
    /// A sine of amplitude a in both channels reads 20·log10(a) dB in sum over the bands it falls into, in one
    /// channel alone 3.01 dB less, whatever the phase between the channels. Not below [`LEVEL_FLOOR_DB`].
    pub band_levels_db: [f32; BAND_COUNT],
}

impl Features {
    /// Features of silence.
    pub const SILENCE: Self = Self {
        volume: [0.0; 2],
        volume_mid: 0.0,
        volume_side: 0.0,
        bands: [0.0; BAND_COUNT],
        bass: 0.0,
        mid: 0.0,
        treble: 0.0,
        beat: 0.0,
        tempo: 0.0,
        phase: 0.0,
        bass_drive: 0.0,
        gain_db: 0.0,
        level_db: LEVEL_FLOOR_DB,
        peak_hz: 0.0,
        band_levels_db: [LEVEL_FLOOR_DB; BAND_COUNT],
    };

    /// The straight line from `self` (`amount` 0) to `other` (`amount` 1), number by number. The phase runs through 1 to
    /// 0; a tempo or a frequency that is unknown at one end stays what it is at the start.
    pub fn lerp(&self, other: &Self, amount: f32) -> Self {
        let mix = |a: f32, b: f32| a + (b - a) * amount;
        let known = |a: f32, b: f32| if a > 0.0 && b > 0.0 { mix(a, b) } else { a };
        // A tracker that thought better of it may step back a little: more than half a beat is a new beat.
        let ahead = if other.phase < self.phase - 0.5 { 1.0 } else { 0.0 };
        let phase = mix(self.phase, other.phase + ahead);
        let has_phase = self.tempo > 0.0 && other.tempo > 0.0;
        Self {
            volume: std::array::from_fn(|i| mix(self.volume[i], other.volume[i])),
            volume_mid: mix(self.volume_mid, other.volume_mid),
            volume_side: mix(self.volume_side, other.volume_side),
            bands: std::array::from_fn(|i| mix(self.bands[i], other.bands[i])),
            bass: mix(self.bass, other.bass),
            mid: mix(self.mid, other.mid),
            treble: mix(self.treble, other.treble),
            beat: mix(self.beat, other.beat),
            tempo: known(self.tempo, other.tempo),
            phase: if has_phase { phase - phase.floor() } else { self.phase },
            bass_drive: mix(self.bass_drive, other.bass_drive),
            gain_db: mix(self.gain_db, other.gain_db),
            level_db: mix(self.level_db, other.level_db),
            peak_hz: self.peak_hz,
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
#[derive(Clone, Debug, PartialEq)]
pub struct TimedFeatures {
    /// Seconds of stream time.
    pub time: f64,
    /// Number of the moment: its distance from the stream's start in hops.
    pub number: u64,
    /// The features of that moment.
    pub features: Features,
    /// Heights of the spectrum, 0..1, at frequencies of equal ratios ([`spectrum_hz`](super::spectrum_hz)), followed
    /// like the bands.
    pub spectrum: [f32; SPECTRUM_POINTS],
    /// A hop of both channels' mean, -8..8: with the three before, the waveform of the moment
    /// ([`Tables`](super::Tables)).
    pub wave: [f32; WAVE_PER_HOP],
}

impl TimedFeatures {
    /// A moment whose tables are silent.
    pub const fn new(time: f64, number: u64, features: Features) -> Self {
        Self { time, number, features, spectrum: [0.0; SPECTRUM_POINTS], wave: [0.0; WAVE_PER_HOP] }
    }
}
