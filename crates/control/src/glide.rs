//! Smoothing: a value that approaches a target.

/// A value that approaches its target exponentially: 1/e of the distance is left after the smoothing time. The value
/// is a pure function of time. A new target may be set at any time without a jump.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Glide {
    from: f32,
    to: f32,
    /// The time at which the movement starts, in seconds.
    since: f64,
    /// The smoothing time in seconds; 0 jumps to the target.
    seconds: f32,
    /// True for a soft ramp that ends after `seconds`.
    is_ramp: bool,
}

/// A movement ends after this many smoothing times, when less than a thousandth (e⁻⁷) of the distance is left.
const TIMES: f64 = 7.0;

impl Glide {
    /// Returns a constant value.
    pub fn at(value: f32) -> Self {
        Self { from: value, to: value, since: 0.0, seconds: 0.0, is_ramp: false }
    }

    /// Starts a movement from the value at the time `now` to the value `to`, with a smoothing time of `seconds`.
    #[must_use]
    pub fn towards(self, to: f32, seconds: f32, now: f64) -> Self {
        Self { from: self.value(now), to, since: now, seconds: seconds.max(0.0), is_ramp: false }
    }

    /// Starts a movement that ends after `seconds`: slow at both ends, and half-way in the middle.
    #[must_use]
    pub fn ramp(self, to: f32, seconds: f32, now: f64) -> Self {
        Self { is_ramp: true, ..self.towards(to, seconds, now) }
    }

    /// Returns the value at the time `now`, in seconds. Before the movement starts, returns the start value.
    pub fn value(&self, now: f64) -> f32 {
        if !self.moves(now) {
            return self.to;
        }
        let gone = (now - self.since).max(0.0) / f64::from(self.seconds);
        let rest = if self.is_ramp { 1.0 - gone * gone * (3.0 - 2.0 * gone) } else { (-gone).exp() };
        let (from, to) = (f64::from(self.from), f64::from(self.to));
        (to + (from - to) * rest) as f32
    }

    /// Returns the target value.
    pub fn target(&self) -> f32 {
        self.to
    }

    /// True while the value still moves at `now`.
    pub fn moves(&self, now: f64) -> bool {
        let times = if self.is_ramp { 1.0 } else { TIMES };
        self.from != self.to && now - self.since < times * f64::from(self.seconds)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn one_eth_of_the_distance_is_left_after_the_smoothing_time() {
        let glide = Glide::at(1.0).towards(3.0, 0.5, 10.0);
        assert_eq!((glide.value(9.0), glide.value(10.0)), (1.0, 1.0));
        assert!((glide.value(10.5) - (3.0 - 2.0 / std::f32::consts::E)).abs() < 1e-6);
        assert!(glide.moves(13.49) && (glide.value(13.49) - 3.0).abs() < 2e-3);
        assert_eq!((glide.moves(13.5), glide.value(13.5)), (false, 3.0));
        assert_eq!(
            Glide::at(1.0).towards(3.0, 0.0, 10.0).value(10.0),
            3.0,
            "without smoothing the value jumps"
        );
    }

    #[test]
    fn a_ramp_ends_after_its_time() {
        let ramp = Glide::at(1.0).ramp(3.0, 2.0, 10.0);
        assert_eq!([9.0, 10.0, 11.0, 12.0, 13.0].map(|now| ramp.value(now)), [1.0, 1.0, 2.0, 3.0, 3.0]);
        assert!(ramp.moves(11.9) && !ramp.moves(12.0));
        assert_eq!(Glide::at(1.0).ramp(3.0, 0.0, 10.0).value(10.0), 3.0);
    }

    proptest! {
        #[test]
        fn restarting_a_glide_does_not_change_its_path(
            steps in proptest::collection::vec(0.001_f64..0.2, 1..40),
            seconds in 0.01_f32..2.0,
        ) {
            let once = Glide::at(-1.0).towards(1.0, seconds, 0.0);
            let mut often = once;
            let mut now = 0.0;
            for step in steps {
                now += step;
                if often.moves(now) {
                    often = often.towards(1.0, seconds, now);
                }
                // The last thousandth of the distance is cut off.
                prop_assert!((often.value(now) - once.value(now)).abs() < 3e-3);
            }
        }
    }
}
