//! How much the last seconds of live input differ from the seconds before, in timbre and harmony: a causal form of the
//! novelty of Foote (2000), which compares both sides of a moment.

use super::harmony::CLASSES;
use crate::bands::decibels;
use crate::scale::BAND_COUNT;

/// Adjacent bands are added in pairs.
const LEVELS: usize = BAND_COUNT / 2;

/// The numbers of steps that are compared: 4 s and the 12 s before.
const RECENT: usize = 8;
const BEFORE: usize = 24;
/// The novelty is 0 until this many steps before the recent ones are known.
const BEFORE_MIN: usize = 12;

/// Levels this far below the loudest count as equal, in decibels.
const RANGE_DB: f32 = 50.0;
/// The decay of the loudest level, in decibels per step: 6 dB in two minutes.
const FORGOTTEN_DB: f32 = 0.025;
/// Larger differences of a level count as this many decibels.
const DIFFERENCE_MAX: f32 = 12.0;
/// Differences are relative to the deviation before, and at least to this many decibels.
const DEVIATION_MIN: f32 = 3.0;
/// The weight of the harmony. The pitch classes of a step are a vector of length 1 at most.
const HARMONY: f32 = 0.3;
/// Shorter vectors of pitch classes are not extended to the length 1.
const LENGTH_MIN: f32 = 0.3;

#[derive(Clone, Copy)]
struct Step {
    levels: [f32; LEVELS],
    classes: [f32; CLASSES],
}

pub(super) struct Novelty {
    /// The newest step is first.
    steps: [Step; RECENT + BEFORE],
    /// The number of known steps.
    known: usize,
    loudest: f32,
}

impl Novelty {
    pub(super) fn new() -> Self {
        let step = Step { levels: [0.0; _], classes: [0.0; _] };
        Self { steps: [step; _], known: 0, loudest: f32::MIN }
    }

    /// Returns the novelty after a step with these mean powers and pitch classes.
    pub(super) fn follow(&mut self, powers: &[f32; BAND_COUNT], classes: &[f32; CLASSES]) -> f32 {
        let (pairs, _) = powers.as_chunks::<2>();
        let mut levels = [0.0; LEVELS];
        levels.iter_mut().zip(pairs).for_each(|(level, [a, b])| *level = decibels(a + b));
        self.loudest = levels.iter().copied().fold(self.loudest - FORGOTTEN_DB, f32::max);
        let levels = levels.map(|level| level.max(self.loudest - RANGE_DB));
        let length = classes.iter().map(|x| x * x).sum::<f32>().sqrt().max(LENGTH_MIN);
        self.steps.rotate_right(1);
        self.steps[0] = Step { levels, classes: classes.map(|x| x / length) };
        self.known = (self.known + 1).min(RECENT + BEFORE);
        if self.known >= RECENT + BEFORE_MIN { self.difference() } else { 0.0 }
    }

    /// Returns the difference between the recent steps and the steps before them.
    fn difference(&self) -> f32 {
        let (recent, before) = self.steps[..self.known].split_at(RECENT);
        let mean = |steps: &[Step], of: &dyn Fn(&Step) -> f32| {
            steps.iter().rev().map(of).sum::<f32>() / steps.len() as f32
        };
        let mut levels = 0.0;
        for level in 0..LEVELS {
            let was = mean(before, &|step| step.levels[level]);
            let is = mean(recent, &|step| step.levels[level]);
            let variance = mean(before, &|step| (step.levels[level] - was).powi(2));
            let difference = (is - was).abs().min(DIFFERENCE_MAX);
            levels += difference * difference / (DEVIATION_MIN * DEVIATION_MIN + variance);
        }
        let mut classes = 0.0;
        for class in 0..CLASSES {
            let was = mean(before, &|step| step.classes[class]);
            let is = mean(recent, &|step| step.classes[class]);
            classes += (is - was).powi(2);
        }
        (levels / LEVELS as f32).sqrt() + HARMONY * classes.sqrt()
    }
}
