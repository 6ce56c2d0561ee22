//! Decides when changed files should be read: after writers have finished. Callers pass the present time.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::time::{Duration, Instant};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// A program has opened the file for writing and has not closed the file yet.
    Writing,
    /// The file was closed after writing, replaced or removed.
    Written,
    /// Any other event.
    Touched,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Waits {
    /// Time without events before the files are read.
    pub quiet: Duration,
    /// Maximum delay of a read while events continue, a writer has the file open, or a file is missing.
    pub patience: Duration,
    /// Interval of the checks that need no event, because events are lost if a parent folder was replaced or the file
    /// is on a network.
    pub look: Duration,
    /// Interval of checks on systems without events.
    pub look_blind: Duration,
}

impl Waits {
    pub(super) const USUAL: Self = Self {
        quiet: Duration::from_millis(20),
        patience: Duration::from_millis(400),
        look: Duration::from_secs(2),
        look_blind: Duration::from_millis(200),
    };
}

#[derive(Debug, Default)]
pub(super) struct Changes {
    touched: BTreeSet<PathBuf>,
    writing: BTreeSet<PathBuf>,
    first: Option<Instant>,
    last: Option<Instant>,
}

impl Changes {
    pub(super) fn record(&mut self, file: PathBuf, kind: Kind, now: Instant) {
        match kind {
            Kind::Writing => {
                self.writing.insert(file.clone());
            }
            Kind::Written => {
                self.writing.remove(&file);
            }
            Kind::Touched => {}
        }
        self.touched.insert(file);
        self.first.get_or_insert(now);
        self.last = Some(now);
    }

    /// Returns the time at which to read the files; `None` if nothing has changed.
    pub(super) fn due(&self, waits: &Waits) -> Option<Instant> {
        let latest = self.first? + waits.patience;
        if !self.writing.is_empty() {
            return Some(latest);
        }
        Some(latest.min(self.last? + waits.quiet))
    }

    pub(super) fn drain(&mut self) -> BTreeSet<PathBuf> {
        std::mem::take(self).touched
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WAITS: Waits = Waits::USUAL;

    fn after(changes: &[(u64, Kind)]) -> Option<Duration> {
        let start = Instant::now();
        let mut list = Changes::default();
        for (milliseconds, kind) in changes {
            list.record("file".into(), *kind, start + Duration::from_millis(*milliseconds));
        }
        list.due(&WAITS).map(|due| due - start)
    }

    #[test]
    fn files_are_read_when_they_are_quiet() {
        assert_eq!(after(&[]), None);
        assert_eq!(after(&[(0, Kind::Touched)]), Some(WAITS.quiet));
        let ten = Duration::from_millis(10);
        assert_eq!(after(&[(0, Kind::Touched), (10, Kind::Touched)]), Some(WAITS.quiet + ten));
    }

    #[test]
    fn open_writers_delay_reading_but_not_for_ever() {
        assert_eq!(after(&[(0, Kind::Writing)]), Some(WAITS.patience));
        assert_eq!(after(&[(0, Kind::Writing), (10, Kind::Touched)]), Some(WAITS.patience));
        let hundred = Duration::from_millis(100);
        assert_eq!(after(&[(0, Kind::Writing), (100, Kind::Written)]), Some(WAITS.quiet + hundred));
        let endless: Vec<(u64, Kind)> = (0..1000).map(|i| (i, Kind::Touched)).collect();
        assert_eq!(after(&endless), Some(WAITS.patience));
    }

    #[test]
    fn taken_changes_are_cleared() {
        let mut list = Changes::default();
        list.record("a".into(), Kind::Writing, Instant::now());
        list.record("b".into(), Kind::Touched, Instant::now());
        assert_eq!(list.drain(), ["a".into(), "b".into()].into());
        assert_eq!(list.due(&WAITS), None);
        assert_eq!(list.drain(), [].into());
    }
}
