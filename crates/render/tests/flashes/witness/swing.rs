//! Finds the changes of one cell's luminance and red between peaks and valleys.

use std::collections::VecDeque;

use mariana_render::flash::rules::{FLARE, RED, ROUNDING, SIMULTANEOUS, SURE, Thresholds};

/// The thresholds of WCAG 2.3.1.
pub(crate) const DEFINED: Thresholds =
    Thresholds { light_change: 0.1, light_darker: 0.8, red_fraction: 0.8, red_change: 0.2 };

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Change {
    Up,
    Down,
}

/// Finds changes of a luminance. A change is reported as soon as it is large enough.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LightSwing {
    last: Option<Change>,
    /// The lowest luminance since the last change. If the last change was a rise, the valley before the rise.
    low: f32,
    /// The highest luminance since the last change. If the last change was a fall, the peak before the fall.
    high: f32,
}

impl LightSwing {
    pub(crate) const NEW: Self = Self { last: None, low: f32::INFINITY, high: f32::NEG_INFINITY };

    pub(crate) fn step(&mut self, light: f32, counts: &Thresholds) -> Option<Change> {
        if self.last != Some(Change::Up) {
            self.low = self.low.min(light);
        }
        if self.last != Some(Change::Down) {
            self.high = self.high.max(light);
        }
        match self.last {
            Some(Change::Up) | None if self.falls_to(light, counts) => {
                (self.last, self.low) = (Some(Change::Down), light);
            }
            Some(Change::Down) | None if self.rises_to(light, counts) => {
                (self.last, self.high) = (Some(Change::Up), light);
            }
            _ => return None,
        }
        self.last
    }

    fn rises_to(&self, light: f32, counts: &Thresholds) -> bool {
        light - self.low >= counts.light_change && self.low < counts.light_darker
    }

    fn falls_to(&self, light: f32, counts: &Thresholds) -> bool {
        self.high - light >= counts.light_change && light < counts.light_darker
    }

    /// Returns true if the last change counts at luminance `light`, but may have been too small before.
    pub(crate) fn may_count_only_at(&self, light: f32, counts: &Thresholds) -> bool {
        let sure = self.high - self.low >= SURE.light_change && self.low < SURE.light_darker;
        let still = match self.last {
            Some(Change::Up) => self.rises_to(light, counts),
            Some(Change::Down) => self.falls_to(light, counts),
            None => false,
        };
        still && !sure
    }

    pub(crate) fn last(&self) -> Option<Change> {
        self.last
    }

    pub(crate) fn low(&self) -> f32 {
        self.low
    }
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct RedSwing {
    red: bool,
    /// The extreme chromaticity since the last change: closest to red after a rise, farthest from red after a fall.
    extreme: Option<[f32; 2]>,
    /// True if the last change certainly counts, whatever the measurement errors.
    sure: bool,
}

impl RedSwing {
    pub(crate) const NEW: Self = Self { red: false, extreme: None, sure: true };

    pub(crate) fn step(&mut self, color: [f32; 3], counts: &Thresholds) -> Option<Change> {
        let now = chromaticity(color);
        let saturated = is_saturated_red(color, counts.red_fraction);
        let Some(extreme) = self.extreme else {
            *self = Self { red: saturated, extreme: Some(now), sure: true };
            return None;
        };
        if saturated != self.red && distance(now, extreme) > counts.red_change {
            let sure = distance(now, extreme) > SURE.red_change
                && (!saturated || is_saturated_red(color, SURE.red_fraction));
            *self = Self { red: saturated, extreme: Some(now), sure };
            return Some(if saturated { Change::Up } else { Change::Down });
        }
        let further = distance(now, RED) > distance(extreme, RED);
        if further != self.red {
            self.extreme = Some(now);
        }
        None
    }

    /// The last change, or the first colour.
    pub(crate) fn last(&self) -> Option<Change> {
        self.extreme.map(|_| if self.red { Change::Up } else { Change::Down })
    }

    pub(crate) fn may_count_only_at(&self, color: [f32; 3], counts: &Thresholds) -> bool {
        !self.sure && is_saturated_red(color, counts.red_fraction) == self.red
    }
}

fn is_saturated_red([r, g, b]: [f32; 3], fraction: f32) -> bool {
    r > 0.0 && r >= fraction * (r + g + b)
}

/// The chromaticity in the CIE 1976 UCS diagram, including the light that the screen reflects.
fn chromaticity(color: [f32; 3]) -> [f32; 2] {
    let [r, g, b] = color.map(|value| value + FLARE);
    let x = 0.4124 * r + 0.3576 * g + 0.1805 * b;
    let y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    let z = 0.0193 * r + 0.1192 * g + 0.9505 * b;
    let sum = x + 15.0 * y + 3.0 * z;
    [4.0 * x / sum, 9.0 * y / sum]
}

fn distance(a: [f32; 2], b: [f32; 2]) -> f32 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

#[derive(Debug, Clone)]
pub(crate) struct Times(VecDeque<f64>);

impl Times {
    pub(crate) const NEW: Self = Self(VecDeque::new());

    pub(crate) fn note(&mut self, time: f64) {
        self.forget(time);
        self.0.push_back(time);
    }

    pub(crate) fn renew(&mut self, time: f64) {
        if let Some(last) = self.0.back_mut() {
            *last = time;
        }
    }

    pub(crate) fn forget(&mut self, now: f64) {
        while self.0.front().is_some_and(|time| *time <= now - 1.0 + ROUNDING) {
            self.0.pop_front();
        }
    }

    /// True if the last change is simultaneous with changes at `now`.
    pub(crate) fn are_fresh(&self, now: f64) -> bool {
        self.0.back().is_some_and(|last| now - last <= SIMULTANEOUS + ROUNDING)
    }

    /// Returns the number of changes. Leaves out changes that will be forgotten within `soon` seconds.
    pub(crate) fn count(&self, now: f64, soon: f64) -> usize {
        self.0.iter().filter(|time| **time > now - 1.0 + soon + ROUNDING).count()
    }
}
