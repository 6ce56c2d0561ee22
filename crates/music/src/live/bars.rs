//! Bar tracking in live input: the number of the current beat in its bar, or 0 while the number is uncertain.
//!
//! Each completed beat gives the same evidence as in the bars of a whole song ([`crate::song`]): low and high onsets,
//! and the change of pitches and timbre (Goto 2001). A hidden Markov model over the positions in bars of four and three
//! beats accumulates the evidence. In 6/8, two dotted beats are reported as half of a bar of four. Bar tracking adds 2
//! µs to the 29 µs per moment.

use crate::scale::{SPECTRUM_POINTS, spectrum_place};
use crate::song::{largest, reward};

const METERS: [usize; 2] = [4, 3];
/// The beats of the bar and the position in the bar, for each state.
const STATES: [(usize, usize); 7] = [(4, 0), (4, 1), (4, 2), (4, 3), (3, 0), (3, 1), (3, 2)];

/// An onset belongs to a beat if it is after the first phase in the previous beat, or before the second in the beat.
const STRUCK: (f32, f32) = (0.85, 0.3);

/// The time constant of the statistics, in beats.
const USUAL_BEATS: f32 = 24.0;
const FIRST_BEATS: u32 = 5;

/// One standard deviation of evidence adds this much to the natural logarithm of a position's likelihood.
const EVIDENCE: f32 = 0.45;
/// The probability that a bar ends early and the meter may change.
const BREAK: f32 = 0.004;
/// The power to which the belief is raised at each beat, so that old evidence is forgotten.
const REMEMBERED: f32 = 0.985;
/// A position is reported once its belief reaches the first value, until the belief falls below the second value.
const REPORTED: (f32, f32) = (0.9, 0.6);

/// The range in which pitches are compared, in hertz. Frequencies above the range show the timbre.
const PITCHES_HZ: (f64, f64) = (60.0, 1_600.0);

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct LiveBar {
    /// The number of the beat in its bar, from 1; 0 while uncertain.
    pub(crate) beat: f32,
    pub(crate) beats: f32,
}

/// The rises of the low and of the high frequencies, and the flux, relative to the largest recent flux.
pub(super) type Strokes = [f32; 3];

fn raise(most: &mut Strokes, strokes: Strokes) {
    most.iter_mut().zip(strokes).for_each(|(most, stroke)| *most = most.max(stroke));
}

/// Running mean and mean square of a quantity that is measured once per beat, to standardise the quantity.
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

pub(super) struct LiveBars {
    pitches: std::ops::Range<usize>,
    phase: f32,
    now: Strokes,
    next: Strokes,
    sum: [f32; SPECTRUM_POINTS],
    count: f32,
    before: [f32; SPECTRUM_POINTS],
    /// Statistics of five quantities: the low, high and total onset strength, the harmony and the timbre.
    usual: [Usual; 5],
    beats: u32,
    /// The belief in each of [`STATES`].
    belief: [f32; STATES.len()],
    reported: LiveBar,
}

impl LiveBars {
    pub(super) fn new() -> Self {
        let place = |hz: f64| (spectrum_place(hz) * SPECTRUM_POINTS as f64) as usize;
        Self {
            pitches: place(PITCHES_HZ.0).min(SPECTRUM_POINTS)..place(PITCHES_HZ.1).min(SPECTRUM_POINTS),
            phase: 0.0,
            now: [0.0; 3],
            next: [0.0; 3],
            sum: [0.0; SPECTRUM_POINTS],
            count: 0.0,
            before: [0.0; SPECTRUM_POINTS],
            usual: [Usual::default(); 5],
            beats: 0,
            belief: [1.0 / STATES.len() as f32; STATES.len()],
            reported: LiveBar::default(),
        }
    }

    /// Processes a moment: the beat's phase, 0..1 (`None` without a tempo), the onset strengths, and the spectrum.
    pub(super) fn follow(
        &mut self,
        phase: Option<f32>,
        strokes: Strokes,
        spectrum: &[f32; SPECTRUM_POINTS],
    ) -> LiveBar {
        let Some(phase) = phase else {
            if self.beats > 0 {
                *self = Self::new();
            }
            return LiveBar::default();
        };
        let wraps = phase < self.phase - 0.5;
        self.phase = phase;
        if wraps {
            self.end_beat();
        }
        if phase < STRUCK.1 {
            raise(&mut self.now, strokes);
        } else if phase >= STRUCK.0 {
            raise(&mut self.next, strokes);
        }
        self.sum.iter_mut().zip(spectrum).for_each(|(sum, height)| *sum += height);
        self.count += 1.0;
        self.reported
    }

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
        let [low, high, flux] = self.now;
        let values = [(low, 0.1), (high, 0.1), (flux, 0.1), (harmony, 0.1), (sound, 0.3)];
        let mut evidence = [0.0; 5];
        for ((evidence, usual), (value, least)) in evidence.iter_mut().zip(&mut self.usual).zip(values) {
            *evidence = usual.standardised(value, least, learned);
        }
        (self.before, self.sum, self.count) = (mean, [0.0; SPECTRUM_POINTS], 0.0);
        (self.now, self.next) = (self.next, [0.0; 3]);
        if self.beats >= FIRST_BEATS {
            self.weigh(evidence);
        }
        self.move_on();
        self.publish();
    }

    fn weigh(&mut self, evidence: [f32; 5]) {
        for (belief, (beats, position)) in self.belief.iter_mut().zip(STATES) {
            let likelihood = (EVIDENCE * reward(beats, position, evidence)).exp();
            *belief = belief.max(1e-9).powf(REMEMBERED) * likelihood;
        }
        let sum: f32 = self.belief.iter().sum();
        self.belief.iter_mut().for_each(|belief| *belief /= sum.max(f32::MIN_POSITIVE));
    }

    /// Advances every position by a beat. With a small probability, the bar ends early and a bar of any meter starts.
    fn move_on(&mut self) {
        let (four, three) = self.belief.split_at_mut(METERS[0]);
        for bar in [four, three] {
            bar.rotate_right(1);
            bar.iter_mut().for_each(|belief| *belief *= 1.0 - BREAK);
            bar[0] += BREAK / METERS.len() as f32;
        }
    }

    fn publish(&mut self) {
        let best = largest(&self.belief);
        let (beats, position) = STATES[best];
        let enough = if self.reported.beats > 0.0 { REPORTED.1 } else { REPORTED.0 };
        let bar = LiveBar { beat: (position + 1) as f32, beats: beats as f32 };
        self.reported = if self.belief[best] >= enough { bar } else { LiveBar::default() };
    }
}
