//! Chroma and key of live input, from the notes.
//!
//! The key is the profile that correlates best with the pitch classes of about the last 30 s, as in a whole song
//! ([`crate::song`]). The time that the tonic's triad sounds also counts, because a key and its relative key have the
//! same notes. Another key must be clearly better, so that the key does not flicker.

use crate::scale::NOTE_COUNT;
use crate::song::{PITCH_CLASSES, Tonality, are_varied};

pub(super) const CLASSES: usize = PITCH_CLASSES.len();

/// Time constant of the chroma, in seconds.
const CHROMA_SECONDS: f64 = 0.3;
/// Chroma is relative to the strongest pitch class, or to this sum of levels if it is larger.
const STRONGEST_MIN: f32 = 0.3;
/// The strongest pitch class relative to the mean, in sound without pitches and in music.
const PROMINENT: (f32, f32) = (1.2, 1.7);

/// Time constant of the key, in seconds.
const KEY_SECONDS: f64 = 30.0;
/// A key is reported only if pitches sounded for this fraction of about the last 30 s, and kept above the second value.
const PITCHED: (f32, f32) = (0.3, 0.1);
/// A step has pitches if its levels sum to at least this.
const PITCHED_MIN: f32 = 0.5;
/// The minimum correlation of a reported key, and of a key that is kept.
const FITS: (f32, f32) = (0.6, 0.45);
/// The minimum correlation of a triad.
const TRIAD_FITS: f32 = 0.6;
/// Added to the correlation of a key if its tonic's triad sounds always; otherwise a fraction of it is added.
const TONIC: f32 = 0.5;
/// Another key replaces the key if it is better by this much.
const CHANGES: f32 = 0.15;

/// Sums the levels of the notes of each pitch class, C first.
pub(super) fn classes(notes: &[f32; NOTE_COUNT]) -> [f32; CLASSES] {
    let mut classes = [0.0; CLASSES];
    for (semitone, level) in notes.iter().enumerate() {
        // A is 9 semitones above C.
        classes[(semitone + 9) % CLASSES] += level;
    }
    classes
}

pub(super) struct Harmony {
    learned: f32,
    recent: [f32; CLASSES],
    learned_each_step: f32,
    sums: [f32; CLASSES],
    pitched: f32,
    /// The fraction of time that each triad sounds.
    triads: [f32; 2 * CLASSES],
    key: Option<Tonality>,
}

impl Harmony {
    pub(super) fn new(hop_seconds: f64, step_seconds: f64) -> Self {
        Self {
            learned: (1.0 - (-hop_seconds / CHROMA_SECONDS).exp()) as f32,
            recent: [0.0; CLASSES],
            learned_each_step: (1.0 - (-step_seconds / KEY_SECONDS).exp()) as f32,
            sums: [0.0; CLASSES],
            pitched: 0.0,
            triads: [0.0; 2 * CLASSES],
            key: None,
        }
    }

    /// Returns the chroma after a hop with these pitch classes.
    pub(super) fn chroma(&mut self, classes: &[f32; CLASSES]) -> [f32; CLASSES] {
        for (recent, now) in self.recent.iter_mut().zip(classes) {
            *recent += self.learned * (now - *recent);
        }
        let strongest = self.recent.iter().copied().fold(0.0, f32::max);
        let mean = self.recent.iter().sum::<f32>() / CLASSES as f32;
        let prominent = (strongest / mean.max(1e-6) - PROMINENT.0) / (PROMINENT.1 - PROMINENT.0);
        let scale = prominent.clamp(0.0, 1.0) / strongest.max(STRONGEST_MIN);
        self.recent.map(|level| (level * scale).clamp(0.0, 1.0))
    }

    /// Returns the key after a step with these mean pitch classes.
    pub(super) fn key(&mut self, classes: &[f32; CLASSES]) -> Option<Tonality> {
        let is_pitched = classes.iter().sum::<f32>() >= PITCHED_MIN;
        let learned = self.learned_each_step;
        let follow = |value: &mut f32, target: f32| *value += learned * (target - *value);
        self.sums.iter_mut().zip(classes).for_each(|(sum, now)| follow(sum, *now));
        follow(&mut self.pitched, if is_pitched { 1.0 } else { 0.0 });
        let fit = |triad: &Tonality| triad.fit_as_triad(classes);
        let triad = Tonality::all().enumerate().max_by(|(_, a), (_, b)| fit(a).total_cmp(&fit(b)));
        let triad = triad.filter(|(_, triad)| is_pitched && fit(triad) >= TRIAD_FITS).map(|(index, _)| index);
        for (index, fraction) in self.triads.iter_mut().enumerate() {
            follow(fraction, if triad == Some(index) { 1.0 } else { 0.0 });
        }
        self.key = self.next_key();
        self.key
    }

    fn next_key(&self) -> Option<Tonality> {
        let fits = |key: &Tonality| key.fit_as_key(&self.sums);
        let kept = self.key.filter(|key| self.pitched >= PITCHED.1 && fits(key) >= FITS.1);
        if self.pitched < PITCHED.0 || !are_varied(&self.sums) {
            return kept;
        }
        let scored = Tonality::all().zip(&self.triads).map(|(key, fraction)| {
            let is_kept = if kept == Some(key) { CHANGES } else { 0.0 };
            (key, fits(&key) + TONIC * fraction / self.pitched + is_kept)
        });
        let (best, _) = scored.max_by(|a, b| a.1.total_cmp(&b.1))?;
        if fits(&best) >= FITS.0 { Some(best) } else { kept }
    }
}
