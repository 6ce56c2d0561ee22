//! Onsets and beats, from the short window, and what is heard of the song in live input.

use super::beat::{Beat, BeatTracker};
use super::features::TimedFeatures;
use super::live::{Hop, Live, Strokes};
use super::onset::{Flux, LowFlux, Onsets};
use super::scale::BAND_COUNT;

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
    /// For live input only. Bars, keys and drops of songs come from [`crate::song`].
    live: Option<Live>,
}

impl Rhythm {
    /// Creates a tracker for short spectra of `bins` bins of `bin_hz` hertz, and spectra of twice this length. Onsets
    /// appear `late` hops after they happened.
    pub(super) fn new(bins: usize, bin_hz: f64, hop_seconds: f64, late: f32, is_live: bool) -> Self {
        Self {
            flux: Flux::new(bins, bin_hz, hop_seconds),
            low: LowFlux::new(2 * bins, 0.5 * bin_hz, hop_seconds),
            onsets: Onsets::new(hop_seconds),
            beats: BeatTracker::new(hop_seconds, late),
            live: is_live.then(|| Live::new(bins, bin_hz, hop_seconds)),
        }
    }

    pub(super) fn restart(&mut self) {
        self.flux.restart();
        self.low.restart();
        self.onsets.restart();
        self.beats.restart();
        if let Some(live) = &mut self.live {
            live.restart();
        }
    }

    pub(super) fn follow(&mut self, middle: &[f32], short: &[f32]) -> RhythmMoment {
        let rise = self.flux.follow(short);
        let (begins, flux) = self.onsets.follow(rise, self.low.follow(middle, &self.flux));
        let strokes = self.live.as_mut().map(|live| live.strokes(short, flux));
        RhythmMoment { begins, beat: self.beats.follow(flux, begins), strokes }
    }

    /// Completes the features of a moment of live input.
    pub(super) fn process(
        &mut self,
        RhythmMoment { begins, beat, strokes }: RhythmMoment,
        powers: &[f32; BAND_COUNT],
        moment: &mut TimedFeatures,
    ) {
        let (Some(live), Some(strokes)) = (&mut self.live, strokes) else { return };
        let TimedFeatures { features, spectrum, .. } = moment;
        let notes = &features.notes;
        let (bar, song) = live.follow(&Hop { powers, notes, spectrum, begins, beat, strokes });
        (features.bar_beat, features.bar_beats, features.live) = (bar.beat, bar.beats, song);
    }
}
