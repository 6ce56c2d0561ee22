//! Messages that wait for their time: bundles say when what is in them is to happen.

use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::time::{Duration, Instant, SystemTime};

use rosc::{OscMessage, OscTime};

use crate::limits::LIMITS;

/// From the zero of times in OSC (1900) to that of the system's clock (1970), in seconds.
const TO_UNIX: u64 = 2_208_988_800;
/// Parts of a second in those times.
const PARTS: f64 = 4_294_967_296.0;

/// When something happens whose time is a bundle's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum When {
    /// At once: that is asked for, or it is over.
    Now,
    /// After so long.
    In(Duration),
    /// So late that nobody waits for it.
    TooLate,
}

/// When a time is, where the system's clock shows `now`. A message without a bundle has none.
pub(super) fn when(time: Option<OscTime>, now: SystemTime) -> When {
    // The first moment of all means at once; some write the one before it.
    let Some(time) = time.filter(|time| time.seconds > 0 || time.fractional > 1) else { return When::Now };
    let now = now.duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default().as_secs_f64();
    // In 2036 the seconds begin anew: a time is the one that is nearest.
    let now_of_osc = (now as u64).wrapping_add(TO_UNIX) as u32;
    let seconds = f64::from(time.seconds.wrapping_sub(now_of_osc) as i32) - now.fract();
    let ahead = seconds + f64::from(time.fractional) / PARTS;
    match ahead {
        ..=0.0 => When::Now,
        ahead if ahead > LIMITS.osc_ahead_seconds_max => When::TooLate,
        ahead => Duration::try_from_secs_f64(ahead).map_or(When::TooLate, When::In),
    }
}

/// Messages that wait, and who sent them.
#[derive(Default)]
pub(super) struct Waiting {
    /// By when they are due, and in the order in which they came.
    messages: BTreeMap<(Instant, u64), (OscMessage, SocketAddr)>,
    count: u64,
}

impl Waiting {
    /// Lets a message wait. False if too many do.
    pub(super) fn put(&mut self, due: Instant, message: OscMessage, from: SocketAddr) -> bool {
        let has_room = self.messages.len() < LIMITS.osc_waiting_max;
        if has_room {
            self.count += 1;
            self.messages.insert((due, self.count), (message, from));
        }
        has_room
    }

    /// The next message that is due at `now`.
    pub(super) fn take(&mut self, now: Instant) -> Option<(OscMessage, SocketAddr)> {
        let first = self.messages.first_entry().filter(|first| first.key().0 <= now)?;
        Some(first.remove())
    }

    /// How long it is until the next one is due.
    pub(super) fn patience(&self, now: Instant) -> Option<Duration> {
        self.messages.first_key_value().map(|((due, _), _)| due.saturating_duration_since(now))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_osc(time: SystemTime) -> OscTime {
        OscTime::try_from(time).unwrap()
    }

    #[test]
    fn what_is_asked_for_at_once_or_is_over_happens_now_and_the_rest_waits_for_a_while() {
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
        // The seconds of OSC begin anew on 7 February 2036.
        let last = SystemTime::UNIX_EPOCH + Duration::from_secs(u64::from(u32::MAX) - TO_UNIX);
        assert_eq!(when(Some(OscTime { seconds: 1, fractional: 0 }), last), When::In(Duration::from_secs(2)));
    }

    #[test]
    fn messages_come_when_they_are_due_in_their_order_and_no_more_wait_than_there_is_room() {
        let (start, from) = (Instant::now(), SocketAddr::from(([127, 0, 0, 1], 9)));
        let at = |ms| start + Duration::from_millis(ms);
        let message = |addr: &str| OscMessage { addr: addr.to_owned(), args: Vec::new() };
        let mut waiting = Waiting::default();
        assert_eq!(waiting.patience(start), None);
        for (ms, addr) in [(20, "/c"), (10, "/a"), (10, "/b")] {
            assert!(waiting.put(at(ms), message(addr), from));
        }
        assert_eq!(waiting.patience(start), Some(Duration::from_millis(10)));
        assert_eq!(waiting.take(at(9)), None);
        let taken = |waiting: &mut Waiting| waiting.take(at(15)).map(|(message, _)| message.addr);
        assert_eq!([(); 3].map(|()| taken(&mut waiting)), [Some("/a".into()), Some("/b".into()), None]);
        let put = (1..=LIMITS.osc_waiting_max).filter(|_| waiting.put(at(30), message("/d"), from)).count();
        assert_eq!(put, LIMITS.osc_waiting_max - 1, "one waits already");
    }
}
