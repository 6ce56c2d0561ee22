//! Decides if the pointer is active. Pointer and bar appear when the pointer moves. They disappear after a pause, or at
//! once when the window enters full screen.

use std::time::{Duration, Instant};

use mariana_commands::input::{Input, TouchPhase};

/// Time after which a resting pointer and the bar disappear.
const STAYS: Duration = Duration::from_millis(2_500);
/// Minimum movement in pixels that counts. Smaller movements may come from a shaking table.
const MOVED_MIN: f64 = 2.0;

/// The position and time of the last movement.
#[derive(Debug, Default)]
pub struct PointerRest {
    place: Option<[f64; 2]>,
    moved: Option<Instant>,
}

impl PointerRest {
    /// Handles an event of the window.
    pub fn handle(&mut self, input: &Input, now: Instant) {
        match input {
            Input::PointerMoved(position) => {
                let moved = self
                    .place
                    .is_some_and(|place| (place[0] - position[0]).hypot(place[1] - position[1]) >= MOVED_MIN);
                if moved {
                    self.moved = Some(now);
                }
                // The first position is no movement, because the window may open below the pointer.
                if moved || self.place.is_none() {
                    self.place = Some(*position);
                }
            }
            Input::PointerLeft => self.sleep(),
            Input::PointerButton { .. } | Input::Wheel(_) => self.moved = Some(now),
            Input::Touch { phase: TouchPhase::Started, .. } => self.moved = Some(now),
            _ => {}
        }
    }

    /// Acts as if the pointer had moved.
    pub fn wake(&mut self, now: Instant) {
        self.moved = Some(now);
    }

    /// Hides the pointer until it moves.
    pub fn sleep(&mut self) {
        self.moved = None;
    }

    /// True if the pointer has moved lately. `busy` means that the user is using the bar, and keeps the pointer awake.
    pub fn is_awake(&mut self, busy: bool, now: Instant) -> bool {
        if busy && self.moved.is_some() {
            self.moved = Some(now);
        }
        self.falls_asleep().is_some_and(|at| at > now)
    }

    /// The time at which the pointer will disappear if it does not move.
    pub fn falls_asleep(&self) -> Option<Instant> {
        self.moved.map(|moved| moved + STAYS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn to(x: f64, y: f64) -> Input {
        Input::PointerMoved([x, y])
    }

    #[test]
    fn a_pointer_that_moves_wakes_and_one_that_rests_sleeps() {
        let (mut rest, start) = (PointerRest::default(), Instant::now());
        let at = |ms| start + Duration::from_millis(ms);
        rest.handle(&to(10.0, 10.0), start);
        assert!(!rest.is_awake(false, start), "the window opened below it");
        rest.handle(&to(11.0, 10.0), start);
        assert!(!rest.is_awake(false, start), "the table shook");
        rest.handle(&to(14.0, 10.0), start);
        assert!(rest.is_awake(false, at(2_499)) && !rest.is_awake(false, at(2_500)));
        rest.handle(&to(20.0, 10.0), at(3_000));
        assert!(rest.is_awake(true, at(5_000)) && rest.is_awake(false, at(7_400)));
        assert!(!rest.is_awake(false, at(7_501)));
    }

    #[test]
    fn in_full_screen_it_rests_at_once() {
        let (mut rest, now) = (PointerRest::default(), Instant::now());
        rest.handle(&to(10.0, 10.0), now);
        rest.handle(&to(20.0, 10.0), now);
        rest.sleep();
        assert!(!rest.is_awake(true, now));
        rest.handle(&Input::PointerLeft, now);
        assert_eq!(rest.falls_asleep(), None);
        rest.handle(&to(30.0, 10.0), now);
        assert!(rest.is_awake(false, now));
    }
}
