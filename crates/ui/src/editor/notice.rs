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

    pub(super) fn update(&mut self) -> bool {
        let goes = self.said.as_ref().is_some_and(|(_, since)| clock::since(*since) > STAYS);
        if goes {
            self.said = None;
        }
        goes
    }

    pub(crate) fn words(&self) -> Option<&str> {
        self.said.as_ref().map(|(words, _)| words.as_str())
    }

    pub(crate) fn goes_at(&self) -> Option<Instant> {
        self.said.as_ref().map(|(_, since)| *since + STAYS)
    }
}
