//! Takes a song's frames and keeps little numbers of them, from which the structure is found at the end.

use std::ops::Range;

use super::chroma::{FINE_BINS, FineChroma, Tuning};
use super::structure::SongStructure;
use crate::StereoFrame;
use crate::bands::{BAND_HIGHEST_HZ, BAND_LOWEST_HZ};
use crate::decimate::Decimator;
use crate::limits::LIMITS;
use crate::onset::{Flux, Onsets};
use crate::rises::{LowAndHigh, Rises};
use crate::spectrum::Spectrum;
use ebur128::{EbuR128, Mode};

/// Bands of the timbre, in equal ratios from 30 Hz to 16 kHz.
pub(super) const TIMBRE_BANDS: usize = 20;

/// Samples are clamped to this magnitude.
const SAMPLE_MAX: f32 = 8.0;

/// Rate for which the hop is given, in hertz.
const REFERENCE_RATE: f64 = 48_000.0;
/// Frames from one onset strength to the next at the reference rate: 10.7 ms.
const REFERENCE_HOP: f64 = 512.0;
/// Hops of the window in which onsets are heard.
const SHORT_HOPS: usize = 2;
/// Hops of the window in which pitches are heard: 341 ms.
const LONG_HOPS: usize = 32;
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

/// Listens to a whole song, to tell its structure at its end.
///
/// What it tells depends on the frames alone, not on how they were cut into blocks. A song may last as long as
/// `song_seconds_max` of the limits; what comes after that is not heard. It keeps less than 4 kB for each second.
///
/// ```
/// use mariana_music::{SongListener, StereoFrame};
///
/// let silence: Vec<StereoFrame> = vec![[0.0; 2]; 48_000];
/// let mut listener = SongListener::new(48_000);
/// listener.push(&silence);
/// let structure = listener.finish();
/// assert!(structure.beats.is_empty() && structure.key.is_none());
/// ```
pub struct SongListener {
    rate: f64,
    hop: usize,
    /// The last frames, of which the newest fill up.
    buffer: Vec<StereoFrame>,
    filled: usize,
    short: Spectrum,
    flux: Flux,
    onsets: Onsets,
    /// Ends of the timbre's bands, in bins.
    edges: [usize; TIMBRE_BANDS + 1],
    rises: Rises,
    decimator: Decimator,
    kept: Vec<StereoFrame>,
    long: Spectrum,
    pitches: FineChroma,
    timbre: [f32; TIMBRE_BANDS],
    /// Measures the integrated loudness. None if it cannot be: then the song has none.
    meter: Option<EbuR128>,
    hops: usize,
    frames: u64,
    frames_max: u64,
    heard: Heard,
}

impl SongListener {
    /// For a song of `sample_rate` frames per second. A rate outside the limits' `sample_rate_min..=sample_rate_max`
    /// is replaced by the nearest one inside.
    pub fn new(sample_rate: u32) -> Self {
        let rate = f64::from(sample_rate.clamp(LIMITS.sample_rate_min, LIMITS.sample_rate_max));
        let hop = (REFERENCE_HOP * (rate / REFERENCE_RATE).log2().round().exp2()) as usize;
        let (short, bin_hz) = (hop * SHORT_HOPS, rate / (hop * SHORT_HOPS) as f64);
        let bin = |hz: f64| ((hz / bin_hz).round() as usize).clamp(1, short / 2);
        let mut edges = [0; TIMBRE_BANDS + 1];
        let mut least = 1;
        for (index, edge) in edges.iter_mut().enumerate() {
            let share = index as f64 / TIMBRE_BANDS as f64;
            // Each band has at least one bin.
            *edge = bin(BAND_LOWEST_HZ * (BAND_HIGHEST_HZ / BAND_LOWEST_HZ).powf(share))
                .max(least)
                .min(short / 2);
            least = *edge + 1;
        }
        let decimator = Decimator::new(hop);
        let long_length = LONG_HOPS * hop / decimator.step();
        let long_rate = rate / decimator.step() as f64;
        let gain = |index: usize| {
            let hz = index as f64 * long_rate / long_length as f64;
            // Where the filter lets hardly anything pass, nothing is read.
            decimator.power_gain(hz, rate).max(1e-2)
        };
        let hop_seconds = hop as f64 / rate;
        Self {
            rate,
            hop,
            buffer: vec![[0.0; 2]; short.max(hop + 4 * decimator.step())],
            filled: short.max(hop + 4 * decimator.step()) - hop,
            short: Spectrum::new(short, |_| 1.0),
            flux: Flux::new(short / 2, bin_hz, hop_seconds),
            onsets: Onsets::new(hop_seconds),
            edges,
            rises: Rises::new(short / 2, bin_hz, hop_seconds),
            kept: vec![[0.0; 2]; long_length],
            long: Spectrum::new(long_length, gain),
            pitches: FineChroma::new(long_rate / long_length as f64, long_length / 2),
            decimator,
            timbre: [0.0; TIMBRE_BANDS],
            meter: EbuR128::new(2, rate as u32, Mode::I).ok(),
            hops: 0,
            frames: 0,
            frames_max: (LIMITS.song_seconds_max * rate) as u64,
            heard: Heard {
                hop_seconds,
                // Half of the window.
                chroma_late: LONG_HOPS / 2 / SLOW_HOPS,
                ..Heard::default()
            },
        }
    }

