//! Hands from outside: what devices and networks wish for, and what the show tells them.
//!
//! Everything that a hand can do stands in one table ([`deeds`]). What hands wish for comes in by [`Wishes`], the newest
//! value of each parameter; the show takes it once for each picture.

pub(super) mod deeds;

use std::time::{Duration, Instant};

use mariana_control::{Board, Heard, Wishes};

use super::window_thread::Waker;

/// How often wishes are taken at most: a flood must not keep the show from drawing.
const INTERVAL: Duration = Duration::from_millis(4);

/// See the module.
pub(super) struct Hands {
    wishes: Wishes,
    board: Board,
    /// When wishes may be taken again.
    free: Instant,
}

impl Hands {
    /// Hands that wake the show when they wish for something.
    pub(super) fn new(waker: &Waker) -> Self {
        let waker = waker.clone();
        let wishes = Wishes::new(move || waker.wake());
        Self { wishes, board: Board::default(), free: Instant::now() }
    }

    /// What was wished for, if it is time to look.
    pub(super) fn take(&mut self, now: Instant) -> Option<Heard> {
        if now < self.free || !self.wishes.has_any() {
            return None;
        }
        self.free = now + INTERVAL;
        Some(self.wishes.take())
    }

    /// When wishes that are there can be taken.
    pub(super) fn due(&self) -> Option<Instant> {
        self.wishes.has_any().then_some(self.free)
    }

    /// Counts what nothing here is meant by.
    pub(super) fn note_unknown(&self) {
        self.wishes.refuse(|refusals| refusals.unknown += 1);
    }
}
