//! The values of variables on the path that is being executed, and how they came about.

use std::collections::BTreeMap;

use super::layout::Part;

/// The parts of all variables: globals first, then the locals of the calls that are open.
#[derive(Debug, Default)]
pub(super) struct Memory {
    pub parts: Vec<Part>,
    /// Changes: the slot and its earlier value.
    trail: Vec<(u32, Part)>,
}

impl Memory {
    /// The state now, for the methods that compare with it.
    pub(super) fn mark(&self) -> usize {
        self.trail.len()
    }

    pub(super) fn forget_changes(&mut self) {
        self.trail.clear();
    }

    pub(super) fn at(&self, slot: u32) -> Part {
        self.parts.get(slot as usize).copied().unwrap_or(Part::Int(0))
    }

    pub(super) fn read(&self, slots: std::ops::Range<usize>) -> Vec<Part> {
        self.parts.get(slots).unwrap_or_default().to_vec()
    }

    pub(super) fn store_part(&mut self, slot: u32, part: Part) {
        if let Some(place) = self.parts.get_mut(slot as usize)
            && *place != part
        {
            self.trail.push((slot, *place));
            *place = part;
        }
    }

    /// Restores the state at a mark.
    pub(super) fn undo(&mut self, mark: usize) {
        while self.trail.len() > mark {
            if let Some((slot, part)) = self.trail.pop()
                && let Some(place) = self.parts.get_mut(slot as usize)
            {
                *place = part;
            }
        }
    }

    /// The slots that changed since a mark, with their values at the mark.
    pub(super) fn changes(&self, mark: usize) -> BTreeMap<u32, Part> {
        let mut changes = BTreeMap::new();
        for (slot, part) in self.trail.get(mark..).unwrap_or_default() {
            if (*slot as usize) < self.parts.len() {
                changes.entry(*slot).or_insert(*part);
            }
        }
        changes
    }

    /// The slots that changed since a mark, with their values now. Restores the state at the mark.
    pub(super) fn rewind_changes(&mut self, mark: usize) -> BTreeMap<u32, Part> {
        let mut changes = self.changes(mark);
        for (slot, part) in &mut changes {
            *part = self.at(*slot);
        }
        self.undo(mark);
        changes
    }

    pub(super) fn apply(&mut self, changed: BTreeMap<u32, Part>) {
        for (slot, part) in changed {
            self.store_part(slot, part);
        }
    }

    /// Keeps one change of each slot since a mark.
    pub(super) fn compact(&mut self, mark: usize) {
        let changes = self.changes(mark);
        self.trail.truncate(mark);
        self.trail.extend(changes);
    }
}
