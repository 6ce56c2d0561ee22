//! Onsets, beats and bars, heard in the short window.

use super::beat::{Beat, BeatTracker};
use super::live_bars::{LiveBar, LiveBars, Strokes};
use super::onset::{Flux, Onsets};
use super::rises::Rises;
use super::scale::SPECTRUM_POINTS;

/// Onset and beat of one moment.
pub(super) struct RhythmMoment {
    /// Whether a sound begins.
    pub(super) begins: bool,
    pub(super) beat: Beat,
    strokes: Option<Strokes>,
}

/// Follows the rhythm from moment to moment.
pub(super) struct Rhythm {
    flux: Flux,
    onsets: Onsets,
    beats: BeatTracker,
    /// Of live input alone; of a song all is known.
    bars: Option<(Rises, LiveBars)>,
}

impl Rhythm {
    /// For spectra of `bins` bins of `bin_hz` hertz each. The beat tracker puts an onset `late` moments after it.
    pub(super) fn new(bins: usize, bin_hz: f64, hop_seconds: f64, late: f32, with_bars: bool) -> Self {
        Self {
            flux: Flux::new(bins, bin_hz, hop_seconds),
            onsets: Onsets::new(hop_seconds),
            beats: BeatTracker::new(hop_seconds, late),
            bars: with_bars.then(|| (Rises::new(bins, bin_hz, hop_seconds), LiveBars::new())),
        }
    }

    /// Forgets everything.
    pub(super) fn restart(&mut self) {
        self.flux.restart();
        self.onsets.restart();
        self.beats.restart();
        if let Some((rises, bars)) = &mut self.bars {
            rises.restart();
            bars.restart();
        }
    }

    /// Takes the power per bin of the next moment.
    pub(super) fn follow(&mut self, power: &[f32]) -> RhythmMoment {
        let (begins, flux) = self.onsets.follow(self.flux.follow(power));
        let strokes = self.bars.as_mut().map(|(rises, _)| Strokes::of(rises.follow(power), flux));
        RhythmMoment { begins, beat: self.beats.follow(flux, begins), strokes }
    }

    /// The place in the bar, for live input. Takes the curve of the spectrum of the same moment.
    pub(super) fn bar(&mut self, pulse: RhythmMoment, spectrum: &[f32; SPECTRUM_POINTS]) -> Option<LiveBar> {
        let (Some((_, bars)), Some(strokes)) = (&mut self.bars, pulse.strokes) else { return None };
        let phase = (pulse.beat.tempo > 0.0).then_some(pulse.beat.phase);
        Some(bars.follow(phase, strokes, spectrum))
    }
}
