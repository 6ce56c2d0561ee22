//! Onsets, beats, and the form of live input.

use super::activation::{self, Activation, STEP_HOPS};
use super::beat::BeatTracker;
use super::features::TimedFeatures;
use super::live::{Hop, Live};
use super::onset::{Onset, Onsets};
use super::resolution::Resolution;
use super::scale::BAND_COUNT;

pub(super) struct Rhythm {
    onsets: Onsets,
    activation: Activation,
    /// The newest log odds of a beat.
    odds: f32,
    beats: BeatTracker,
    /// For live input only. Bars, keys and drops of songs come from [`crate::song`].
    live: Option<Live>,
}

impl Rhythm {
    /// Creates a tracker for hops of `hop` frames at `rate` hertz, and short and middle spectra whose windows have their
    /// middle `late` hops before the moment.
    pub(super) fn new(hop: usize, rate: f64, late: f32, is_live: bool) -> Self {
        let hop_seconds = hop as f64 / rate;
        let short = hop * Resolution::Short.hops();
        let (bins, bin_hz) = (short / 2, rate / short as f64);
        let activation = Activation::new(activation::LIVE, hop, rate);
        let later = STEP_HOPS * activation.late();
        // Measured with clicks. The start of a beat lasts two hops, and so do odds.
        let late = late + later as f32 - 0.5;
        Self {
            onsets: Onsets::new(bins, bin_hz, hop_seconds),
            activation,
            odds: 0.0,
            beats: BeatTracker::new(hop_seconds, late, later),
            live: is_live.then(|| Live::new(bins, bin_hz, hop_seconds)),
        }
    }

    pub(super) fn restart(&mut self) {
        self.onsets.restart();
        self.activation.restart();
        self.odds = 0.0;
        self.beats.restart();
        if let Some(live) = &mut self.live {
            live.restart();
        }
    }

    /// Processes a moment whose number, notes and curve are known. Writes its beat and, for live input, its place in
    /// the form. Returns true at an onset.
    pub(super) fn follow(
        &mut self,
        [middle, short]: [&[f32]; 2],
        powers: &[f32; BAND_COUNT],
        moment: &mut TimedFeatures,
    ) -> bool {
        let Onset { begins, relative_flux: flux, .. } = self.onsets.follow(short, Some(middle));
        if moment.number.is_multiple_of(STEP_HOPS as u64) {
            self.odds = self.activation.follow(middle);
        }
        let beat = self.beats.follow(self.odds, flux, begins);
        let TimedFeatures { features, spectrum, .. } = moment;
        (features.tempo, features.phase) = (beat.tempo, beat.phase);
        if let Some(live) = &mut self.live {
            let notes = &features.notes;
            let (bar, song) = live.follow(&Hop { powers, notes, spectrum, short, flux, begins, beat });
            (features.bar_beat, features.bar_beats, features.live) = (bar.beat, bar.beats, song);
        }
        begins
    }
}
