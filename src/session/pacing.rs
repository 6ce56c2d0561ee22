//! A frame limiter for drivers whose vertical sync does not work, as under a virtual display.

use std::time::{Duration, Instant};

/// Keeps frames an interval apart on average, without drift.
#[derive(Debug, Clone)]
pub struct Pacing {
    interval: Duration,
    due: Instant,
}

impl Pacing {
    /// Allows at most `fps` frames per second, starting at `now`.
    pub fn new(fps: f64, now: Instant) -> Self {
        let interval = Duration::try_from_secs_f64(1.0 / fps).unwrap_or(Duration::from_millis(16));
        Self { interval, due: now }
    }

    /// The time of the next frame. A frame that `answers` a controller may begin up to one interval early.
    pub fn due(&self, answers: bool) -> Instant {
        let early = if answers { self.interval } else { Duration::ZERO };
        self.due.checked_sub(early).unwrap_or(self.due)
    }

    /// Notes a frame that was begun at `now`. A late frame delays the following frames, so that they do not come in a
    /// burst. Extra frames, such as those drawn while a window is resized, delay the next one by at most an interval.
    /// A frame that `answers` a controller replaces the next frame, so the next pause is up to two intervals.
    pub fn begun(&mut self, now: Instant, answers: bool) {
        let latest = now + if answers { 2 * self.interval } else { self.interval };
        self.due = (self.due + self.interval).clamp(now, latest);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_keep_their_rhythm_and_late_ones_cause_no_burst() {
        let start = Instant::now();
        let mut pacing = Pacing::new(100.0, start);
        let ms = |n: u64| start + Duration::from_millis(n);
        pacing.begun(ms(0), false);
        assert_eq!(pacing.due(false), ms(10));
        // A frame that is a little late does not change the rhythm.
        pacing.begun(ms(12), false);
        assert_eq!(pacing.due(false), ms(20));
        // After a very late frame, a single frame is due at once.
        pacing.begun(ms(95), false);
        assert_eq!(pacing.due(false), ms(95));
        pacing.begun(ms(95), false);
        assert_eq!(pacing.due(false), ms(105));
    }

    #[test]
    fn many_redraws_of_a_resize_do_not_delay_frames_for_long() {
        let start = Instant::now();
        let mut pacing = Pacing::new(2.0, start);
        for _ in 0..30 {
            pacing.begun(start, false);
        }
        assert_eq!(pacing.due(false), start + Duration::from_millis(500));
    }

    #[test]
    fn a_controller_is_answered_at_once_without_extra_frames() {
        let start = Instant::now();
        let ms = |n: u64| start + Duration::from_millis(n);
        let mut pacing = Pacing::new(100.0, start);
        pacing.begun(ms(0), false);
        assert_eq!((pacing.due(true), pacing.due(false)), (ms(0), ms(10)));
        // This frame replaces the frame at 10 ms.
        pacing.begun(ms(3), true);
        assert_eq!((pacing.due(true), pacing.due(false)), (ms(10), ms(20)));
        // A constantly moving controller gets one frame per interval, like an animated scene.
        let mut frames = 0;
        for now in 3..1000 {
            if ms(now) >= pacing.due(true) {
                pacing.begun(ms(now), true);
                frames += 1;
            }
        }
        assert_eq!(frames, 99);
    }
}
