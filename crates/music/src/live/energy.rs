//! The energy of live input: its loudness relative to the loudest moment of the last minutes.

/// Energy 0 is this many decibels below the loudest level. A song's structure uses the same range.
const RANGE_DB: f32 = 36.0;
/// Time constant of the level, in seconds.
const FOLLOWS_IN: f64 = 0.7;
/// The decay of the loudest level, in decibels a second: 6 dB in two minutes.
const FORGOTTEN_DB: f64 = 0.05;
/// The loudest level counts as at least this much, in decibels, so that noise does not count as music.
const LOUDEST_MIN_DB: f32 = -50.0;

/// Follows the level of a stream. The same levels at the same times give the same energy.
#[derive(Clone, Debug, Default)]
pub struct LiveEnergy {
    /// The time of the last level, the smoothed level, and the loudest level.
    state: Option<(f64, f32, f32)>,
}

impl LiveEnergy {
    /// Returns the energy, 0..1, at `time` in seconds for the level `level_db`
    /// ([`Features::level_db`](crate::Features)). If `time` is earlier than in the last call, the loudest level does
    /// not decay.
    pub fn at(&mut self, time: f64, level_db: f32) -> f32 {
        let level_db = if level_db.is_finite() { level_db } else { crate::LEVEL_FLOOR_DB };
        let time = if time.is_finite() { time } else { 0.0 };
        let (last, mut level, mut loudest) = self.state.unwrap_or((time, level_db, LOUDEST_MIN_DB));
        let passed = (time - last).max(0.0);
        level += (level_db - level) * (1.0 - (-passed / FOLLOWS_IN).exp()) as f32;
        loudest = (loudest - (FORGOTTEN_DB * passed) as f32).max(level).max(LOUDEST_MIN_DB);
        self.state = Some((time, level, loudest));
        (1.0 + (level - loudest) / RANGE_DB).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn energy_is_relative_to_the_loudest_of_the_last_minutes() {
        let mut energy = LiveEnergy::default();
        let mut run = |from: u32, to: u32, level| {
            (from * 10..to * 10).map(|n| energy.at(f64::from(n) / 10.0, level)).last().unwrap_or_default()
        };
        assert_eq!(run(0, 5, -10.0), 1.0);
        let quiet = run(5, 15, -28.0);
        assert!((0.45..0.55).contains(&quiet), "half the range below the loudest: {quiet}");
        let later = run(15, 615, -28.0);
        assert!(later > 0.99, "the loud moment is forgotten: {later}");
        assert_eq!(run(615, 625, -120.0), 0.0);
    }

    #[test]
    fn noise_has_no_energy_and_odd_times_are_handled() {
        let mut energy = LiveEnergy::default();
        assert!(energy.at(0.0, -90.0) <= 0.0);
        for (time, level) in
            [(f64::NAN, -20.0), (-5.0, f32::NAN), (f64::INFINITY, 0.0), (3.0, f32::INFINITY), (4.0, -9.0)]
        {
            assert!((0.0..=1.0).contains(&energy.at(time, level)), "{time} {level}");
        }
    }
}
