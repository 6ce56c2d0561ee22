//! Earlier states of a list, so that edits can be undone. The states share their entries, so a state of 10,000 tracks
//! takes 160 KB.

use std::collections::{HashSet, VecDeque};
use std::sync::Arc;

use super::{Playlist, Slot};
use crate::limits::LIMITS;
use crate::listed::Edited;

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
        while self.steps.len() > LIMITS.undo_steps_max
            || self.steps.len() > 1 && entries(&self.steps) > LIMITS.undo_entries_max
        {
            self.steps.pop_front();
        }
    }
}

impl Playlist {
    /// Keeps the present state, before an edit during entry `playing`.
    pub(super) fn record_undo(&mut self, edit: String, playing: u64) {
        let (slots, sequence) = (self.slots.clone(), self.order.sequence());
        self.history.push(Step { edit: edit.into(), slots, sequence, playing });
    }

    pub(super) fn undo(&mut self, playing: u64) -> Edited {
        let Some(step) = self.history.steps.pop_back() else { return Edited::default() };
        let was_there = self.index(playing).is_some();
        let before: HashSet<u64> = self.ids().collect();
        self.slots = step.slots;
        self.places.clear();
        self.update_places(0);
        self.order.restore(step.sequence, self.slots.iter().map(|slot| slot.id));
        let stays = was_there && self.index(playing).is_some();
        self.resume_with = (!stays).then_some(step.playing);
        self.publish_listing();
        Edited {
            appended: self.slots.iter().any(|slot| !before.contains(&slot.id)),
            removed: before.into_iter().filter(|id| self.index(*id).is_none()).collect(),
            resume: !stays,
        }
    }
}
