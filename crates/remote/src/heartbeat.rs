//! The liveness check and the message rate limit of a phone's connection. Reads no clock: the caller passes the time.

use std::time::Instant;

use crate::limits::Limits;

#[derive(Debug)]
pub(crate) struct Heartbeat {
    limits: Limits,
    heard: Instant,
    asked: Instant,
    /// The number of messages allowed now, and the time of the last update of this number.
    allowance: (f64, Instant),
}

#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Due {
    Nothing,
    /// Send a ping.
    Ask,
    /// Close the connection.
    GiveUp,
}

impl Heartbeat {
    pub(crate) fn new(limits: Limits, now: Instant) -> Self {
        Self { limits, heard: now, asked: now, allowance: (f64::from(limits.messages_at_once_max), now) }
    }

    /// Counts a received message. Returns false if the rate limit is exceeded.
    pub(crate) fn count_message(&mut self, now: Instant) -> bool {
        self.heard = now;
        let (left, since) = self.allowance;
        let grown = f64::from(self.limits.messages_per_second_max)
            * now.saturating_duration_since(since).as_secs_f64();
        let left = (left + grown).min(f64::from(self.limits.messages_at_once_max)) - 1.0;
        self.allowance = (left, now);
        left >= 0.0
    }

    /// Returns the next step. Several pings are sent before the connection is closed.
    pub(crate) fn due(&mut self, now: Instant) -> Due {
        if now.saturating_duration_since(self.heard) >= self.limits.silence_max {
            return Due::GiveUp;
        }
        let interval = self.limits.silence_max / 6;
        if now.saturating_duration_since(self.asked) < interval {
            return Due::Nothing;
        }
        self.asked = now;
        Due::Ask
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::limits::LIMITS;

    #[test]
    fn a_silent_phone_is_asked_and_then_given_up() {
        let start = Instant::now();
        let at = |seconds| start + Duration::from_secs(seconds);
        let mut heartbeat = Heartbeat::new(LIMITS, start);
        assert_eq!(heartbeat.due(at(4)), Due::Nothing);
        assert_eq!(
            [heartbeat.due(at(5)), heartbeat.due(at(6)), heartbeat.due(at(10))],
            [Due::Ask, Due::Nothing, Due::Ask]
        );
        heartbeat.count_message(at(10));
        assert_eq!(heartbeat.due(at(39)), Due::Ask);
        assert_eq!(heartbeat.due(at(40)), Due::GiveUp);
    }

    #[test]
    fn messages_beyond_the_burst_limit_are_too_many() {
        let start = Instant::now();
        let mut heartbeat = Heartbeat::new(LIMITS, start);
        assert!((0..LIMITS.messages_at_once_max).all(|_| heartbeat.count_message(start)));
        assert!(!heartbeat.count_message(start));
        // After one second, the allowance is one second of messages, minus the message that was rejected before.
        let later = start + Duration::from_secs(1);
        assert!((1..LIMITS.messages_per_second_max).all(|_| heartbeat.count_message(later)));
        assert!(!heartbeat.count_message(later));
        // Even a long pause does not make the allowed burst larger.
        let later = start + Duration::from_secs(1_000);
        assert!((0..LIMITS.messages_at_once_max).all(|_| heartbeat.count_message(later)));
        assert!(!heartbeat.count_message(later));
    }

    #[test]
    fn a_steady_stream_at_the_limit_is_allowed() {
        let start = Instant::now();
        let mut heartbeat = Heartbeat::new(LIMITS, start);
        let at = |number: u32| start + Duration::from_secs(1) * number / LIMITS.messages_per_second_max;
        assert!((0..20 * LIMITS.messages_at_once_max).all(|number| heartbeat.count_message(at(number))));
    }
}
