//! Cuts a stream of sample frames into hops and measures the features of each.

use super::StereoFrame;
use super::bands::{Bands, decibels, height};
use super::decimate::Decimator;
use super::features::{Features, TimedFeatures};
use super::gain::{AutoGain, Gain, amplitude};
use super::hop_buffer::{HopBuffer, SAMPLE_MAX, hop_at};
use super::lines::Lines;
use super::pitch::strongest_hz;
use super::resolution::Resolution;
use super::rhythm::Rhythm;
use super::scale::{BAND_COUNT, WAVE_PER_HOP};
use super::smoothing::Follower;
use super::sounds::Sounds;
use super::spectrum::{SlowWindow, Spectrum};
use super::stereo::StereoImage;
use super::volume::{stretch_length, volumes};
use crate::limits;

/// The maximum position, in frames (190 000 years at 768 kHz), so that the frame count never overflows.
const POSITION_MAX: u64 = 1 << 62;

/// Attack and release times of the volume, in seconds. The slow release lets a drawn woofer swing back softly.
const VOLUME_ATTACK: f64 = 0.010;
const VOLUME_RELEASE: f64 = 0.150;

/// Attack and release times of the bands, in seconds. A bar rises at once and falls slowly enough to be read.
const BAND_ATTACK: f64 = 0.010;
const BAND_RELEASE: f64 = 0.200;

/// Release time of the feature `beat`, in seconds.
const BEAT_RELEASE: f64 = 0.15;

/// Sound below this level, in decibels, counts as room noise: its brightness is 0.
const QUIET_DB: f32 = -80.0;

/// Time constant of the leaky integral `bass_drive`, in seconds.
const DRIVE_SECONDS: f64 = 4.0;

/// Bands of `bass`: up to 144 Hz.
const BASS: std::ops::Range<usize> = 0..8;
/// Bands of `mid`: up to 1.85 kHz.
const MID: std::ops::Range<usize> = 8..21;
const TREBLE: std::ops::Range<usize> = 21..BAND_COUNT;

/// The middle of trailing windows is this many hops before the moment.
const TRAILING_LATE: f32 = 2.0;

/// The long window is not used above this frequency, in hertz.
const SLOW_HIGHEST_HZ: f64 = 1_500.0;

/// The position of the analysis windows relative to the moment that they describe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alignment {
    /// For files: the window is centred on the moment. Later samples are known, so the image need not be late.
    Centred,
    /// For live input: the window ends at the moment. The features are emitted once its last sample frame arrives.
    Trailing,
}

/// Returns the spectral centroid of the band `powers`, from 0 (lowest band) to 1 (highest); 0 for near silence.
fn centroid(powers: &[f32; BAND_COUNT], level_db: f32) -> f32 {
    if level_db < QUIET_DB {
        return 0.0;
    }
    let weighed = |place: fn(usize) -> f32| {
        powers.iter().enumerate().map(|(band, power)| place(band) * power).sum::<f32>()
    };
    weighed(|band| band as f32 / (BAND_COUNT - 1) as f32) / weighed(|_| 1.0)
}

/// Measures the features of a stream, once per hop.
///
/// The hop is 512 sample frames at 44.1 and 48 kHz. At other rates it is scaled by a power of two, so that it lasts 7.5
/// to 15.1 ms. The windows are 16, 4 and 2 hops long: the long window is for the bass, the short window for the treble
/// and for onsets. Moments are at whole multiples of the hop from frame 0 of the stream. [`Alignment`] places the
/// windows around each moment. Samples before the first and after the last frame count as silence.
///
/// The output depends, bit for bit, only on the samples. Only `new` allocates memory.
pub struct Analyzer {
    sample_rate: u32,
    lookahead: usize,
    /// The sample frames of the long window, which ends at frame `moment + lookahead`.
    buffer: HopBuffer,
    progress: Progress,
    slow: SlowWindow,
    /// For the middle and the short window: the range in the buffer, and the spectrum.
    windows: [(std::ops::Range<usize>, Spectrum); 2],
    volume_stretch: std::ops::Range<usize>,
    wave_stretch: std::ops::Range<usize>,
    bands: Bands,
    lines: Lines,
    followers: Followers,
    gain: AutoGain,
    rhythm: Rhythm,
    pub(super) sounds: Sounds,
    last: TimedFeatures,
}

/// The progress of the analysis, in sample frames from the start of the stream.
#[derive(Default)]
struct Progress {
    moment: u64,
    position: u64,
    /// True if frames were pushed since the start or the last restart.
    any: bool,
    has_measured: bool,
}

struct Followers {
    volume: Follower,
    bands: Follower,
    stereo: StereoImage,
    beat: Follower,
    drive: Follower,
}

