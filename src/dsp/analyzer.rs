//! Cuts a stream of frames into fixed hops and measures the features of each.

use super::StereoFrame;
use super::bands::{Bands, height};
use super::features::{Features, TimedFeatures};
use super::smoothing::Follower;
use super::spectrum::Spectrum;
use super::volume::{mean_magnitude, stretch_length};
use crate::limits::LIMITS;

/// Samples are clamped to this magnitude (+18 dB), so that no input makes a feature overflow.
const SAMPLE_MAX: f32 = 8.0;

/// Rate for which the hop and the window below are given, in hertz.
const REFERENCE_RATE: f64 = 48_000.0;

/// Frames from one moment to the next at the reference rate: 10.7 ms.
const REFERENCE_HOP: f64 = 512.0;

/// Hops per window: 4096 frames, 85 ms, at the reference rate.
const HOPS_PER_WINDOW: usize = 8;

/// Positions are clamped to this (190 000 years at 768 kHz), so that counting on from one never overflows.
const POSITION_MAX: u64 = 1 << 62;

/// Time constants of the volume, in seconds. The release lets a woofer swing back softly.
const VOLUME_ATTACK: f64 = 0.010;
/// See [`VOLUME_ATTACK`].
const VOLUME_RELEASE: f64 = 0.150;

/// Time constants of the bands' heights, in seconds. A bar rises with the sound and sinks readably.
const BAND_ATTACK: f64 = 0.010;
/// See [`BAND_ATTACK`].
const BAND_RELEASE: f64 = 0.200;

/// Where the window of a moment lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alignment {
    /// Centred on the moment, for files: what comes after is known. The picture is not late by half a window.
    Centred,
    /// Ending at the moment, for live input, whose future is not known: features are emitted with the last frame.
    Trailing,
}

/// Turns frames into features, one set per hop.
///
/// The hop is 512 frames and the window 4096 at 44.1 and 48 kHz, scaled by the nearest power of two at other rates
/// (hop 7.5 to 15.1 ms, window 60 to 121 ms). Moments lie at whole multiples of the hop, counted from frame 0 of
/// the stream. The [`Alignment`] says where the window lies: centred on its moment it reads half a window
/// ([`Analyzer::lookahead`]) of what comes after. Before the first frame and after the last there is silence.
///
/// What is emitted depends on the frames alone, bit for bit, not on how they were cut into blocks. Nothing is
/// allocated after `new`.
pub struct Analyzer {
    sample_rate: u32,
    hop: usize,
    lookahead: usize,
    /// The window being filled; its end is the frame at `moment + lookahead`.
    history: Vec<StereoFrame>,
    filled: usize,
    /// Stream index of the next moment.
    moment: u64,
    /// Stream index of the next frame to be pushed.
    position: u64,
    /// Whether frames were pushed since the (re)start.
    any: bool,
    spectrum: Spectrum,
    bands: Bands,
    volume_stretch: std::ops::Range<usize>,
    volume_follower: Follower,
    band_follower: Follower,
    /// The features of the last moment.
    features: Features,
}

impl Analyzer {
    /// For a stream of `sample_rate` frames per second, that starts at frame 0. A rate outside the limits'
    /// `sample_rate_min..=sample_rate_max` is taken as the nearest one inside.
    pub fn new(sample_rate: u32, alignment: Alignment) -> Self {
        let sample_rate = sample_rate.clamp(LIMITS.sample_rate_min, LIMITS.sample_rate_max);
        let rate = f64::from(sample_rate);
        let hop = (REFERENCE_HOP * (rate / REFERENCE_RATE).log2().round().exp2()) as usize;
        let window = hop * HOPS_PER_WINDOW;
        let hop_seconds = hop as f64 / rate;
        let stretch = stretch_length(sample_rate);
        let (lookahead, stretch_end) = match alignment {
            Alignment::Centred => (window / 2, (window + stretch) / 2),
            Alignment::Trailing => (0, window),
        };
        let mut analyzer = Self {
            sample_rate,
            hop,
            lookahead,
            history: vec![[0.0; 2]; window],
            filled: 0,
            moment: 0,
            position: 0,
            any: false,
            spectrum: Spectrum::new(window),
            bands: Bands::new(window / 2, rate / window as f64),
            volume_stretch: stretch_end - stretch..stretch_end,
            volume_follower: Follower::new(VOLUME_ATTACK, VOLUME_RELEASE, hop_seconds),
            band_follower: Follower::new(BAND_ATTACK, BAND_RELEASE, hop_seconds),
            features: Features::SILENCE,
        };
        analyzer.restart(0);
        analyzer
    }

