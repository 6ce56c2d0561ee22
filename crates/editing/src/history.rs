//! The undo history, and a log of recent changes that maps positions of earlier versions to the present text.

use std::collections::VecDeque;
use std::ops::Range;

use crate::limits;

/// A replaced part of a text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Change {
    /// Byte offset of the part's start.
    pub at: usize,
    /// The old bytes.
    pub removed: Vec<u8>,
    /// The new bytes.
    pub inserted: Vec<u8>,
}

/// Byte offsets of the anchor and the cursor.
pub(crate) type Selection = (usize, usize);

#[derive(Debug, Clone)]
pub(crate) struct Step {
    pub changes: Vec<Change>,
    pub before: Selection,
    pub after: Selection,
    /// Later changes of this kind are merged into this step.
    pub joins: Joins,
}

impl Step {
    fn bytes(&self) -> usize {
        self.changes.iter().map(|change| change.removed.len() + change.inserted.len()).sum()
    }

    fn merge(&mut self, step: Self) {
        self.after = step.after;
        match (self.changes.last_mut(), &step.changes[..], step.joins) {
            (Some(last), [next], Joins::Typing) => last.inserted.extend_from_slice(&next.inserted),
            (Some(last), [next], Joins::Turning) => last.inserted.clone_from(&next.inserted),
            _ => self.changes.extend(step.changes),
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Joins {
    Nothing,
    Typing,
    Deleting,
    Turning,
}

#[derive(Debug, Clone, Default)]
pub(crate) struct History {
    done: VecDeque<Step>,
    undone: Vec<Step>,
    bytes: usize,
}

impl History {
    pub(crate) fn record(&mut self, step: Step) {
        self.undone.clear();
        match self.done.back_mut().filter(|last| last.joins == step.joins && follows(last, &step)) {
            Some(last) => {
                self.bytes -= last.bytes();
                last.merge(step);
                self.bytes += last.bytes();
            }
            None => {
                self.bytes += step.bytes();
                self.done.push_back(step);
            }
        }
        while self.bytes > limits::UNDO_BYTES_MAX && self.done.len() > 1 {
            self.bytes -= self.done.pop_front().map_or(0, |oldest| oldest.bytes());
        }
    }

    /// Closes the last step, so that the next change starts a new step.
    pub(crate) fn close(&mut self) {
        if let Some(last) = self.done.back_mut() {
            last.joins = Joins::Nothing;
        }
    }

    pub(crate) fn undo(&mut self) -> Option<Step> {
        let step = self.done.pop_back()?;
        self.bytes = self.bytes.saturating_sub(step.bytes());
        self.undone.push(step.clone());
        Some(step)
    }

    pub(crate) fn redo(&mut self) -> Option<Step> {
        let mut step = self.undone.pop()?;
        step.joins = Joins::Nothing;
        self.bytes += step.bytes();
        self.done.push_back(step.clone());
        Some(step)
    }

    #[cfg(test)]
    pub(crate) fn len(&self) -> usize {
        self.done.len()
    }
}

fn follows(last: &Step, step: &Step) -> bool {
    let (Some(before), [now]) = (last.changes.last(), &step.changes[..]) else { return false };
    match step.joins {
        Joins::Nothing => false,
        Joins::Typing => now.removed.is_empty() && now.at == before.at + before.inserted.len(),
        Joins::Deleting => now.at + now.removed.len() == before.at || now.at == before.at,
        Joins::Turning => now.at == before.at && now.removed == before.inserted,
    }
}

/// A bounded log of changes. Each change is stored with the version that it produced.
#[derive(Debug, Clone, Default)]
pub(crate) struct Followed {
    /// For each change: the version, the offset, and the numbers of removed and inserted bytes.
    changes: VecDeque<(u64, usize, usize, usize)>,
}

impl Followed {
    pub(crate) fn record(&mut self, version: u64, change: &Change) {
        if self.changes.len() >= limits::FOLLOWED_CHANGES_MAX {
            self.changes.pop_front();
        }
        self.changes.push_back((version, change.at, change.removed.len(), change.inserted.len()));
    }

    /// Maps `range` of version `since` to version `now`; `None` if a change overlaps the range or the log is too short.
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
                return None;
            }
        }
        (start <= end).then_some(start..end)
    }
}
