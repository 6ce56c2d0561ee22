//! A value on its way to another one.

/// A value that approaches its target: all but 1/e of the distance is gone after the smoothing time. A function of time,
/// and one that can be interrupted anywhere without a jump.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Glide {
    from: f32,
    to: f32,
    /// When it left `from`, in seconds.
    since: f64,
    /// The smoothing time in seconds; 0 is there at once.
    seconds: f32,
}

/// After so many smoothing times it is there: e⁻⁷ of the distance is left, less than a thousandth.
const TIMES: f64 = 7.0;

impl Glide {
    /// A value that stands.
    pub fn at(value: f32) -> Self {
        Self { from: value, to: value, since: 0.0, seconds: 0.0 }
    }

    /// From where this is at `now` to `to`, in a smoothing time of `seconds`.
    #[must_use]
    pub fn towards(self, to: f32, seconds: f32, now: f64) -> Self {
        Self { from: self.value(now), to, since: now, seconds: seconds.max(0.0) }
    }

    /// Where it is at `now`, in seconds; before its start it is there.
    pub fn value(&self, now: f64) -> f32 {
        if !self.moves(now) {
            return self.to;
        }
        let rest = (-(now - self.since).max(0.0) / f64::from(self.seconds)).exp();
        let (from, to) = (f64::from(self.from), f64::from(self.to));
        (to + (from - to) * rest) as f32
    }

    /// Where it goes.
    pub fn target(&self) -> f32 {
        self.to
    }

    /// Whether it is still on its way at `now`.
    pub fn moves(&self, now: f64) -> bool {
        self.from != self.to && now - self.since < TIMES * f64::from(self.seconds)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn all_but_one_eth_is_gone_after_the_smoothing_time_and_it_arrives() {
        let glide = Glide::at(1.0).towards(3.0, 0.5, 10.0);
        assert_eq!((glide.value(9.0), glide.value(10.0)), (1.0, 1.0));
        assert!((glide.value(10.5) - (3.0 - 2.0 / std::f32::consts::E)).abs() < 1e-6);
        assert!(glide.moves(13.49) && (glide.value(13.49) - 3.0).abs() < 2e-3);
        assert_eq!((glide.moves(13.5), glide.value(13.5)), (false, 3.0));
        assert_eq!(Glide::at(1.0).towards(3.0, 0.0, 10.0).value(10.0), 3.0, "without smoothing it is there");
    }

    proptest! {
        /// Turning a knob again to where it goes already, as each frame might, changes nothing of its way.
        #[test]
        fn how_often_it_is_looked_at_makes_no_difference(
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
                // The end of the way is cut where it is shorter than a thousandth of the whole.
                prop_assert!((often.value(now) - once.value(now)).abs() < 3e-3);
            }
        }
    }
}
