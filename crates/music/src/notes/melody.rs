//! The melody: the most prominent note above the bass.

use crate::scale::NOTE_COUNT;

/// The melody is at or above this semitone (E3).
const LOWEST: usize = 31;

/// Higher notes are more prominent: the bonus for an octave.
const OCTAVE_BONUS: f32 = 0.12;
/// The bonus ends at this semitone (E6).
const BONUS_END: usize = 67;

/// Another note replaces the note if it is more prominent by this much.
const CHANGES: f32 = 0.08;

/// Notes below this level are no melody.
const LEVEL_MIN: f32 = 0.35;

/// A note that is this much more prominent than the next has certainty 1.
const CLEAR: f32 = 0.3;

/// Time constant of the certainty, in seconds.
const CERTAIN_SECONDS: f64 = 0.05;

pub(super) struct MelodyFinder {
    note: Option<usize>,
    certainty: f32,
    learned: f32,
}

impl MelodyFinder {
    pub(super) fn new(hop_seconds: f64) -> Self {
        Self { note: None, certainty: 0.0, learned: (1.0 - (-hop_seconds / CERTAIN_SECONDS).exp()) as f32 }
    }

    /// Returns the melody in semitones above A0 and its certainty, 0..1. `fine` returns the deviation of a semitone.
    pub(super) fn follow(&mut self, levels: &[f32; NOTE_COUNT], fine: impl Fn(usize) -> f32) -> (f32, f32) {
        let prominence = |note: usize| {
            let octaves = (note.min(BONUS_END) - LOWEST) as f32 / 12.0;
            let kept = if self.note == Some(note) { CHANGES } else { 0.0 };
            levels.get(note).map_or(0.0, |level| {
                if *level < LEVEL_MIN { 0.0 } else { level + OCTAVE_BONUS * octaves + kept }
            })
        };
        let (mut best, mut second) = ((LOWEST, 0.0), 0.0);
        for note in LOWEST..NOTE_COUNT {
            let now = prominence(note);
            if now > best.1 {
                (best, second) = ((note, now), best.1);
            } else if now > second {
                second = now;
            }
        }
        let clear = ((best.1 - second) / CLEAR).clamp(0.0, 1.0);
        self.note = (best.1 > 0.0).then_some(best.0);
        let target = if self.note.is_some() { clear } else { 0.0 };
        self.certainty += self.learned * (target - self.certainty);
        if self.certainty < 1e-6 {
            self.certainty = 0.0;
        }
        self.note.map_or((0.0, self.certainty), |note| ((note as f32 + fine(note)).max(0.0), self.certainty))
    }
}
