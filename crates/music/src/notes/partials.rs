//! Explains the tones of a moment by notes whose partials decay geometrically (Mauch and Dixon 2010): non-negative
//! least squares by coordinate descent, which starts from the notes of the previous moment.

use super::peaks::PLACES;
use crate::scale::NOTE_COUNT;

/// The number of partials of a note.
const PARTIALS: usize = 12;

/// The square root of the amplitude of each partial relative to the previous partial.
const DECAY: f32 = 0.6;

/// The passes of the descent per moment.
const PASSES: usize = 2;

/// The cost of a note, relative to the strongest tone, so that few notes explain many tones.
const SPARSITY: f32 = 0.15;

pub(super) struct Partials {
    /// The distance of each partial from its note in semitones, and its weight.
    profile: [(usize, f32); PARTIALS],
    amplitudes: [f32; NOTE_COUNT],
}

impl Partials {
    pub(super) fn new() -> Self {
        let partial = |k: usize| {
            let distance = (12.0 * ((k + 1) as f64).log2()).round() as usize;
            (distance, DECAY.powi(k as i32))
        };
        Self { profile: std::array::from_fn(partial), amplitudes: [0.0; NOTE_COUNT] }
    }

    /// Returns the square root of each note's amplitude.
    pub(super) fn explained(&mut self, tones: &[f32; PLACES]) -> [f32; NOTE_COUNT] {
        let strongest = tones.iter().fold(0.0_f32, |strongest, tone| strongest.max(*tone));
        let mut rest = *tones;
        for (note, amplitude) in self.amplitudes.iter_mut().enumerate() {
            // A note without its fundamental is none.
            if tones[note] == 0.0 {
                *amplitude = 0.0;
            } else if *amplitude > 0.0 {
                for (distance, weight) in self.profile {
                    if let Some(rest) = rest.get_mut(note + distance) {
                        *rest -= *amplitude * weight;
                    }
                }
            }
        }
        for _ in 0..PASSES {
            for (note, amplitude) in self.amplitudes.iter_mut().enumerate() {
                if tones[note] == 0.0 {
                    continue;
                }
                let (mut fit, mut norm) = (-SPARSITY * strongest, 0.0);
                for (distance, weight) in self.profile {
                    if let Some(rest) = rest.get(note + distance) {
                        fit += rest * weight;
                        norm += weight * weight;
                    }
                }
                let now = (*amplitude + fit / norm).max(0.0);
                let change = now - std::mem::replace(amplitude, now);
                if change != 0.0 {
                    for (distance, weight) in self.profile {
                        if let Some(rest) = rest.get_mut(note + distance) {
                            *rest -= change * weight;
                        }
                    }
                }
            }
        }
        self.amplitudes
    }
}
