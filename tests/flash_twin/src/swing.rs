//! Finds the changes of one cell's luminance and red between peaks and valleys.

use std::collections::VecDeque;

use mariana_render::flash::{FLARE, RED, ROUNDING, SIMULTANEOUS, SURE, Thresholds};

/// The thresholds of WCAG 2.3.1.
pub(super) const DEFINED: Thresholds =
    Thresholds { light_change: 0.1, light_darker: 0.8, red_fraction: 0.8, red_change: 0.2 };

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Change {
    Up,
    Down,
}

/// Finds changes of a luminance. A change is reported as soon as it is large enough.
#[derive(Debug, Clone, Copy)]
pub(super) struct LightSwing {
    pub(super) last: Option<Change>,
    /// The lowest luminance since the last change. If the last change was a rise, the valley before the rise.
    pub(super) low: f32,
    /// The highest luminance since the last change. If the last change was a fall, the peak before the fall.
    high: f32,
}

impl LightSwing {
    pub(super) const NEW: Self = Self { last: None, low: f32::INFINITY, high: f32::NEG_INFINITY };

    pub(super) fn step(&mut self, light: f32, counts: &Thresholds) -> Option<Change> {
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
    pub(super) fn may_count_only_at(&self, light: f32, counts: &Thresholds) -> bool {
        let sure = self.high - self.low >= SURE.light_change && self.low < SURE.light_darker;
        let still = match self.last {
            Some(Change::Up) => self.rises_to(light, counts),
            Some(Change::Down) => self.falls_to(light, counts),
            None => false,
        };
        still && !sure
    }
}

#[derive(Debug, Clone, Copy)]
pub(super) struct RedSwing {
    red: bool,
    /// The extreme chromaticity since the last change: closest to red after a rise, farthest from red after a fall.
    extreme: Option<[f32; 2]>,
    /// True if the last change certainly counts, whatever the measurement errors.
    sure: bool,
}

impl RedSwing {
    pub(super) const NEW: Self = Self { red: false, extreme: None, sure: true };

    pub(super) fn step(&mut self, color: [f32; 3], counts: &Thresholds) -> Option<Change> {
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
    pub(super) fn last(&self) -> Option<Change> {
        self.extreme.map(|_| if self.red { Change::Up } else { Change::Down })
    }

    pub(super) fn may_count_only_at(&self, color: [f32; 3], counts: &Thresholds) -> bool {
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
pub(super) struct Times(VecDeque<f64>);

impl Times {
    pub(super) const NEW: Self = Self(VecDeque::new());

    pub(super) fn add(&mut self, time: f64) {
        self.forget(time);
        self.0.push_back(time);
    }

    pub(super) fn renew(&mut self, time: f64) {
        if let Some(last) = self.0.back_mut() {
            *last = time;
        }
    }

    pub(super) fn forget(&mut self, now: f64) {
        while self.0.front().is_some_and(|time| *time <= now - 1.0 + ROUNDING) {
            self.0.pop_front();
        }
    }

    /// True if the last change is simultaneous with changes at `now`.
    pub(super) fn are_fresh(&self, now: f64) -> bool {
        self.0.back().is_some_and(|last| now - last <= SIMULTANEOUS + ROUNDING)
    }

    /// Returns the number of changes. Leaves out changes that will be forgotten within `soon` seconds.
    pub(super) fn count(&self, now: f64, soon: f64) -> usize {
        self.0.iter().filter(|time| **time > now - 1.0 + soon + ROUNDING).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_render::flash::CAUTIOUS;

    fn light_changes(lights: &[f32]) -> usize {
        let mut swing = LightSwing::NEW;
        lights.iter().filter(|light| swing.step(**light, &DEFINED).is_some()).count()
    }

    fn red_changes(colors: &[[f32; 3]]) -> usize {
        let mut swing = RedSwing::NEW;
        colors.iter().filter(|color| swing.step(**color, &DEFINED).is_some()).count()
    }

    #[test]
    fn changes_of_light_count_from_a_tenth_on_and_below_four_fifths() {
        assert_eq!(light_changes(&[0.0, 1.0, 0.0, 1.0]), 3);
        assert_eq!(light_changes(&[0.3, 0.39, 0.3, 0.39]), 0);
        assert_eq!(light_changes(&[0.3, 0.41, 0.3]), 2);
        assert_eq!(light_changes(&[0.82, 1.0, 0.82]), 0, "the darker state is bright");
        assert_eq!(light_changes(&[0.7, 1.0, 0.7]), 2);
        let ramp = (0..200).map(|i| if i < 100 { i as f32 / 100.0 } else { 2.0 - i as f32 / 100.0 });
        assert_eq!(light_changes(&ramp.collect::<Vec<_>>()), 2);
        assert_eq!(light_changes(&[0.0, 0.5, 0.45, 0.55, 0.5, 0.6, 0.0]), 2);
    }

    #[test]
    fn a_borderline_change_may_count_later() {
        let mut swing = LightSwing::NEW;
        swing.step(0.2, &CAUTIOUS);
        assert_eq!(swing.step(0.297, &CAUTIOUS), Some(Change::Up));
        assert!(swing.may_count_only_at(0.3, &CAUTIOUS) && !swing.may_count_only_at(0.29, &CAUTIOUS));
        assert_eq!(swing.step(0.31, &CAUTIOUS), None);
        assert!(!swing.may_count_only_at(0.32, &CAUTIOUS), "the change has counted");
        assert_eq!(swing.step(0.213, &CAUTIOUS), Some(Change::Down));
        assert!(swing.may_count_only_at(0.209, &CAUTIOUS) && !swing.may_count_only_at(0.23, &CAUTIOUS));
    }

    #[test]
    fn changes_to_and_from_saturated_red_count() {
        let (red, black, white, green) = ([1.0, 0.0, 0.0], [0.0; 3], [1.0; 3], [0.0, 1.0, 0.0]);
        for other in [black, white, green] {
            assert_eq!(red_changes(&[red, other, red]), 2, "{other:?}");
        }
        assert_eq!(red_changes(&[white, black, white, green, white]), 0);
        assert_eq!(red_changes(&[[0.5, 0.2, 0.2], black, [0.5, 0.2, 0.2]]), 0, "the red is not saturated");
        assert_eq!(red_changes(&[[0.005, 0.0, 0.0], black, [0.005, 0.0, 0.0]]), 0);
        assert_eq!(red_changes(&[red, [0.9, 0.1, 0.0], red]), 0);
    }

    #[test]
    fn a_change_to_a_borderline_red_may_count_later() {
        let (hardly, red, black) = ([0.8, 0.1, 0.1], [1.0, 0.0, 0.0], [0.0; 3]);
        for (color, may) in [(hardly, true), (red, false)] {
            let mut swing = RedSwing::NEW;
            swing.step([0.0, 0.0, 1.0], &CAUTIOUS);
            assert_eq!(swing.step(color, &CAUTIOUS), Some(Change::Up));
            assert_eq!(swing.may_count_only_at(red, &CAUTIOUS), may);
            assert!(!swing.may_count_only_at(black, &CAUTIOUS));
        }
    }

    #[test]
    fn changes_older_than_a_second_are_forgotten() {
        let mut times = Times::NEW;
        for i in 0..30 {
            times.add(f64::from(i) / 30.0);
        }
        assert_eq!(times.count(29.0 / 30.0, 0.0), 30);
        times.add(1.0);
        assert_eq!((times.count(1.0, 0.0), times.count(1.0, 0.1)), (30, 27));
    }
}