impl Followers {
    fn new(hop_seconds: f64) -> Self {
        Self {
            volume: Follower::new(VOLUME_ATTACK, VOLUME_RELEASE, hop_seconds),
            bands: Follower::new(BAND_ATTACK, BAND_RELEASE, hop_seconds),
            stereo: StereoImage::new(BAND_RELEASE, hop_seconds),
            beat: Follower::new(BEAT_RELEASE, BEAT_RELEASE, hop_seconds),
            drive: Follower::new(DRIVE_SECONDS, DRIVE_SECONDS, hop_seconds),
        }
    }
}

impl Analyzer {
    /// Creates an analyzer with automatic gain for a stream that starts at frame 0. `sample_rate` is clamped to the
    /// limits' `sample_rate_min..=sample_rate_max`.
    pub fn new(sample_rate: u32, alignment: Alignment) -> Self {
        Self::with_gain(sample_rate, alignment, Gain::Auto)
    }

    /// Creates an analyzer with or without automatic gain.
    pub fn with_gain(sample_rate: u32, alignment: Alignment, gain: Gain) -> Self {
        let sample_rate = sample_rate.clamp(limits::SAMPLE_RATE_MIN, limits::SAMPLE_RATE_MAX);
        let rate = f64::from(sample_rate);
        let hop = hop_at(rate);
        let longest = hop * Resolution::Long.hops();
        let hop_seconds = hop as f64 / rate;
        let decimator = Decimator::new(hop);
        let slow_length = longest / decimator.step;
        let centred = alignment == Alignment::Centred;
        // A centred moment is at the middle of the decimated long window.
        let centre = (slow_length / 2 - 1) * decimator.step + decimator.delay() + 1;
        let (lookahead, late) = if centred { (centre, 0.0) } else { (0, TRAILING_LATE) };
        let place = |length: usize| {
            let start = longest - lookahead - if centred { length / 2 } else { length };
            start..start + length
        };
        let slow_gain = |bin: usize, decimator: &Decimator| {
            let hz = bin as f64 * rate / longest as f64;
            // Bins at or above `SLOW_HIGHEST_HZ` are not used.
            if hz < SLOW_HIGHEST_HZ { decimator.power_gain(hz, rate) } else { 1.0 }
        };
        // A waveform has four hops, but a moment emits only the last one: earlier moments emitted the other three.
        let wave_end = place(4 * hop).end;
        let mut analyzer = Self {
            sample_rate,
            lookahead,
            buffer: HopBuffer::new(longest, hop, 0),
            progress: Progress::default(),
            slow: SlowWindow::new(decimator, slow_length, slow_gain),
            windows: [Resolution::Middle, Resolution::Short].map(|resolution| {
                let length = hop * resolution.hops();
                (place(length), Spectrum::new(length, |_| 1.0))
            }),
            volume_stretch: place(stretch_length(sample_rate)),
            wave_stretch: wave_end - hop..wave_end,
            bands: Bands::new(hop, rate),
            lines: Lines::new(hop, rate),
            followers: Followers::new(hop_seconds),
            gain: AutoGain::new(gain, hop_seconds),
            rhythm: Rhythm::new(hop, rate, late, !centred),
            sounds: Sounds::new(hop, rate, centred),
            last: TimedFeatures::new(0.0, 0, Features::SILENCE),
        };
        analyzer.restart(0);
        analyzer
    }

    /// Turns automatic gain on or off. The gain then changes smoothly within tenths of a second.
    pub fn set_gain(&mut self, gain: Gain) {
        self.gain.set(gain);
    }

    /// The sample rate of the stream, in hertz.
    pub fn sample_rate(&self) -> u32 {
        self.sample_rate
    }

    /// The number of sample frames per hop.
    pub fn hop(&self) -> usize {
        self.buffer.hop
    }

    /// The features of a moment are emitted this many sample frames after the moment. With centred windows the number
    /// is half the long window (85 ms at 48 kHz) plus the delay of the decimating filter. With trailing windows it is
    /// 0.
    pub fn lookahead(&self) -> usize {
        self.lookahead
    }

    /// Resets the analyzer. The next frame pushed is frame `position` of the stream, counted from 0. All sound before
    /// this frame counts as silence. To get the same features as an uninterrupted analysis after a seek, restart a
    /// second earlier.
    pub fn restart(&mut self, position: u64) {
        let position = position.min(POSITION_MAX);
        let moment = position.next_multiple_of(self.hop() as u64);
        self.progress = Progress { moment, position, ..Progress::default() };
        // `ahead` never exceeds the buffer: the moment is less than a hop ahead, and its window reaches back further.
        let ahead = self.lookahead + (moment - position) as usize;
        self.buffer.restart(self.buffer.frames.len() - ahead);
        // The followers allocate no memory.
        self.followers = Followers::new(self.hop() as f64 / f64::from(self.sample_rate));
        self.gain.restart();
        self.rhythm.restart();
        self.sounds.restart();
        self.last = TimedFeatures::new(0.0, 0, Features::SILENCE);
    }

