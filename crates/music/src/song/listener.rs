//! Measures a song's samples and stores compact measurements, from which the structure is analysed at the end.

use ebur128::{EbuR128, Mode};

use super::chroma::FineChroma;
use super::heard::{Heard, Moment, SLOW_HOPS, SlowMoment, TIMBRE_BANDS};
use super::structure::SongStructure;
use crate::activation::{self, Activation, STEP_HOPS, WINDOW_HOPS};
use crate::decimate::Decimator;
use crate::hop_buffer::{HopBuffer, hop_at};
use crate::onset::{Onset, Onsets};
use crate::rises::{LowAndHigh, Rises};
use crate::scale::band_bins;
use crate::spectrum::{SlowWindow, Spectrum};
use crate::{StereoFrame, limits};

/// The lengths of the windows for onsets and for pitches (341 ms), in hops.
const SHORT_HOPS: usize = 2;
const LONG_HOPS: usize = 32;
/// Listens to a whole song and returns its structure at the end.
///
/// The result depends only on the samples, not on the sizes of the pushed blocks. Only the first `song_seconds_max` of
/// the limits are analysed. Memory is below 4 kB per second.
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
    buffer: HopBuffer,
    /// The spectra for onsets, and for the odds of beats.
    spectra: [Spectrum; 2],
    activation: Activation,
    onsets: Onsets,
    rises: Rises,
    timbre_edges: Vec<usize>,
    /// The power of each timbre band, averaged since the last slow moment.
    timbre: [f32; TIMBRE_BANDS],
    slow: SlowWindow,
    pitches: FineChroma,
    /// Measures the integrated loudness. It is `None` after an error; the song then has no loudness.
    meter: Option<EbuR128>,
    frames: u64,
    frames_max: u64,
    heard: Heard,
}

impl SongListener {
    /// Creates a listener for a song at `sample_rate`, clamped to the limits' `sample_rate_min..=sample_rate_max`.
    pub fn new(sample_rate: u32) -> Self {
        let rate = f64::from(sample_rate.clamp(limits::SAMPLE_RATE_MIN, limits::SAMPLE_RATE_MAX));
        let hop = hop_at(rate);
        let (short, bin_hz) = (hop * SHORT_HOPS, rate / (hop * SHORT_HOPS) as f64);
        let decimator = Decimator::new(hop);
        let long_length = LONG_HOPS * hop / decimator.step;
        let long_rate = rate / decimator.step as f64;
        let gain = |index: usize, decimator: &Decimator| {
            let hz = index as f64 * long_rate / long_length as f64;
            // Limit the gain for frequencies that the filter hardly passes.
            decimator.power_gain(hz, rate).max(1e-2)
        };
        let hop_seconds = hop as f64 / rate;
        let length = (WINDOW_HOPS * hop).max(hop + 4 * decimator.step);
        Self {
            rate,
            buffer: HopBuffer::new(length, hop, length - hop),
            spectra: [short, WINDOW_HOPS * hop].map(|length| Spectrum::new(length, |_| 1.0)),
            activation: Activation::new(activation::WHOLE, hop, rate),
            onsets: Onsets::new(short / 2, bin_hz, hop_seconds),
            rises: Rises::new(short / 2, bin_hz, hop_seconds),
            timbre_edges: band_bins(TIMBRE_BANDS, bin_hz, short / 2),
            timbre: [0.0; TIMBRE_BANDS],
            slow: SlowWindow::new(decimator, long_length, gain),
            pitches: FineChroma::new(long_rate / long_length as f64, long_length / 2),
            meter: EbuR128::new(2, rate as u32, Mode::I).ok(),
            frames: 0,
            frames_max: (limits::SONG_SECONDS_MAX * rate) as u64,
            heard: Heard {
                hop_seconds,
                // The chroma is late by half of the long window.
                chroma_late: LONG_HOPS / 2 / SLOW_HOPS,
                ..Heard::default()
            },
        }
    }

