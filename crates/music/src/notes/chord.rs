//! The chord of a moment: the triad that fits the levels of the pitch classes best.

use crate::scale::NOTE_COUNT;

/// Time constant of the mean of the pitch classes, in seconds.
const SECONDS: f64 = 0.25;

/// Levels below this are partials or drums.
const LEVEL_MIN: f32 = 0.4;

/// The lowest sounding note below this semitone is probably the root.
const BASS: usize = 24;
const BASS_BONUS: f32 = 0.12;

/// Another chord replaces the chord if it fits better by this much.
const CHANGES: f32 = 0.12;

/// The fit of a chord with certainty 0, and with certainty 1.
const FITS: (f32, f32) = (0.6, 0.95);

pub(super) struct ChordFinder {
    classes: [f32; 12],
    learned: f32,
    chord: usize,
}

impl ChordFinder {
    pub(super) fn new(hop_seconds: f64) -> Self {
        Self { classes: [0.0; 12], learned: (1.0 - (-hop_seconds / SECONDS).exp()) as f32, chord: 0 }
    }

    /// Returns the root in semitones above C, 1 for minor, and the certainty, 0..1. An uncertain chord is kept, so that
    /// it does not flicker.
    pub(super) fn follow(&mut self, levels: &[f32; NOTE_COUNT]) -> (f32, f32, f32) {
        let mut now = [0.0_f32; 12];
        for (semitone, level) in levels.iter().enumerate() {
            // A is 9 semitones above C.
            let class = &mut now[(semitone + 9) % 12];
            *class = class.max(if *level < LEVEL_MIN { 0.0 } else { *level });
        }
        for (mean, now) in self.classes.iter_mut().zip(now) {
            *mean += self.learned * (now - *mean);
        }
        let bass = levels
            .iter()
            .take(BASS)
            .position(|level| *level >= LEVEL_MIN)
            .map(|semitone| (semitone + 9) % 12);
        let length = self.classes.iter().map(|mean| mean * mean).sum::<f32>().sqrt();
        if length < 0.3 {
            return (0.0, 0.0, 0.0);
        }
        let fit = |chord: usize| {
            let (root, third) = (chord % 12, if chord < 12 { 4 } else { 3 });
            let sum: f32 = [0, third, 7].iter().map(|distance| self.classes[(root + distance) % 12]).sum();
            // The cosine of the angle between the levels and the triad.
            sum / (length * 3.0_f32.sqrt()) + if bass == Some(root) { BASS_BONUS } else { 0.0 }
        };
        let best = (0..24).fold(self.chord, |best, chord| {
            let margin = if best == self.chord { CHANGES } else { 0.0 };
            if fit(chord) > fit(best) + margin { chord } else { best }
        });
        self.chord = best;
        let certainty = ((fit(best) - FITS.0) / (FITS.1 - FITS.0)).clamp(0.0, 1.0);
        ((best % 12) as f32, if best < 12 { 0.0 } else { 1.0 }, certainty)
    }
}
