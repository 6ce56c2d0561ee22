//! When a phone is asked for a sign of life, when it is given up, and how many messages it may send. Reads no clock.

use std::time::Instant;

use crate::limits::Limits;

/// See the module.
#[derive(Debug)]
pub(crate) struct Heartbeat {
    limits: Limits,
    heard: Instant,
    asked: Instant,
    /// How many messages may come now, and since when that has not grown.
    allowance: (f64, Instant),
}

/// What is to be done now.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Due {
    Nothing,
    /// To ask for a sign of life.
    Ask,
    /// To give it up.
    GiveUp,
}

impl Heartbeat {
    pub(crate) fn new(limits: Limits, now: Instant) -> Self {
        Self { limits, heard: now, asked: now, allowance: (f64::from(limits.messages_at_once_max), now) }
    }

    /// Something was heard. Returns whether that is not too much.
    pub(crate) fn note_heard(&mut self, now: Instant) -> bool {
        self.heard = now;
        let (left, since) = self.allowance;
        let grown = f64::from(self.limits.messages_per_second_max)
            * now.saturating_duration_since(since).as_secs_f64();
        let left = (left + grown).min(f64::from(self.limits.messages_at_once_max)) - 1.0;
        self.allowance = (left, now);
        left >= 0.0
    }

    /// What is to be done. It is asked several times before it is given up.
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
        heartbeat.note_heard(at(10));
        assert_eq!(heartbeat.due(at(39)), Due::Ask);
        assert_eq!(heartbeat.due(at(40)), Due::GiveUp);
    }

    #[test]
    fn one_message_more_than_what_a_network_holds_up_is_too_much() {
        let start = Instant::now();
        let mut heartbeat = Heartbeat::new(LIMITS, start);
        assert!((0..LIMITS.messages_at_once_max).all(|_| heartbeat.note_heard(start)));
        assert!(!heartbeat.note_heard(start));
        // As many as grow in a second, and what was too much is paid for.
        let later = start + Duration::from_secs(1);
        assert!((1..LIMITS.messages_per_second_max).all(|_| heartbeat.note_heard(later)));
        assert!(!heartbeat.note_heard(later));
        // However long nothing comes, no more come at once.
        let later = start + Duration::from_secs(1_000);
        assert!((0..LIMITS.messages_at_once_max).all(|_| heartbeat.note_heard(later)));
        assert!(!heartbeat.note_heard(later));
    }

    #[test]
    fn a_steady_stream_of_the_limit_goes_on() {
        let start = Instant::now();
        let mut heartbeat = Heartbeat::new(LIMITS, start);
        let at = |number: u32| start + Duration::from_secs(1) * number / LIMITS.messages_per_second_max;
        assert!((0..20 * LIMITS.messages_at_once_max).all(|number| heartbeat.note_heard(at(number))));
    }
}
