//! Scheduled OSC messages: a bundle's time tag gives the time at which its messages take effect.

use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::time::{Duration, Instant, SystemTime};

use rosc::{OscMessage, OscTime};

use crate::limits::LIMITS;

/// Seconds from the OSC epoch (1900) to the Unix epoch (1970).
const TO_UNIX: u64 = 2_208_988_800;
/// The fraction in an OSC time counts this many units per second.
const PARTS: f64 = 4_294_967_296.0;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum When {
    /// The sender requests immediate effect, or the time has passed.
    Now,
    In(Duration),
    TooLate,
}

/// Converts a time tag, relative to the system time `now`. `None` is for messages outside bundles.
pub(super) fn when(time: Option<OscTime>, now: SystemTime) -> When {
    // The time tags 0 and 1 mean "immediately". The standard defines 1; some senders use 0.
    let Some(time) = time.filter(|time| time.seconds > 0 || time.fractional > 1) else { return When::Now };
    let now = now.duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default().as_secs_f64();
    // OSC seconds wrap around in 2036: take the time closest to now.
    let now_of_osc = (now as u64).wrapping_add(TO_UNIX) as u32;
    let seconds = f64::from(time.seconds.wrapping_sub(now_of_osc) as i32) - now.fract();
    let ahead = seconds + f64::from(time.fractional) / PARTS;
    match ahead {
        ..=0.0 => When::Now,
        ahead if ahead > LIMITS.osc_ahead_seconds_max => When::TooLate,
        ahead => Duration::try_from_secs_f64(ahead).map_or(When::TooLate, When::In),
    }
}

#[derive(Default)]
pub(super) struct Waiting {
    /// Messages by due time, then by order of arrival.
    messages: BTreeMap<(Instant, u64), (OscMessage, SocketAddr)>,
    count: u64,
}

impl Waiting {
    /// Schedules a message. Returns false if too many are waiting.
    pub(super) fn put(&mut self, due: Instant, message: OscMessage, from: SocketAddr) -> bool {
        let has_room = self.messages.len() < LIMITS.osc_waiting_max;
        if has_room {
            self.count += 1;
            self.messages.insert((due, self.count), (message, from));
        }
        has_room
    }

    pub(super) fn pop_due(&mut self, now: Instant) -> Option<(OscMessage, SocketAddr)> {
        let first = self.messages.first_entry().filter(|first| first.key().0 <= now)?;
        Some(first.remove())
    }

    pub(super) fn patience(&self, now: Instant) -> Option<Duration> {
        self.messages.first_key_value().map(|((due, _), _)| due.saturating_duration_since(now))
    }
}

/// The time of OSC: seconds since 1900, and the rest of a second in 2^-32 s.
#[cfg(test)]
pub(super) fn of_osc(time: SystemTime) -> OscTime {
    let time = time.duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    let seconds = u32::try_from(time.as_secs() + TO_UNIX).unwrap_or(u32::MAX);
    let fraction = (u64::from(time.subsec_nanos()) << 32).div_ceil(1_000_000_000);
    OscTime { seconds, fractional: u32::try_from(fraction).unwrap_or(u32::MAX) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn past_and_immediate_messages_are_due_now_and_others_wait() {
        let now = SystemTime::UNIX_EPOCH + Duration::from_millis(1_700_000_000_250);
        let after = |seconds: f64| when(Some(of_osc(now + Duration::from_secs_f64(seconds))), now);
        assert_eq!(when(None, now), When::Now);
        assert_eq!(when(Some(OscTime { seconds: 0, fractional: 1 }), now), When::Now);
        assert_eq!(when(Some(OscTime { seconds: 0, fractional: 0 }), now), When::Now);
        assert_eq!(when(Some(of_osc(now - Duration::from_secs(5))), now), When::Now);
        for seconds in [0.5, 1.0, LIMITS.osc_ahead_seconds_max - 0.1] {
            let When::In(found) = after(seconds) else { panic!("{seconds} s: {:?}", after(seconds)) };
            assert!((found.as_secs_f64() - seconds).abs() < 1e-5, "{found:?} instead of {seconds} s");
        }
        assert_eq!(after(LIMITS.osc_ahead_seconds_max + 1.0), When::TooLate);
        // OSC seconds wrap around on 7 February 2036.
        let last = SystemTime::UNIX_EPOCH + Duration::from_secs(u64::from(u32::MAX) - TO_UNIX);
        assert_eq!(when(Some(OscTime { seconds: 1, fractional: 0 }), last), When::In(Duration::from_secs(2)));
    }

    #[test]
    fn messages_are_taken_in_order_when_due_and_their_number_is_limited() {
        let (start, from) = (Instant::now(), SocketAddr::from(([127, 0, 0, 1], 9)));
        let at = |ms| start + Duration::from_millis(ms);
        let message = |addr: &str| OscMessage { addr: addr.to_owned(), args: Vec::new() };
        let mut waiting = Waiting::default();
        assert_eq!(waiting.patience(start), None);
        for (ms, addr) in [(20, "/c"), (10, "/a"), (10, "/b")] {
            assert!(waiting.put(at(ms), message(addr), from));
        }
        assert_eq!(waiting.patience(start), Some(Duration::from_millis(10)));
        assert_eq!(waiting.pop_due(at(9)), None);
        let taken = |waiting: &mut Waiting| waiting.pop_due(at(15)).map(|(message, _)| message.addr);
        assert_eq!([(); 3].map(|()| taken(&mut waiting)), [Some("/a".into()), Some("/b".into()), None]);
        let put = (1..=LIMITS.osc_waiting_max).filter(|_| waiting.put(at(30), message("/d"), from)).count();
        assert_eq!(put, LIMITS.osc_waiting_max - 1, "one message is already waiting");
    }
}
