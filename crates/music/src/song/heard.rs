//! The measurements of a song, stored until its structure is analysed.

use super::chroma::{FINE_BINS, Tuning};
use std::ops::Range;

/// The number of timbre bands, in equal ratios from 30 Hz to 16 kHz.
pub(super) const TIMBRE_BANDS: usize = 20;

/// Timbre and chroma are measured once every this many hops.
pub(super) const SLOW_HOPS: usize = 8;

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moment {
    pub(super) flux: f32,
    /// True at the onset of a sound.
    pub(super) begins: bool,
    /// The rise of each band's amplitude, relative to the loudest recent amplitude.
    pub(super) low_rise: f32,
    pub(super) high_rise: f32,
    pub(super) power: f32,
    pub(super) low_power: f32,
    pub(super) peak: f32,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct SlowMoment {
    pub(super) timbre: [f32; TIMBRE_BANDS],
    /// The amplitudes of pitches, folded into one octave.
    pub(super) chroma: [f32; FINE_BINS],
}

#[derive(Debug, Default)]
pub(super) struct Heard {
    pub(super) hop_seconds: f64,
    pub(super) seconds: f64,
    pub(super) cut_short: bool,
    /// The integrated loudness in LUFS; `None` if the song is too quiet.
    pub(super) loudness: Option<f32>,
    /// One moment for each hop. Moment n is n hops after the start.
    pub(super) moments: Vec<Moment>,
    /// The log odds of a beat, every [`crate::activation::STEP_HOPS`] hops.
    pub(super) beat_odds: Vec<f32>,
    /// Slow moment n ends at (n + 1) · [`SLOW_HOPS`] hops. Its chroma describes an earlier sound, by `chroma_late`.
    pub(super) slow: Vec<SlowMoment>,
    /// The delay of the chroma, in slow moments.
    pub(super) chroma_late: usize,
    pub(super) tuning: Tuning,
}

impl Heard {
    /// Returns the time range from the first to the last moment within 40 dB of the loudest, in seconds.
    pub(super) fn sounding(&self) -> Range<f64> {
        let loudest = self.moments.iter().fold(0.0_f32, |loudest, moment| loudest.max(moment.power));
        let sounds = |moment: &Moment| moment.power >= loudest * 1e-4;
        let first = self.moments.iter().position(sounds).unwrap_or_default();
        let last = self.moments.iter().rposition(sounds).unwrap_or_default();
        first as f64 * self.hop_seconds..(last + 1) as f64 * self.hop_seconds
    }
}
