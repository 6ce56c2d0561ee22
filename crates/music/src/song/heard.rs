//! Measurements of a song, kept until its structure is found.

use std::ops::Range;

use super::chroma::{FINE_BINS, Tuning};

/// Bands of the timbre, in equal ratios from 30 Hz to 16 kHz.
pub(super) const TIMBRE_BANDS: usize = 20;

/// Hops from one timbre and chroma to the next.
pub(super) const SLOW_HOPS: usize = 8;

/// What is kept of the moments of a hop.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moment {
    /// The spectral flux.
    pub(super) flux: f32,
    /// Whether a sound begins.
    pub(super) begins: bool,
    /// Rise of the low band's amplitude, relative to the loudest amplitude of late.
    pub(super) low_rise: f32,
    /// The same of what is high.
    pub(super) high_rise: f32,
    /// Power of everything.
    pub(super) power: f32,
    /// Power of what is low.
    pub(super) low_power: f32,
    /// Largest magnitude of the samples of the hop.
    pub(super) peak: f32,
}

/// What is kept of the moments of [`SLOW_HOPS`] hops.
#[derive(Clone, Copy, Debug)]
pub(super) struct SlowMoment {
    /// Mean power of each band.
    pub(super) timbre: [f32; TIMBRE_BANDS],
    /// Amplitude of the pitches that sound, folded into one octave.
    pub(super) chroma: [f32; FINE_BINS],
}

/// All that is kept of a song.
#[derive(Debug, Default)]
pub(super) struct Heard {
    /// Seconds from one moment to the next.
    pub(super) hop_seconds: f64,
    /// Length of the song, in seconds.
    pub(super) seconds: f64,
    /// Whether the song went on after what was listened to.
    pub(super) cut_short: bool,
    /// The integrated loudness, in LUFS; none if nothing is loud enough to count.
    pub(super) loudness: Option<f32>,
    /// Moment n lies at n hops.
    pub(super) moments: Vec<Moment>,
    /// Slow moment n ends at (n + 1) · [`SLOW_HOPS`] hops; its chroma is late by [`Heard::chroma_late`].
    pub(super) slow: Vec<SlowMoment>,
    /// By how many slow moments the chroma is late.
    pub(super) chroma_late: usize,
    /// How the instruments are tuned.
    pub(super) tuning: Tuning,
}

impl Heard {
    /// From the first to the last moment within 40 dB of the loudest, in seconds.
    pub(super) fn sounding(&self) -> Range<f64> {
        let loudest = self.moments.iter().fold(0.0_f32, |loudest, moment| loudest.max(moment.power));
        let sounds = |moment: &Moment| moment.power >= loudest * 1e-4;
        let first = self.moments.iter().position(sounds).unwrap_or_default();
        let last = self.moments.iter().rposition(sounds).unwrap_or_default();
        first as f64 * self.hop_seconds..(last + 1) as f64 * self.hop_seconds
    }
}
