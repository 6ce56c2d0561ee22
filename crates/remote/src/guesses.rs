//! Who guessed a token wrongly, and how long they have to wait for it.
//!
//! While an address waits, not even the right token is looked at, so that a guess costs its time however many are sent at
//! once. Reads no clock.

use std::collections::HashMap;
use std::net::{IpAddr, Ipv6Addr};
use std::time::{Duration, Instant};

use crate::limits::Limits;

#[derive(Debug, Clone, Copy)]
struct Guesser {
    wrong: u32,
    last: Instant,
    free: Instant,
}

/// See the module.
#[derive(Debug)]
pub struct Guesses {
    limits: Limits,
    by_address: HashMap<IpAddr, Guesser>,
}

/// What is one guesser: an address, or the network of 64 bits that one machine may have many addresses in.
fn guesser(address: IpAddr) -> IpAddr {
    match address.to_canonical() {
        IpAddr::V6(address) => {
            let [a, b, c, d, ..] = address.segments();
            IpAddr::V6(Ipv6Addr::new(a, b, c, d, 0, 0, 0, 0))
        }
        address @ IpAddr::V4(_) => address,
    }
}

impl Guesses {
    /// Nobody has guessed yet.
    pub fn new(limits: Limits) -> Self {
        Self { limits, by_address: HashMap::new() }
    }

    /// How long an address has to wait before it is answered again; none if it need not.
    pub fn pause(&self, address: IpAddr, now: Instant) -> Option<Duration> {
        let free = self.by_address.get(&guesser(address))?.free;
        free.checked_duration_since(now).filter(|left| !left.is_zero())
    }

    /// An address guessed wrongly.
    pub fn note_wrong(&mut self, address: IpAddr, now: Instant) {
        let memory = self.limits.guess_memory;
        self.by_address.retain(|_, known| now.saturating_duration_since(known.last) < memory);
        let address = guesser(address);
        if self.by_address.len() >= self.limits.guessers_max && !self.by_address.contains_key(&address) {
            let oldest = self.by_address.iter().min_by_key(|(_, known)| known.last).map(|(one, _)| *one);
            oldest.and_then(|oldest| self.by_address.remove(&oldest));
        }
        let known = self.by_address.entry(address).or_insert(Guesser { wrong: 0, last: now, free: now });
        let factor = 2_u32.saturating_pow(known.wrong);
        let pause = self.limits.guess_pause_min.saturating_mul(factor).min(self.limits.guess_pause_max);
        *known = Guesser { wrong: known.wrong.saturating_add(1), last: now, free: now + pause };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::LIMITS;

    #[test]
    fn each_wrong_guess_costs_twice_the_time_up_to_the_limit() {
        let (mut guesses, start) = (Guesses::new(LIMITS), Instant::now());
        let (who, other) = (IpAddr::from([192, 168, 0, 7]), IpAddr::from([192, 168, 0, 8]));
        assert_eq!(guesses.pause(who, start), None);
        let pauses: Vec<u64> = (0..9)
            .map(|_| {
                guesses.note_wrong(who, start);
                guesses.pause(who, start).unwrap().as_secs()
            })
            .collect();
        assert_eq!(pauses, [1, 2, 4, 8, 16, 32, 60, 60, 60]);
        assert_eq!(guesses.pause(who, start + LIMITS.guess_pause_max), None, "the pause is over");
        assert_eq!(guesses.pause(other, start), None, "nobody waits for another");
    }

    #[test]
    fn who_has_not_guessed_for_long_begins_anew() {
        let (mut guesses, start) = (Guesses::new(LIMITS), Instant::now());
        let who = IpAddr::from([10, 0, 0, 1]);
        (0..5).for_each(|_| guesses.note_wrong(who, start));
        guesses.note_wrong(who, start + LIMITS.guess_memory);
        assert_eq!(guesses.pause(who, start + LIMITS.guess_memory), Some(LIMITS.guess_pause_min));
    }

    #[test]
    fn one_machine_is_one_guesser_under_all_its_addresses() {
        let (mut guesses, now) = (Guesses::new(LIMITS), Instant::now());
        guesses.note_wrong("2001:db8:1:2::1".parse().unwrap(), now);
        assert!(guesses.pause("2001:db8:1:2:ffff::9".parse().unwrap(), now).is_some());
        assert!(guesses.pause("2001:db8:1:3::1".parse().unwrap(), now).is_none());
        guesses.note_wrong("::ffff:10.0.0.1".parse().unwrap(), now);
        assert!(guesses.pause("10.0.0.1".parse().unwrap(), now).is_some());
    }

    #[test]
    fn no_more_guessers_are_remembered_than_the_limit() {
        let (mut guesses, start) = (Guesses::new(LIMITS), Instant::now());
        let address = |number: usize| IpAddr::from([10, 0, (number / 256) as u8, number as u8]);
        for number in 0..LIMITS.guessers_max + 3 {
            guesses.note_wrong(address(number), start + Duration::from_micros(number as u64));
        }
        assert_eq!(guesses.by_address.len(), LIMITS.guessers_max);
        assert!(guesses.pause(address(2), start).is_none(), "the oldest are forgotten");
        assert!(guesses.pause(address(3), start).is_some());
    }
}
