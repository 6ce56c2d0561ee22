//! Notes: the level of each semitone, with the partials of lower notes removed; the chord and the melody.

mod chord;
mod melody;
mod partials;
mod peaks;

use chord::ChordFinder;
use melody::MelodyFinder;
use partials::Partials;
use peaks::{PLACES, Peaks};

use super::features::Features;
use super::scale::NOTE_COUNT;
use super::smoothing::Follower;

/// Attack and release times of the levels, in seconds.
const ATTACK: f64 = 0.010;
const RELEASE: f64 = 0.08;

/// Time constant of the decay of the loudest note, in seconds.
const LOUDEST_SECONDS: f64 = 4.0;

/// Notes below this amplitude (-70 dB) are silent.
const AMPLITUDE_MIN: f32 = 3e-4;

/// A note this far below the loudest recent note has level 0, in decibels.
const RANGE_DB: f32 = 34.0;

pub(super) struct Notes {
    peaks: Peaks,
    partials: Partials,
    loudest: f32,
    kept: f32,
    follower: Follower,
    levels: [f32; NOTE_COUNT],
    chord: ChordFinder,
    melody: MelodyFinder,
}

impl Notes {
    pub(super) fn new(hop: usize, rate: f64, hop_seconds: f64) -> Self {
        Self {
            peaks: Peaks::new(hop, rate),
            partials: Partials::new(),
            loudest: 0.0,
            kept: (-hop_seconds / LOUDEST_SECONDS).exp() as f32,
            follower: Follower::new(ATTACK, RELEASE, hop_seconds),
            levels: [0.0; NOTE_COUNT],
            chord: ChordFinder::new(hop_seconds),
            melody: MelodyFinder::new(hop_seconds),
        }
    }

    /// Measures the notes, the chord and the melody of a moment from the power spectra of the long and the middle
    /// window.
    pub(super) fn follow(&mut self, long: &[f32], middle: &[f32], features: &mut Features) {
        let found: [f32; PLACES] = self.peaks.amplitudes(long, middle);
        let amplitudes = self.partials.explained(&found);
        let loudest = amplitudes.iter().fold(0.0_f32, |loudest, amplitude| loudest.max(*amplitude));
        self.loudest = loudest.max(self.loudest * self.kept).max(AMPLITUDE_MIN.sqrt());
        let mut targets = [0.0; NOTE_COUNT];
        for ((target, level), amplitude) in targets.iter_mut().zip(&mut self.levels).zip(&amplitudes) {
            // The amplitudes are square roots.
            let below_db = 40.0 * (amplitude / self.loudest).max(1e-6).log10();
            *target = (1.0 + below_db / RANGE_DB).clamp(0.0, 1.0);
            self.follower.follow(level, *target);
        }
        features.notes = self.levels;
        (features.chord_root, features.chord_minor, features.chord_certainty) =
            self.chord.follow(&self.levels);
        (features.melody, features.melody_certainty) =
            self.melody.follow(&targets, |semitone| self.peaks.fine(semitone));
    }
}