    /// Analyses the next sample frames, any number of them. Samples that are not finite count as 0, and all others are
    /// clamped to ±8.
    pub fn push(&mut self, frames: &[StereoFrame]) {
        let room = usize::try_from(self.frames_max - self.frames).unwrap_or(usize::MAX);
        self.heard.cut_short |= frames.len() > room;
        let frames = &frames[..frames.len().min(room)];
        self.frames += frames.len() as u64;
        self.process(frames);
    }

    /// Ends the song and returns its structure.
    pub fn finish(mut self) -> SongStructure {
        self.heard.seconds = self.frames as f64 / self.rate;
        // Measure the loudness before silence is pushed. It is minus infinity if all parts are too quiet.
        let loudness = self.meter.take().and_then(|meter| meter.loudness_global().ok());
        self.heard.loudness =
            loudness.filter(|loudness| loudness.is_finite()).map(|loudness| loudness as f32);
        // Flush the windows with silence, up to the end of the last slow moment.
        let silence = vec![[0.0; 2]; self.buffer.hop];
        for _ in 0..LONG_HOPS / 2 + SLOW_HOPS {
            self.process(&silence);
        }
        self.heard.tuning = self.pitches.tuning();
        let late = self.activation.late();
        let rest = (0..late).map(|_| self.activation.end());
        self.heard.beat_odds.extend(rest);
        // The first results are of moments before the start.
        self.heard.beat_odds.drain(..late.min(self.heard.beat_odds.len()));
        SongStructure::of(&self.heard)
    }

    fn process(&mut self, frames: &[StereoFrame]) {
        let mut rest = frames;
        while !rest.is_empty() {
            let taken;
            (taken, rest) = self.buffer.fill(rest);
            if self.meter.as_mut().is_some_and(|meter| meter.add_frames_f32(taken.as_flattened()).is_err()) {
                self.meter = None;
            }
            if self.buffer.is_full() {
                self.measure();
                self.buffer.advance();
            }
        }
    }

    fn measure(&mut self) {
        let hop = self.buffer.hop;
        let peak = self.buffer.newest(hop).iter().flatten().fold(0.0_f32, |peak, x| peak.max(x.abs()));
        self.slow.follow(&self.buffer.frames, hop);

        let [short, middle] = &mut self.spectra;
        let bins = &short.measure(self.buffer.newest(SHORT_HOPS * hop)).power;
        let LowAndHigh { power, low_power, low_rise, high_rise } = self.rises.follow(bins);
        for (mean, edges) in self.timbre.iter_mut().zip(self.timbre_edges.windows(2)) {
            *mean += bins[edges[0]..edges[1]].iter().sum::<f32>() / SLOW_HOPS as f32;
        }
        // Low sounds alone do not count as onsets of a section.
        let Onset { begins, flux, .. } = self.onsets.follow(bins, None);
        self.heard.moments.push(Moment { flux, begins, low_rise, high_rise, power, low_power, peak });
        let hops = self.heard.moments.len();
        if hops.is_multiple_of(STEP_HOPS) {
            let spectrum = middle.measure(self.buffer.newest(WINDOW_HOPS * hop));
            let odds = self.activation.follow(&spectrum.power);
            self.heard.beat_odds.push(odds);
        }
        if hops.is_multiple_of(SLOW_HOPS) {
            let chroma = self.pitches.chroma(&self.slow.spectrum().power);
            let timbre = std::mem::take(&mut self.timbre);
            self.heard.slow.push(SlowMoment { timbre, chroma });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_song_beyond_the_limit_is_cut_short() {
        let second = vec![[0.0; 2]; limits::SAMPLE_RATE_MIN as usize];
        let mut listener = SongListener::new(limits::SAMPLE_RATE_MIN);
        assert_eq!(listener.frames_max as f64, limits::SONG_SECONDS_MAX * second.len() as f64);
        listener.frames_max = 2 * second.len() as u64;
        for block in [&second[..], &second[..], &[[1.0; 2]]] {
            listener.push(block);
        }
        let found = listener.finish();
        assert!(found.cut_short && found.silent && found.seconds == 2.0);
    }
}
