//! Onsets, beats and bars, from the short window.

use super::beat::{Beat, BeatTracker};
use super::live_bars::{LiveBar, LiveBars, Strokes};
use super::onset::{Flux, LowFlux, Onsets};
use super::rises::Rises;
use super::scale::SPECTRUM_POINTS;

pub(super) struct RhythmMoment {
    pub(super) begins: bool,
    pub(super) beat: Beat,
    strokes: Option<Strokes>,
}

pub(super) struct Rhythm {
    flux: Flux,
    low: LowFlux,
    onsets: Onsets,
    beats: BeatTracker,
    /// The bar tracker, for live input only. Bars of songs come from [`crate::song`].
    bars: Option<(Rises, LiveBars)>,
}

impl Rhythm {
    /// Creates a tracker for short spectra of `bins` bins of `bin_hz` hertz, and spectra of twice this length. Onsets
    /// appear `late` hops after they happened.
    pub(super) fn new(bins: usize, bin_hz: f64, hop_seconds: f64, late: f32, with_bars: bool) -> Self {
        Self {
            flux: Flux::new(bins, bin_hz, hop_seconds),
            low: LowFlux::new(2 * bins, 0.5 * bin_hz, hop_seconds),
            onsets: Onsets::new(hop_seconds),
            beats: BeatTracker::new(hop_seconds, late),
            bars: with_bars.then(|| (Rises::new(bins, bin_hz, hop_seconds), LiveBars::new())),
        }
    }

    pub(super) fn restart(&mut self) {
        self.flux.restart();
        self.low.restart();
        self.onsets.restart();
        self.beats.restart();
        if let Some((rises, bars)) = &mut self.bars {
            rises.restart();
            bars.restart();
        }
    }

    pub(super) fn follow(&mut self, middle: &[f32], short: &[f32]) -> RhythmMoment {
        let rise = self.flux.follow(short);
        let (begins, flux) = self.onsets.follow(rise, self.low.follow(middle, &self.flux));
        let strokes = self.bars.as_mut().map(|(rises, _)| Strokes::of(rises.follow(short), flux));
        RhythmMoment { begins, beat: self.beats.follow(flux, begins), strokes }
    }

    pub(super) fn bar(&mut self, pulse: RhythmMoment, spectrum: &[f32; SPECTRUM_POINTS]) -> Option<LiveBar> {
        let (Some((_, bars)), Some(strokes)) = (&mut self.bars, pulse.strokes) else { return None };
        let phase = (pulse.beat.tempo > 0.0).then_some(pulse.beat.phase);
        Some(bars.follow(phase, strokes, spectrum))
    }
}
