//! Bars of sound whose end is not known: which beat of its bar is heard now, as far as what was heard makes it sure.
//!
//! What the song's bars are decoded from ([`crate::song`]) is known of a beat when it is over: how strongly what is low and
//! what is high was struck, and how far pitches and sound differ from those of the beat before (Goto 2001). A hidden
//! Markov model whose states are the positions in bars of four and of three beats takes that up beat by beat. Nothing is
//! told while no position is much likelier than the others.

use super::rises::LowAndHigh;
use super::scale::{SPECTRUM_POINTS, spectrum_place};

/// Lengths of bars, in beats.
const METERS: [usize; 2] = [4, 3];
/// Positions in all of them.
const STATES: usize = 7;

/// A beat is struck from this share of the beat before it to this share of itself.
const STRUCK: (f32, f32) = (0.85, 0.3);

/// Time in beats over which it is learned what is usual.
const USUAL_BEATS: f32 = 24.0;
/// After so many beats it is known a little what is usual, and evidence counts.
const FIRST_BEATS: u32 = 5;

/// How much evidence counts, in natural logarithms for each standard deviation.
const EVIDENCE: f32 = 0.45;
/// How likely it is that a bar ends early, and that the meter changes with a bar.
const BREAK: f32 = 0.004;
/// Belief is taken to this power at each beat, so that what was heard long ago is forgotten.
const REMEMBERED: f32 = 0.985;
/// From the first of these beliefs on a position is told, below the second no longer.
const REPORTED: (f32, f32) = (0.9, 0.6);

/// Pitches are compared between these frequencies, in hertz; above them it is the sound.
const PITCHES_HZ: (f64, f64) = (60.0, 1_600.0);

/// What is reported of the bar.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct LiveBar {
    /// Which beat of its bar, from 1 on; 0 while unsure.
    pub(super) beat: f32,
    /// Beats of the bar; 0 while unsure.
    pub(super) beats: f32,
}

/// What is heard in a moment.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Strokes {
    /// Rise of what is low.
    pub(super) low: f32,
    /// Rise of what is high.
    pub(super) high: f32,
    /// The flux, relative to the largest of late.
    pub(super) flux: f32,
}

impl Strokes {
    pub(super) fn of(rises: LowAndHigh, flux: f32) -> Self {
        Self { low: rises.low_rise, high: rises.high_rise, flux }
    }

    fn add(&mut self, other: Self) {
        self.low = self.low.max(other.low);
        self.high = self.high.max(other.high);
        self.flux = self.flux.max(other.flux);
    }
}

/// A number of each beat, told in deviations from what is usual.
#[derive(Clone, Copy, Debug, Default)]
struct Usual {
    mean: f32,
    square: f32,
}

impl Usual {
    fn standardised(&mut self, value: f32, least: f32, learned: f32) -> f32 {
        self.mean += learned * (value - self.mean);
        self.square += learned * (value * value - self.square);
        let deviation = (self.square - self.mean * self.mean).max(0.0).sqrt();
        ((value - self.mean) / deviation.max(least)).clamp(-2.0, 3.0)
    }
}

/// Follows the bar.
pub(super) struct LiveBars {
    /// Points of the spectrum that have pitches.
    pitches: std::ops::Range<usize>,
    phase: f32,
    /// Strokes of the beat that is heard, and of the next one.
    now: Strokes,
    next: Strokes,
    /// The sum of the spectra of this beat, how many they are, and the mean of the beat before.
    sum: [f32; SPECTRUM_POINTS],
    count: f32,
    before: [f32; SPECTRUM_POINTS],
    /// Low, high, struck, harmony, sound.
    usual: [Usual; 5],
    beats: u32,
    /// How likely each position is for the beat that is heard: those of the first meter, then of the next.
    belief: [f32; STATES],
    reported: LiveBar,
}

impl LiveBars {
    pub(super) fn new() -> Self {
        let place = |hz: f64| (spectrum_place(hz) * SPECTRUM_POINTS as f64) as usize;
        Self {
            pitches: place(PITCHES_HZ.0).min(SPECTRUM_POINTS)..place(PITCHES_HZ.1).min(SPECTRUM_POINTS),
            phase: 0.0,
            now: Strokes::default(),
            next: Strokes::default(),
            sum: [0.0; SPECTRUM_POINTS],
            count: 0.0,
            before: [0.0; SPECTRUM_POINTS],
            usual: [Usual::default(); 5],
            beats: 0,
            belief: [1.0 / STATES as f32; STATES],
            reported: LiveBar::default(),
        }
    }