    /// Frames per second of the stream.
    pub fn sample_rate(&self) -> u32 {
        self.sample_rate
    }

    /// Frames from one moment to the next.
    pub fn hop(&self) -> usize {
        self.hop
    }

    /// Frames that must follow a moment before its features are emitted: centred half a window, 43 ms at 48 kHz; else none.
    pub fn lookahead(&self) -> usize {
        self.lookahead
    }

    /// Forgets everything; the next frame pushed is frame `position` of the stream (0 is its start).
    ///
    /// The first moment is the first multiple of the hop at or after `position`; what lies before counts as
    /// silence. To meet the features of an uninterrupted analysis after a seek, start a second earlier.
    pub fn restart(&mut self, position: u64) {
        let position = position.min(POSITION_MAX);
        self.moment = position.next_multiple_of(self.hop as u64);
        self.position = position;
        self.any = false;
        self.history.fill([0.0; 2]);
        // A moment is less than a hop ahead, and the window behind it is longer than a hop.
        self.filled = self.history.len() - self.lookahead - (self.moment - position) as usize;
        self.features = Features::SILENCE;
    }

    /// Takes the next frames, any number of them, and emits the features of each moment that became complete.
    /// Samples that are not finite count as 0; others are clamped to ±8.
    pub fn push(&mut self, frames: &[StereoFrame], emit: &mut dyn FnMut(TimedFeatures)) {
        self.any |= !frames.is_empty();
        self.position += frames.len() as u64;
        let mut rest = frames;
        while !rest.is_empty() {
            let free = &mut self.history[self.filled..];
            let (now, later) = rest.split_at(rest.len().min(free.len()));
            for (stored, frame) in free.iter_mut().zip(now) {
                *stored = frame.map(sanitised);
            }
            self.filled += now.len();
            rest = later;
            self.emit_if_full(emit);
        }
    }

    /// Ends the stream: emits what is left, with silence after the last frame, until a moment lies at or after the
    /// end of the stream. Emits nothing if nothing was pushed. Then the analyzer is as new.
    pub fn finish(&mut self, emit: &mut dyn FnMut(TimedFeatures)) {
        // A moment before `position + hop` is the last one to be before or the first one to be at the end.
        while self.any && self.moment < self.position + self.hop as u64 {
            self.history[self.filled..].fill([0.0; 2]);
            self.filled = self.history.len();
            self.emit_if_full(emit);
        }
        self.restart(0);
    }

    /// Measures a full window, emits, and moves the window on by a hop.
    fn emit_if_full(&mut self, emit: &mut dyn FnMut(TimedFeatures)) {
        if self.filled < self.history.len() {
            return;
        }
        let levels = self.bands.levels_db(self.spectrum.power(&self.history));
        let volume = mean_magnitude(&self.history[self.volume_stretch.clone()]);
        self.features.band_levels_db = levels;
        for (value, target) in self.features.volume.iter_mut().zip(volume) {
            self.volume_follower.follow(value, target);
        }
        for (value, level) in self.features.bands.iter_mut().zip(levels) {
            self.band_follower.follow(value, height(level));
        }
        let time = self.moment as f64 / f64::from(self.sample_rate);
        emit(TimedFeatures { time, features: self.features });
        self.history.copy_within(self.hop.., 0);
        self.filled -= self.hop;
        self.moment += self.hop as u64;
    }
}

fn sanitised(sample: f32) -> f32 {
    if sample.is_finite() { sample.clamp(-SAMPLE_MAX, SAMPLE_MAX) } else { 0.0 }
}
