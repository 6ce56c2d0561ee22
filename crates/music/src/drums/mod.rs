//! Onsets of kicks, snares and hats: the rises and levels of frequency bands, weighed by a linear classifier for each
//! drum.
//!
//! Each band is whitened, and its rise is relative to its mean rise. A logistic regression per drum weighs these
//! numbers of three moments. Its weights are computed from generated drum tracks (`tuning_tests.rs`). Tried, with two
//! kits left out: rises without levels (snares have F 0.81 instead of 0.99), and a hidden layer of 12 units (kicks 0.84
//! instead of 0.83, snares 0.98 instead of 0.99, hats 0.93 instead of 0.90, for five times as many weights).

mod rises;
#[cfg(test)]
mod tuning_tests;
mod weights;

use rises::{BANDS, BandRises, LOW};
use weights::WEIGHTS;

use super::smoothing::Follower;

/// Kick, snare and hat.
pub(super) const DRUMS: usize = 3;

/// The rises of this many moments are weighed together.
const MOMENTS: usize = 3;

/// The number of numbers that a classifier weighs: the rises, the newest moment first, the heights now and before, and
/// a 1.
const NUMBERS: usize = (MOMENTS + 2) * BANDS + 1;

/// A stroke is detected at this certainty of each drum, 0..1.
const CERTAIN: [f32; DRUMS] = [0.4, 0.6, 0.3];
/// At a stroke, the rise of one of the drum's bands is at least this, as a square root.
const SUDDEN_LEAST: [f32; DRUMS] = [1.7, 1.5, 1.5];
/// The next stroke needs a certainty below this fraction of [`CERTAIN`] first.
const ARMED: f32 = 0.5;

/// The minimum time between two strokes of a drum, in seconds.
const APART_SECONDS: f64 = 0.06;

/// Release time of the envelopes, in seconds: the same as of the feature `beat`.
const RELEASE: f64 = 0.15;

/// The strength of a stroke is taken from this many moments.
const STRENGTH_MOMENTS: u32 = 3;
/// The strength of the softest stroke.
const STRENGTH_MIN: f32 = 0.2;
/// Time constant of the decay of the strongest stroke, in seconds.
const STRONGEST_SECONDS: f64 = 6.0;

/// The bands from which the strength of each drum is measured.
const OF_DRUM: [std::ops::Range<usize>; DRUMS] = [0..3, 3..11, 11..13];

#[derive(Clone, Copy, Debug, Default)]
struct Stroke {
    /// Hops since the last stroke.
    since: u32,
    armed: bool,
    strongest: f32,
    value: f32,
}

/// Detects strokes of the drums.
pub(super) struct Drums {
    rises: BandRises,
    /// With centred windows, the low bands are one hop late, so that both windows end at the same frame.
    centred: bool,
    low: [f32; LOW],
    evidence: [f32; NUMBERS],
    strokes: [Stroke; DRUMS],
    apart: u32,
    kept: f32,
    release: Follower,
}

impl Drums {
    /// Creates a detector for a short window with `bins` bins of `bin_hz` hertz, and a middle window of twice its
    /// length.
    pub(super) fn new(bins: usize, bin_hz: f64, hop_seconds: f64, centred: bool) -> Self {
        let mut evidence = [0.0; NUMBERS];
        evidence[NUMBERS - 1] = 1.0;
        let apart = (APART_SECONDS / hop_seconds).round() as u32;
        Self {
            rises: BandRises::new(bins, bin_hz, hop_seconds),
            centred,
            low: [0.0; LOW],
            evidence,
            strokes: [Stroke { since: apart, armed: true, ..Stroke::default() }; DRUMS],
            apart,
            kept: (-hop_seconds / STRONGEST_SECONDS).exp() as f32,
            release: Follower::new(RELEASE, RELEASE, hop_seconds),
        }
    }

    /// Returns the envelope of each drum: the strength at a stroke, 0..1, then falling.
    pub(super) fn follow(&mut self, middle: &[f32], short: &[f32]) -> [f32; DRUMS] {
        let mut powers = self.rises.powers(middle, short);
        if self.centred {
            powers[..LOW].swap_with_slice(&mut self.low);
        }
        let measured = self.rises.follow(powers);
        self.evidence.copy_within(..(MOMENTS - 1) * BANDS, BANDS);
        let (parts, _) = self.evidence.as_chunks_mut::<BANDS>();
        for (part, values) in
            [0, MOMENTS, MOMENTS + 1].into_iter().zip([measured.sudden, measured.height, measured.before])
        {
            parts[part] = values;
        }
        let (apart, kept) = (self.apart, self.kept);
        for (drum, stroke) in self.strokes.iter_mut().enumerate() {
            let (certainty, certain) = (certainty(&self.evidence, drum, &WEIGHTS[drum]), CERTAIN[drum]);
            let amplitude = powers[OF_DRUM[drum].clone()].iter().sum::<f32>().sqrt();
            stroke.since = stroke.since.saturating_add(1);
            stroke.strongest *= kept;
            self.release.follow(&mut stroke.value, 0.0);
            stroke.armed |= certainty < ARMED * certain;
            if certainty >= certain && stroke.armed && stroke.since >= apart {
                (stroke.since, stroke.armed) = (0, false);
            }
            if stroke.since < STRENGTH_MOMENTS {
                stroke.strongest = stroke.strongest.max(amplitude).max(f32::MIN_POSITIVE);
                stroke.value = stroke.value.max((amplitude / stroke.strongest).max(STRENGTH_MIN));
            }
        }
        self.strokes.map(|stroke| stroke.value)
    }
}

/// Returns the certainty of a stroke, 0..1: the logistic function of the weighted sum. It is 0 unless one of the drum's
/// own bands has risen suddenly, as no band of steady noise does.
fn certainty(evidence: &[f32; NUMBERS], drum: usize, weights: &[f32; NUMBERS]) -> f32 {
    let rises = evidence.chunks(BANDS).take(MOMENTS).filter_map(|part| part.get(OF_DRUM[drum].clone()));
    if rises.flatten().all(|rise| *rise < SUDDEN_LEAST[drum]) {
        return 0.0;
    }
    let sum: f32 = evidence.iter().zip(weights).map(|(number, weight)| number * weight).sum();
    1.0 / (1.0 + (-sum).exp())
}
