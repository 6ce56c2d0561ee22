//! How much the last seconds of live input differ from the seconds before, in timbre and harmony: a causal form of the
//! novelty of Foote (2000), which compares both sides of a moment.

use std::collections::VecDeque;

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
    /// The newest step is last.
    steps: VecDeque<Step>,
    loudest: f32,
}

impl Novelty {
    pub(super) fn new() -> Self {
        Self { steps: VecDeque::with_capacity(RECENT + BEFORE), loudest: f32::MIN }
    }

    pub(super) fn restart(&mut self) {
        self.steps.clear();
        self.loudest = f32::MIN;
    }

    /// Returns the novelty after a step with these mean powers and pitch classes.
    pub(super) fn follow(&mut self, powers: &[f32; BAND_COUNT], classes: &[f32; CLASSES]) -> f32 {
        let (pairs, _) = powers.as_chunks::<2>();
        let mut levels = [0.0; LEVELS];
        levels.iter_mut().zip(pairs).for_each(|(level, [a, b])| *level = decibels(a + b));
        self.loudest = levels.iter().copied().fold(self.loudest - FORGOTTEN_DB, f32::max);
        let levels = levels.map(|level| level.max(self.loudest - RANGE_DB));
        let length = classes.iter().map(|x| x * x).sum::<f32>().sqrt().max(LENGTH_MIN);
        if self.steps.len() == RECENT + BEFORE {
            self.steps.pop_front();
        }
        self.steps.push_back(Step { levels, classes: classes.map(|x| x / length) });
        match self.steps.len().checked_sub(RECENT) {
            Some(border) if border >= BEFORE_MIN => self.difference(border),
            _ => 0.0,
        }
    }

    /// Returns the difference between the steps before `border` and the steps from it on.
    fn difference(&self, border: usize) -> f32 {
        let (before, recent) = (self.steps.range(..border), self.steps.range(border..));
        let mean = |steps: &mut dyn Iterator<Item = f32>, count: usize| steps.sum::<f32>() / count as f32;
        let mut levels = 0.0;
        for level in 0..LEVELS {
            let was = mean(&mut before.clone().map(|step| step.levels[level]), border);
            let is = mean(&mut recent.clone().map(|step| step.levels[level]), RECENT);
            let variance = mean(&mut before.clone().map(|step| (step.levels[level] - was).powi(2)), border);
            let difference = (is - was).abs().min(DIFFERENCE_MAX);
            levels += difference * difference / (DEVIATION_MIN * DEVIATION_MIN + variance);
        }
        let mut classes = 0.0;
        for class in 0..CLASSES {
            let was = mean(&mut before.clone().map(|step| step.classes[class]), border);
            let is = mean(&mut recent.clone().map(|step| step.classes[class]), RECENT);
            classes += (is - was).powi(2);
        }
        (levels / LEVELS as f32).sqrt() + HARMONY * classes.sqrt()
    }
}