    /// Takes the next frames, any number of them. Samples that are not finite count as 0; others are clamped to ±8.
    pub fn push(&mut self, frames: &[StereoFrame]) {
        let room = usize::try_from(self.frames_max - self.frames).unwrap_or(usize::MAX);
        self.heard.cut_short |= frames.len() > room;
        let frames = &frames[..frames.len().min(room)];
        self.frames += frames.len() as u64;
        self.take(frames);
    }

    /// Ends the song and tells its structure.
    pub fn finish(mut self) -> SongStructure {
        self.heard.seconds = self.frames as f64 / self.rate;
        // Taken before the silence that follows. Where nothing counts it is minus infinity.
        let loudness = self.meter.take().and_then(|meter| meter.loudness_global().ok());
        self.heard.loudness =
            loudness.filter(|loudness| loudness.is_finite()).map(|loudness| loudness as f32);
        // What the windows still hold, and to the end of the last slow moment.
        let silence = vec![[0.0; 2]; self.hop];
        for _ in 0..LONG_HOPS / 2 + SLOW_HOPS {
            self.take(&silence);
        }
        self.heard.tuning = self.pitches.tuning();
        SongStructure::of(&self.heard)
    }

    fn take(&mut self, frames: &[StereoFrame]) {
        let mut rest = frames;
        while !rest.is_empty() {
            let free = &mut self.buffer[self.filled..];
            let (now, later) = rest.split_at(rest.len().min(free.len()));
            for (stored, frame) in free.iter_mut().zip(now) {
                *stored = frame.map(|x| if x.is_finite() { x.clamp(-SAMPLE_MAX, SAMPLE_MAX) } else { 0.0 });
            }
            let taken = &self.buffer[self.filled..self.filled + now.len()];
            if self.meter.as_mut().is_some_and(|meter| meter.add_frames_f32(taken.as_flattened()).is_err()) {
                self.meter = None;
            }
            self.filled += now.len();
            rest = later;
            if self.filled == self.buffer.len() {
                self.hop();
                self.buffer.copy_within(self.hop.., 0);
                self.filled -= self.hop;
            }
        }
    }

    /// Measures a full buffer.
    fn hop(&mut self) {
        let newest = &self.buffer[self.buffer.len() - self.hop..];
        let peak = newest.iter().flatten().fold(0.0_f32, |peak, x| peak.max(x.abs()));
        let per_hop = self.hop / self.decimator.step();
        self.kept.copy_within(per_hop.., 0);
        let start = self.kept.len() - per_hop;
        self.decimator.keep(&self.buffer, &mut self.kept[start..]);

        let bins = self.short.power(&self.buffer[self.buffer.len() - SHORT_HOPS * self.hop..]);
        let rise = self.flux.follow(bins);
        let LowAndHigh { power, low_power, low_rise, high_rise } = self.rises.follow(bins);
        for (sum, edges) in self.timbre.iter_mut().zip(self.edges.windows(2)) {
            *sum += bins[edges[0]..edges[1]].iter().sum::<f32>() / SLOW_HOPS as f32;
        }
        self.heard.moments.push(Moment {
            flux: rise.flux,
            begins: self.onsets.follow(rise).0,
            low_rise,
            high_rise,
            power,
            low_power,
            peak,
        });
        self.hops += 1;
        if self.hops.is_multiple_of(SLOW_HOPS) {
            let chroma = self.pitches.chroma(self.long.power(&self.kept));
            let timbre = std::mem::replace(&mut self.timbre, [0.0; TIMBRE_BANDS]);
            self.heard.slow.push(SlowMoment { timbre, chroma });
        }
    }
}