    /// Forgets everything.
    pub(super) fn restart(&mut self) {
        *self = Self::new();
    }

    /// Takes a moment: the beat's phase, 0..1, if there is a tempo, the strokes, and the spectrum.
    pub(super) fn follow(
        &mut self,
        phase: Option<f32>,
        strokes: Strokes,
        spectrum: &[f32; SPECTRUM_POINTS],
    ) -> LiveBar {
        let Some(phase) = phase else {
            if self.beats > 0 {
                self.restart();
            }
            return LiveBar::default();
        };
        let wraps = phase < self.phase - 0.5;
        self.phase = phase;
        if wraps {
            self.end_beat();
        }
        if phase < STRUCK.1 {
            self.now.add(strokes);
        } else if phase >= STRUCK.0 {
            self.next.add(strokes);
        }
        self.sum.iter_mut().zip(spectrum).for_each(|(sum, height)| *sum += height);
        self.count += 1.0;
        self.reported
    }

    /// What was heard of the beat that is over makes its position likelier or less; the next one has begun.
    fn end_beat(&mut self) {
        let scale = 1.0 / self.count.max(1.0);
        let mean = self.sum.map(|sum| sum * scale);
        let changes = |range: std::ops::Range<usize>, of: fn(f32) -> f32| {
            let (now, before) = (mean.get(range.clone()), self.before.get(range));
            let pairs = now.unwrap_or_default().iter().zip(before.unwrap_or_default());
            pairs.map(|(now, before)| of(now - before)).sum::<f32>()
        };
        let harmony = changes(self.pitches.clone(), |change| change * change).sqrt();
        let sound = changes(self.pitches.end..SPECTRUM_POINTS, |change| change.max(0.0));
        self.beats = self.beats.saturating_add(1);
        let learned = (1.0 / self.beats as f32).max(1.0 / USUAL_BEATS);
        let values = [self.now.low, self.now.high, self.now.flux, harmony, sound];
        let leasts = [0.1, 0.1, 0.1, 0.1, 0.3];
        let mut evidence = [0.0; 5];
        for (((evidence, usual), value), least) in
            evidence.iter_mut().zip(&mut self.usual).zip(values).zip(leasts)
        {
            *evidence = usual.standardised(value, least, learned);
        }
        (self.before, self.sum, self.count) = (mean, [0.0; SPECTRUM_POINTS], 0.0);
        (self.now, self.next) = (self.next, Strokes::default());
        if self.beats >= FIRST_BEATS {
            self.weigh(evidence);
        }
        self.move_on();
        self.tell();
    }

    /// Weighs positions as the song's bars are weighed, of which all is known (`song::bars`).
    fn weigh(&mut self, [low, high, struck, harmony, sound]: [f32; 5]) {
        let start = 0.7 * low + harmony + 0.7 * sound;
        let snare = 0.5 * (high + struck) - low;
        let mut states = self.belief.iter_mut();
        for meter in METERS {
            for (position, belief) in states.by_ref().take(meter).enumerate() {
                let reward = match (meter, position) {
                    (_, 0) => start,
                    (4, 2) => 0.3 * low,
                    (4, _) => 0.5 * snare,
                    _ => 0.3 * snare,
                };
                *belief = belief.max(1e-9).powf(REMEMBERED) * (EVIDENCE * reward).exp();
            }
        }
        let sum: f32 = self.belief.iter().sum();
        self.belief.iter_mut().for_each(|belief| *belief /= sum.max(f32::MIN_POSITIVE));
    }

    /// The next beat has the next position, or begins a bar of any meter.
    fn move_on(&mut self) {
        let mut rest = self.belief.as_mut_slice();
        for meter in METERS {
            let (states, others) = std::mem::take(&mut rest).split_at_mut(meter);
            states.rotate_right(1);
            states.iter_mut().for_each(|belief| *belief *= 1.0 - BREAK);
            if let Some(first) = states.first_mut() {
                *first += BREAK / METERS.len() as f32;
            }
            rest = others;
        }
    }

    fn tell(&mut self) {
        let best = (0..STATES).max_by(|a, b| self.belief[*a].total_cmp(&self.belief[*b])).unwrap_or_default();
        let enough = if self.reported.beats > 0.0 { REPORTED.1 } else { REPORTED.0 };
        let (mut first, mut reported) = (0, LiveBar::default());
        for meter in METERS {
            if (first..first + meter).contains(&best) && self.belief[best] >= enough {
                reported = LiveBar { beat: (best - first + 1) as f32, beats: meter as f32 };
            }
            first += meter;
        }
        self.reported = reported;
    }
}
