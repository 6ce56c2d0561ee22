//! What was done to a text, so that it can be undone, and so that places of earlier versions are found again.

use std::ops::Range;

use crate::limits::LIMITS;

/// A part of a text that was replaced.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Change {
    /// Where it begins.
    pub at: usize,
    /// What stood there.
    pub removed: Vec<u8>,
    /// What stands there now.
    pub inserted: Vec<u8>,
}

/// What is selected: from the anchor to the cursor.
pub(crate) type Selection = (usize, usize);

/// Changes that are undone together.
#[derive(Debug, Clone)]
pub(crate) struct Step {
    pub changes: Vec<Change>,
    pub before: Selection,
    pub after: Selection,
    /// What may still be added to it.
    pub joins: Joins,
}

impl Step {
    fn bytes(&self) -> usize {
        self.changes.iter().map(|change| change.removed.len() + change.inserted.len()).sum()
    }

    /// Goes on with a step that follows.
    fn take(&mut self, step: Self) {
        self.after = step.after;
        match (self.changes.last_mut(), &step.changes[..], step.joins) {
            (Some(last), [next], Joins::Typing) => last.inserted.extend_from_slice(&next.inserted),
            (Some(last), [next], Joins::Turning) => last.inserted.clone_from(&next.inserted),
            _ => self.changes.extend(step.changes),
        }
    }
}

/// What is added to the last step instead of being one of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Joins {
    Nothing,
    /// Letters that are typed one after the other.
    Typing,
    /// Letters that are taken away one after the other.
    Deleting,
    /// The same number while it is turned.
    Turning,
}

/// Steps that can be undone, and those that can be done again.
#[derive(Debug, Clone, Default)]
pub(crate) struct History {
    done: Vec<Step>,
    undone: Vec<Step>,
    bytes: usize,
}

impl History {
    pub(crate) fn note(&mut self, step: Step) {
        self.undone.clear();
        match self.done.last_mut().filter(|last| last.joins == step.joins && follows(last, &step)) {
            Some(last) => {
                self.bytes -= last.bytes();
                last.take(step);
                self.bytes += last.bytes();
            }
            None => {
                self.bytes += step.bytes();
                self.done.push(step);
            }
        }
        self.forget_the_oldest();
    }

    fn forget_the_oldest(&mut self) {
        let mut gone = 0;
        while self.bytes > LIMITS.undo_bytes_max && gone + 1 < self.done.len() {
            self.bytes = self.bytes.saturating_sub(self.done.get(gone).map_or(0, Step::bytes));
            gone += 1;
        }
        self.done.drain(..gone);
    }

    /// Closes the last step: what follows is undone by itself.
    pub(crate) fn close(&mut self) {
        if let Some(last) = self.done.last_mut() {
            last.joins = Joins::Nothing;
        }
    }

    pub(crate) fn undo(&mut self) -> Option<Step> {
        let step = self.done.pop()?;
        self.bytes = self.bytes.saturating_sub(step.bytes());
        self.undone.push(step.clone());
        Some(step)
    }

    pub(crate) fn redo(&mut self) -> Option<Step> {
        let mut step = self.undone.pop()?;
        step.joins = Joins::Nothing;
        self.bytes += step.bytes();
        self.done.push(step.clone());
        Some(step)
    }

    #[cfg(test)]
    pub(crate) fn len(&self) -> usize {
        self.done.len()
    }
}

/// Whether a step goes on where the last one ended.
fn follows(last: &Step, step: &Step) -> bool {
    let (Some(before), [now]) = (last.changes.last(), &step.changes[..]) else { return false };
    match step.joins {
        Joins::Nothing => false,
        Joins::Typing => now.removed.is_empty() && now.at == before.at + before.inserted.len(),
        Joins::Deleting => now.at + now.removed.len() == before.at || now.at == before.at,
        Joins::Turning => now.at == before.at && now.removed == before.inserted,
    }
}

/// The last changes of a text, by the version that each of them made.
#[derive(Debug, Clone, Default)]
pub(crate) struct Followed {
    /// Where, how many bytes were removed, and how many inserted.
    changes: std::collections::VecDeque<(u64, usize, usize, usize)>,
}

impl Followed {
    pub(crate) fn note(&mut self, version: u64, change: &Change) {
        if self.changes.len() >= LIMITS.followed_changes_max {
            self.changes.pop_front();
        }
        self.changes.push_back((version, change.at, change.removed.len(), change.inserted.len()));
    }

    /// Where a part of the text of an earlier version stands now; none if it has gone or nobody knows.
    pub(crate) fn place(&self, since: u64, now: u64, range: Range<usize>) -> Option<Range<usize>> {
        let Range { mut start, mut end } = range;
        if since < now && self.changes.front().is_none_or(|(first, ..)| *first > since + 1) {
            return None;
        }
        for &(version, at, removed, inserted) in &self.changes {
            if version <= since {
                continue;
            }
            let moved = |place: usize| (place + inserted).saturating_sub(removed);
            if at + removed <= start {
                (start, end) = (moved(start), moved(end));
            } else if at >= start && at + removed <= end {
                end = moved(end);
            } else if at < end {
                // It reaches into what was replaced.
                return None;
            }
        }
        (start <= end).then_some(start..end)
    }
}