    /// Analyses the next sample frames, any number of them, and emits the features of each completed moment. Samples
    /// that are not finite count as 0, and all others are clamped to ±8.
    pub fn push(&mut self, frames: &[StereoFrame], emit: &mut dyn FnMut(&TimedFeatures)) {
        self.progress.any |= !frames.is_empty();
        self.progress.position += frames.len() as u64;
        let mut rest = frames;
        while !rest.is_empty() {
            (_, rest) = self.buffer.fill(rest);
            self.emit_if_full(emit);
        }
    }

    /// Ends the stream. If frames were pushed, treats all later sound as silence and emits the remaining moments, up to
    /// the first moment at or after the end. Then resets the analyzer.
    pub fn finish(&mut self, emit: &mut dyn FnMut(&TimedFeatures)) {
        while self.progress.any && self.progress.moment < self.progress.position + self.hop() as u64 {
            self.buffer.end();
            self.emit_if_full(emit);
        }
        self.restart(0);
    }

    fn emit_if_full(&mut self, emit: &mut dyn FnMut(&TimedFeatures)) {
        if self.buffer.is_full() {
            self.measure();
            emit(&self.last);
            self.buffer.advance();
            self.progress.moment += self.hop() as u64;
        }
    }

    fn measure(&mut self) {
        let (history, hop) = (&self.buffer.frames, self.buffer.hop);
        // The first measurement after a restart fills the whole long window.
        let has_measured = std::mem::replace(&mut self.progress.has_measured, true);
        self.slow.follow(history, if has_measured { hop } else { history.len() });
        let long = self.slow.spectrum();
        let [middle, short] =
            self.windows.each_mut().map(|(place, spectrum)| spectrum.measure(&history[place.clone()]));
        let stereo = self.bands.stereo([long, middle, short]);
        let spectra = [long, middle, short].map(|spectrum| spectrum.power.as_slice());
        let [long, middle, short] = spectra;
        let powers = self.bands.powers(spectra);
        let power = powers.iter().sum();
        let gain_db = self.gain.follow(power);

        self.last.number = self.progress.moment / hop as u64;
        self.last.time = self.progress.moment as f64 / f64::from(self.sample_rate);
        let features = &mut self.last.features;
        features.gain_db = gain_db;
        features.level_db = decibels(power);
        features.band_levels_db = powers.map(decibels);
        features.peak_hz = strongest_hz([long, middle], f64::from(self.sample_rate), hop);
        for (value, level) in features.bands.iter_mut().zip(features.band_levels_db) {
            self.followers.bands.follow(value, height(level + gain_db));
        }
        [features.pan, features.width] = self.followers.stereo.follow(&powers, &stereo);
        self.followers.bands.follow(&mut features.brightness, centroid(&powers, features.level_db));
        let mean = |bands: &[f32]| bands.iter().sum::<f32>() / bands.len() as f32;
        features.bass = mean(&features.bands[BASS]);
        features.mid = mean(&features.bands[MID]);
        features.treble = mean(&features.bands[TREBLE]);
        // In steady state, the leaky integral is its input times its time constant.
        self.followers.drive.follow(&mut features.bass_drive, DRIVE_SECONDS as f32 * features.bass);

        let volumes = volumes(&history[self.volume_stretch.clone()]);
        let scale = amplitude(gain_db);
        let [left, right] = &mut features.volume;
        let followed = [left, right, &mut features.volume_mid, &mut features.volume_side];
        for (value, target) in followed.into_iter().zip(volumes) {
            self.followers.volume.follow(value, (scale * target).min(SAMPLE_MAX));
        }

        self.sounds.follow(&history[history.len() - hop..], spectra, features);

        let mut heights = [0.0; _];
        self.lines.heights(spectra, gain_db, &mut heights);
        for (value, height) in self.last.spectrum.iter_mut().zip(heights) {
            self.followers.bands.follow(value, height);
        }
        let begins = self.rhythm.follow([middle, short], &powers, &mut self.last);
        let beat = &mut self.last.features.beat;
        self.followers.beat.follow(beat, 0.0);
        if begins {
            *beat = 1.0;
        }
        mean_of_channels(&history[self.wave_stretch.clone()], &mut self.last.wave);
    }
}

/// Averages both channels over the frames of each point. If there are fewer frames than points, frames repeat.
fn mean_of_channels(frames: &[StereoFrame], wave: &mut [f32; WAVE_PER_HOP]) {
    for (index, point) in wave.iter_mut().enumerate() {
        let [start, end] = [index, index + 1].map(|index| index * frames.len() / WAVE_PER_HOP);
        let group = &frames[start..end.max(start + 1)];
        *point = group.iter().map(|[left, right]| left + right).sum::<f32>() / (2 * group.len()) as f32;
    }
}
