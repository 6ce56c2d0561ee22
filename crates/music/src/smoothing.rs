//! Smoothing with a fast attack and a slow release.

/// A value closer to its target than this distance is set to the target, so that silence becomes exactly 0.
const ARRIVED: f32 = 1e-6;

/// A one-pole smoother with different time constants for rising and falling. The distance to a constant target shrinks
/// by the factor exp(-time / time constant). The result is exact for any step: many short steps and one long step give
/// the same value.
#[derive(Clone, Copy, Debug)]
pub(super) struct Follower {
    keep_rising: f32,
    keep_falling: f32,
}

impl Follower {
    /// Creates a smoother from the `attack` and `release` time constants and the `step`, all in seconds above 0.
    pub(super) fn new(attack: f64, release: f64, step: f64) -> Self {
        Self { keep_rising: (-step / attack).exp() as f32, keep_falling: (-step / release).exp() as f32 }
    }

    pub(super) fn follow(&self, value: &mut f32, target: f32) {
        let distance = *value - target;
        let keep = if distance < 0.0 { self.keep_rising } else { self.keep_falling };
        let rest = distance * keep;
        *value = if rest.abs() < ARRIVED { target } else { target + rest };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(seconds: f64, steps: usize, start: f32, target: f32) -> f32 {
        let follower = Follower::new(0.01, 0.2, seconds / steps as f64);
        let mut value = start;
        (0..steps).for_each(|_| follower.follow(&mut value, target));
        value
    }

    #[test]
    fn time_constants_match_the_arguments() {
        let e = std::f32::consts::E;
        assert!((after(0.01, 1, 0.0, 1.0) - (1.0 - 1.0 / e)).abs() < 1e-6);
        assert!((after(0.2, 1, 1.0, 0.0) - 1.0 / e).abs() < 1e-6);
    }

    #[test]
    fn result_does_not_depend_on_the_step() {
        for (start, target) in [(0.0, 0.8), (0.9, 0.1)] {
            let once = after(0.03, 1, start, target);
            for steps in [2, 3, 7, 100] {
                let many = after(0.03, steps, start, target);
                assert!((many - once).abs() < 1e-5, "{steps} steps: {many}, one step: {once}");
            }
        }
    }

    #[test]
    fn silence_is_reached() {
        assert_eq!(after(10.0, 1000, 1.0, 0.0), 0.0);
    }
}
