//! When a phone is asked for a sign of life, when it is given up, and how many messages it may send. Reads no clock.

use std::time::{Duration, Instant};

use crate::limits::Limits;

/// See the module.
#[derive(Debug)]
pub(crate) struct Pulse {
    limits: Limits,
    heard: Instant,
    asked: Instant,
    /// The second that messages are counted in, and how many there were.
    second: (Instant, u32),
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

impl Pulse {
    pub(crate) fn new(limits: Limits, now: Instant) -> Self {
        Self { limits, heard: now, asked: now, second: (now, 0) }
    }

    /// Something was heard. Returns whether that is not too much.
    pub(crate) fn note_heard(&mut self, now: Instant) -> bool {
        self.heard = now;
        if now.saturating_duration_since(self.second.0) >= Duration::from_secs(1) {
            self.second = (now, 0);
        }
        self.second.1 = self.second.1.saturating_add(1);
        self.second.1 <= self.limits.messages_per_second_max
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
    use super::*;
    use crate::limits::LIMITS;

    #[test]
    fn a_silent_phone_is_asked_and_then_given_up() {
        let start = Instant::now();
        let at = |seconds| start + Duration::from_secs(seconds);
        let mut pulse = Pulse::new(LIMITS, start);
        assert_eq!(pulse.due(at(4)), Due::Nothing);
        assert_eq!(
            [pulse.due(at(5)), pulse.due(at(6)), pulse.due(at(10))],
            [Due::Ask, Due::Nothing, Due::Ask]
        );
        pulse.note_heard(at(10));
        assert_eq!(pulse.due(at(39)), Due::Ask);
        assert_eq!(pulse.due(at(40)), Due::GiveUp);
    }

    #[test]
    fn one_message_more_than_the_limit_in_a_second_is_too_much() {
        let start = Instant::now();
        let mut pulse = Pulse::new(LIMITS, start);
        let most = LIMITS.messages_per_second_max;
        assert!((0..most).all(|_| pulse.note_heard(start)));
        assert!(!pulse.note_heard(start + Duration::from_millis(999)));
        assert!(pulse.note_heard(start + Duration::from_secs(1)), "the next second");
    }
}
