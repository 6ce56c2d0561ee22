//! Moving, removing and appending entries while the list plays.

use std::collections::{HashSet, VecDeque};
use std::path::PathBuf;
use std::sync::Arc;

use super::gather::{PlaylistEntry, gather};
use super::{Playlist, PlaylistError, Slot};
use crate::limits;
use crate::listed::Edited;

impl Playlist {
    /// Appends entries to the list, but not to the playing order. Returns the index of the first added entry.
    pub(super) fn append_entries(&mut self, entries: Vec<PlaylistEntry>) -> usize {
        let first = self.slots.len();
        for entry in entries {
            let (id, listed) = (self.next_id, entry.listed());
            self.next_id += 1;
            self.slots.push(Arc::new(Slot { id, entry, listed }));
        }
        first
    }

    pub(super) fn publish_listing(&self) {
        let entries = self.slots.iter().map(|slot| (slot.id, slot.listed.clone()));
        self.listing.publish(entries, self.history.last());
    }

    pub(super) fn move_entry(&mut self, from: usize, to: usize, playing: u64) -> Edited {
        if from != to && from.max(to) < self.slots.len() {
            self.record_undo(format!("move {}", self.name_at(from)), playing);
            let beside = self.slots.get(to).map(|slot| slot.id);
            let slot = self.slots.remove(from);
            if let Some(beside) = beside {
                self.order.move_to(slot.id, beside, to > from);
            }
            self.slots.insert(to, slot);
            self.publish_listing();
        }
        Edited::default()
    }

    pub(super) fn remove(&mut self, index: usize, playing: u64) -> Edited {
        if index >= self.slots.len() {
            return Edited::default();
        }
        self.record_undo(format!("remove {}", self.name_at(index)), playing);
        let id = self.slots.remove(index).id;
        self.reported.remove(&id);
        self.order.remove(id);
        self.publish_listing();
        Edited { removed: vec![id], ..Edited::default() }
    }

    pub(super) fn append(&mut self, paths: &[PathBuf], playing: u64, tell: &mut dyn FnMut(String)) -> Edited {
        let mut gathered = gather(paths);
        gathered.track_errors.iter().for_each(|trouble| tell(trouble.to_string()));
        let limit = limits::PLAYLIST_TRACKS_MAX;
        let room = limit.saturating_sub(self.slots.len());
        if gathered.entries.len() > room {
            gathered.entries.truncate(room);
            tell(PlaylistError::too_many("tracks", limit).to_string());
        }
        if gathered.entries.is_empty() {
            return Edited::default();
        }
        self.record_undo(added_in_words(gathered.entries.len()), playing);
        let first = self.append_entries(gathered.entries);
        let added: Vec<u64> = self.slots.iter().skip(first).map(|slot| slot.id).collect();
        self.order.append(added.into_iter(), playing);
        self.publish_listing();
        Edited { removed: Vec::new(), appended: true, resume: self.index(playing).is_none() }
    }

    pub(super) fn clear(&mut self, playing: u64) -> Edited {
        if self.slots.is_empty() {
            return Edited::default();
        }
        self.record_undo("clear the list".to_owned(), playing);
        let removed = self.ids().collect();
        self.slots.clear();
        self.reported.clear();
        self.order = self.order.of(std::iter::empty());
        self.publish_listing();
        Edited { removed, ..Edited::default() }
    }

    fn name_at(&self, index: usize) -> &str {
        self.slots.get(index).map_or("", |slot| &slot.listed.name)
    }

    /// Keeps the present state, before an edit during entry `playing`.
    pub(super) fn record_undo(&mut self, edit: String, playing: u64) {
        let (slots, sequence) = (self.slots.clone(), self.order.sequence());
        self.history.push(Step { edit: edit.into(), slots, sequence, playing });
    }

    pub(super) fn undo(&mut self, playing: u64) -> Edited {
        let Some(step) = self.history.steps.pop_back() else { return Edited::default() };
        let before: HashSet<u64> = self.ids().collect();
        self.slots = step.slots;
        let now: HashSet<u64> = self.ids().collect();
        let (sequence, shuffled) = step.sequence;
        self.order.restore(sequence, shuffled, self.ids());
        let stays = before.contains(&playing) && now.contains(&playing);
        self.resume_with = (!stays).then_some(step.playing);
        self.publish_listing();
        Edited {
            appended: !now.is_subset(&before),
            removed: before.difference(&now).copied().collect(),
            resume: !stays,
        }
    }
}

fn added_in_words(count: usize) -> String {
    if count == 1 { "add a track".to_owned() } else { format!("add {count} tracks") }
}

// Earlier states of a list, so that edits can be undone. The states share their entries, so a state of 10,000 tracks
// takes 160 KB.

#[derive(Default)]
pub(super) struct History {
    steps: VecDeque<Step>,
}

struct Step {
    /// The edit that followed, such as "remove Intro".
    edit: Arc<str>,
    slots: Vec<Arc<Slot>>,
    sequence: (Vec<u64>, bool),
    /// The entry that played.
    playing: u64,
}

impl History {
    pub(super) fn last(&self) -> Option<Arc<str>> {
        self.steps.back().map(|step| step.edit.clone())
    }

    /// Adds a state. Forgets the oldest states beyond the limits.
    fn push(&mut self, step: Step) {
        self.steps.push_back(step);
        let entries = |steps: &VecDeque<Step>| steps.iter().map(|step| step.slots.len()).sum::<usize>();
        while self.steps.len() > limits::UNDO_STEPS_MAX
            || self.steps.len() > 1 && entries(&self.steps) > limits::UNDO_ENTRIES_MAX
        {
            self.steps.pop_front();
        }
    }
}

#[cfg(test)]
#[path = "editing_tests.rs"]
mod tests;
