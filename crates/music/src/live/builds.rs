//! Builds in live input: the high frequencies rise steadily for many seconds while the low ones are withdrawn (Solberg
//! 2014 on builds in club music).

use crate::bands::decibels;
use crate::trend::Trend;

/// A rise is searched in the last 16, 24 and 32 steps: 8, 12 and 16 s.
const LENGTHS: [usize; 3] = [16, 24, 32];
/// Quieter high frequencies count as this level, in decibels.
const FLOOR_DB: f32 = -75.0;
/// The minimum correlation of level and time in a build.
const STRAIGHT_MIN: f32 = 0.9;
/// The minimum slope in decibels per step.
const SLOPE_MIN: f32 = 0.35;
/// The maximum rise within two steps, as a fraction of the whole rise. At a larger step, instruments enter.
const STEP_FRACTION: f32 = 0.6;
/// The rises at which a build has the value 0 and 1, in decibels.
const RISE: (f32, f32) = (4.0, 12.0);
/// Low frequencies are withdrawn if they stay this far below their loudest level for this many steps.
const WITHDRAWN_DB: f32 = 8.0;
const WITHDRAWN_STEPS: usize = 6;
/// The decay of the loudest low level, in decibels per step.
const FORGOTTEN_DB: f32 = 0.025;

pub(super) struct Builds {
    /// Levels of the high and low frequencies, the newest first. Unknown high levels are not a number.
    high: [f32; LENGTHS[2]],
    low: [f32; WITHDRAWN_STEPS],
    last_power: f32,
    loudest: f32,
}

impl Builds {
    pub(super) fn new() -> Self {
        Self { high: [f32::NAN; _], low: [f32::MIN; _], last_power: 0.0, loudest: FLOOR_DB }
    }

    /// Returns the progress of a build, 0..1, after a step with these mean powers of high and low frequencies.
    pub(super) fn follow(&mut self, high: f32, low: f32) -> f32 {
        self.high.rotate_right(1);
        // Average over a second, so that a single snare makes no step.
        self.high[0] = decibels(0.5 * (high + self.last_power)).max(FLOOR_DB);
        self.last_power = high;
        let low = decibels(low);
        self.low.rotate_right(1);
        self.low[0] = low;
        self.loudest = (self.loudest - FORGOTTEN_DB).max(low);
        if self.low.iter().any(|low| *low > self.loudest - WITHDRAWN_DB) {
            return 0.0;
        }
        let rises = LENGTHS.into_iter().filter_map(|length| self.rise(length));
        ((rises.fold(0.0, f32::max) - RISE.0) / (RISE.1 - RISE.0)).clamp(0.0, 1.0)
    }

    /// Returns the rise of the last `length` steps in decibels, if it is known and steady.
    fn rise(&self, length: usize) -> Option<f32> {
        let levels = self.high[..length].iter().rev().copied();
        let Trend { slope, straight } = Trend::of(levels.clone());
        let rise = slope * (length as f32 - 1.0);
        let step = levels.clone().skip(2).zip(levels).map(|(to, from)| to - from).fold(0.0, f32::max);
        let is_steady = straight >= STRAIGHT_MIN && step <= STEP_FRACTION * rise;
        (slope >= SLOPE_MIN && is_steady).then_some(rise)
    }
}
