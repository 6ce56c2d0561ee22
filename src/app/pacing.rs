//! When the next frame is due: a frame limiter for drivers whose vertical sync does not work, as under a virtual
//! display.

use std::time::{Duration, Instant};

/// Keeps frames an interval apart on average, without drift.
#[derive(Debug, Clone)]
pub struct Pacing {
    interval: Duration,
    due: Instant,
}

impl Pacing {
    /// Allows at most `fps` frames per second from `now` on.
    pub fn new(fps: f64, now: Instant) -> Self {
        let interval = Duration::try_from_secs_f64(1.0 / fps).unwrap_or(Duration::from_millis(16));
        Self { interval, due: now }
    }

    /// When the next frame is due.
    pub fn due(&self) -> Instant {
        self.due
    }

    /// Notes a frame that was begun at `now`. A late frame delays the following ones: no burst makes up for it.
    /// Frames outside the rhythm, such as those drawn while a window is resized, delay the next one by at most an
    /// interval.
    pub fn begun(&mut self, now: Instant) {
        self.due = (self.due + self.interval).clamp(now, now + self.interval);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_keep_their_rhythm_and_lateness_is_not_made_up_for() {
        let start = Instant::now();
        let mut pacing = Pacing::new(100.0, start);
        let ms = |n: u64| start + Duration::from_millis(n);
        pacing.begun(ms(0));
        assert_eq!(pacing.due(), ms(10));
        // A little late: the grid stays.
        pacing.begun(ms(12));
        assert_eq!(pacing.due(), ms(20));
        // Very late: the next frame is due at once, and only one.
        pacing.begun(ms(95));
        assert_eq!(pacing.due(), ms(95));
        pacing.begun(ms(95));
        assert_eq!(pacing.due(), ms(105));
    }

    #[test]
    fn many_redraws_of_a_resize_do_not_freeze_the_picture() {
        let start = Instant::now();
        let mut pacing = Pacing::new(2.0, start);
        for _ in 0..30 {
            pacing.begun(start);
        }
        assert_eq!(pacing.due(), start + Duration::from_millis(500));
    }
}
