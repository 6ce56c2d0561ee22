//! Delays the next frame until an edited text is loaded. A frame that begins while the text is being read would show
//! the old text, and a software renderer would slow down the loader. The delay is shorter than a frame, and edits
//! appear one frame earlier.

use std::time::{Duration, Instant};

/// Maximum delay of a frame. Most texts are read in half of this time.
const PATIENCE: Duration = Duration::from_millis(20);
/// After a load slower than this, frames do not wait. The limit is generous, because drawing may double the load time.
const SLOW: Duration = Duration::from_millis(60);

#[derive(Debug, Default)]
pub(super) struct AwaitedEdit {
    since: Option<Instant>,
    is_slow: bool,
}

impl AwaitedEdit {
    pub(super) fn start(&mut self, now: Instant) {
        self.since = Some(now);
    }

    pub(super) fn record_loaded(&mut self, took: Duration) {
        self.since = None;
        self.is_slow = took > SLOW;
    }

    pub(super) fn until(&self, now: Instant) -> Option<Instant> {
        self.since.filter(|_| !self.is_slow).map(|since| since + PATIENCE).filter(|until| *until > now)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_waits_only_for_a_text_that_loads_fast() {
        let start = Instant::now();
        let at = |ms| start + Duration::from_millis(ms);
        let mut edit = AwaitedEdit::default();
        assert_eq!(edit.until(start), None);
        edit.start(start);
        assert_eq!(edit.until(at(3)), Some(at(20)));
        assert_eq!(edit.until(at(20)), None, "the wait is over");
        edit.record_loaded(Duration::from_millis(9));
        assert_eq!(edit.until(at(9)), None, "already loaded");
        edit.start(at(100));
        edit.record_loaded(Duration::from_millis(300));
        edit.start(at(500));
        assert_eq!(edit.until(at(501)), None, "the last load was slow");
        edit.record_loaded(Duration::from_millis(10));
        edit.start(at(600));
        assert_eq!(edit.until(at(601)), Some(at(620)), "loads are fast again");
    }
}
