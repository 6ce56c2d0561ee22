//! From a key of the editor to the next picture: that picture waits a moment for the changed text.
//!
//! A picture that is begun while the text is read shows the old text, and takes the processors that read the new one on
//! a software renderer. So the wait makes edits show one picture earlier, and costs the show less than a picture.

use std::time::{Duration, Instant};

/// How long a picture waits for a text. Most scenes are read in half of it.
const PATIENCE: Duration = Duration::from_millis(20);
/// A text that took longer than this is not waited for the next time. Drawing beside it may have doubled its time.
const SLOW: Duration = Duration::from_millis(60);

/// What is known of the text that is being read.
#[derive(Debug, Default)]
pub(super) struct AwaitedEdit {
    /// When it was asked for; none if nothing is awaited.
    since: Option<Instant>,
    /// Whether the last one took long.
    is_slow: bool,
}

impl AwaitedEdit {
    /// Notes that a changed text is being read.
    pub(super) fn ask(&mut self, now: Instant) {
        self.since = Some(now);
    }

    /// Notes a text that was read in so much time.
    pub(super) fn note_loaded(&mut self, took: Duration) {
        self.since = None;
        self.is_slow = took > SLOW;
    }

    /// Until when the next picture waits, if it does at `now`.
    pub(super) fn until(&self, now: Instant) -> Option<Instant> {
        self.since.filter(|_| !self.is_slow).map(|since| since + PATIENCE).filter(|until| *until > now)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_waits_for_a_text_that_is_read_soon_and_for_no_other() {
        let start = Instant::now();
        let at = |ms| start + Duration::from_millis(ms);
        let mut edit = AwaitedEdit::default();
        assert_eq!(edit.until(start), None);
        edit.ask(start);
        assert_eq!(edit.until(at(3)), Some(at(20)));
        assert_eq!(edit.until(at(20)), None, "the show goes on");
        edit.note_loaded(Duration::from_millis(9));
        assert_eq!(edit.until(at(9)), None, "it is there");
        edit.ask(at(100));
        edit.note_loaded(Duration::from_millis(300));
        edit.ask(at(500));
        assert_eq!(edit.until(at(501)), None, "it would wait in vain");
        edit.note_loaded(Duration::from_millis(10));
        edit.ask(at(600));
        assert_eq!(edit.until(at(601)), Some(at(620)), "it has become shorter");
    }
}
