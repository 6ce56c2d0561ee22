//! A short message of the editor that disappears after a moment.

use std::time::{Duration, Instant};

use crate::clock;

const STAYS: Duration = Duration::from_secs(6);

#[derive(Default)]
pub(crate) struct Notice {
    said: Option<(String, Instant)>,
}

impl Notice {
    pub(super) fn show(&mut self, words: String) {
        self.said = Some((words, clock::now()));
    }

    pub(super) fn clear(&mut self) {
        self.said = None;
    }

    fn said(&self) -> Option<&(String, Instant)> {
        self.said.as_ref().filter(|(_, since)| clock::since(*since) < STAYS)
    }

    pub(crate) fn words(&self) -> Option<&str> {
        self.said().map(|(words, _)| words.as_str())
    }

    pub(crate) fn goes_at(&self) -> Option<Instant> {
        self.said().map(|(_, since)| *since + STAYS)
    }
}
