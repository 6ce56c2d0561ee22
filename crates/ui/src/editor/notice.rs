//! The answer to the last key, which stays for a moment.

use std::time::{Duration, Instant};

use crate::clock;

/// How long an answer to a key stays.
const STAYS: Duration = Duration::from_secs(6);

/// See the module.
#[derive(Default)]
pub(crate) struct Notice {
    said: Option<(String, Instant)>,
}

impl Notice {
    pub(super) fn say(&mut self, words: String) {
        self.said = Some((words, clock::now()));
    }

    pub(super) fn clear(&mut self) {
        self.said = None;
    }

    /// Lets it go when its time is over. Returns whether it went.
    pub(super) fn update(&mut self) -> bool {
        let goes = self.said.as_ref().is_some_and(|(_, since)| clock::since(*since) > STAYS);
        if goes {
            self.said = None;
        }
        goes
    }

    /// Its words.
    pub(crate) fn words(&self) -> Option<&str> {
        self.said.as_ref().map(|(words, _)| words.as_str())
    }

    /// When it goes.
    pub(crate) fn goes_at(&self) -> Option<Instant> {
        self.said.as_ref().map(|(_, since)| *since + STAYS)
    }
}
