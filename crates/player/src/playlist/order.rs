//! The order of a list's entries: list order or random order, once or repeated. Entries are identified by their ids. A
//! removed entry leaves a hole in the order, so that its successor is known while the removed entry still plays.

use std::collections::HashSet;
use std::hash::{BuildHasher, RandomState};

use crate::track::Repeat;

#[derive(Debug, Clone, Default)]
pub(super) struct Order {
    /// Every entry once, and the holes.
    sequence: Vec<u64>,
    holes: HashSet<u64>,
    shuffled: bool,
    pub(super) repeat: Repeat,
}

impl Order {
    pub(super) fn new(list: impl Iterator<Item = u64>) -> Self {
        Self { sequence: list.collect(), ..Self::default() }
    }

    pub(super) fn of(&self, list: impl Iterator<Item = u64>) -> Self {
        let mut order = Self::new(list);
        order.repeat = self.repeat;
        if self.shuffled {
            order.shuffle(None);
        }
        order
    }

    /// The entries in the order of playing, without holes, and true if this order is random.
    pub(super) fn sequence(&self) -> (Vec<u64>, bool) {
        let entries = self.sequence.iter().copied().filter(|id| !self.holes.contains(id));
        (entries.collect(), self.shuffled)
    }

    /// Restores an order from [`Self::sequence`]. If the random order was turned on or off since then, the entries of
    /// `list` get a new order.
    pub(super) fn restore(&mut self, sequence: Vec<u64>, shuffled: bool, list: impl Iterator<Item = u64>) {
        let as_before = shuffled == self.shuffled;
        *self = if as_before {
            Self { shuffled, repeat: self.repeat, ..Self::new(sequence.into_iter()) }
        } else {
            self.of(list)
        };
    }

    pub(super) fn first(&self) -> Option<u64> {
        self.sequence.iter().copied().find(|id| !self.holes.contains(id))
    }

    /// Sets the order and the repeat mode. A new random order begins with `first` and stays the same in each round.
    pub(super) fn set(
        &mut self,
        repeat: Repeat,
        shuffled: bool,
        first: Option<u64>,
        list: impl Iterator<Item = u64>,
    ) {
        self.repeat = repeat;
        if shuffled == self.shuffled {
            return;
        }
        self.shuffled = shuffled;
        self.sequence = list.collect();
        self.holes.clear();
        if shuffled {
            self.shuffle(first);
        }
    }

    fn shuffle(&mut self, first: Option<u64>) {
        self.shuffled = true;
        self.shuffle_from(0);
        if let Some(place) = self.sequence.iter().position(|id| Some(*id) == first) {
            self.sequence.swap(0, place);
        }
    }

    fn shuffle_from(&mut self, start: usize) {
        // The standard library seeds its hashers randomly.
        let random = RandomState::new();
        if let Some(rest) = self.sequence.get_mut(start..) {
            rest.sort_by_cached_key(|id| random.hash_one(id));
        }
    }

    /// Appends entries to the list. A random order mixes them into the entries after `playing`.
    pub(super) fn append(&mut self, added: impl Iterator<Item = u64>, playing: u64) {
        let start = self.place(playing).map_or(self.sequence.len(), |place| place + 1);
        self.sequence.extend(added);
        if self.shuffled {
            self.shuffle_from(start);
        }
    }

    pub(super) fn remove(&mut self, id: u64) {
        self.holes.insert(id);
    }

    /// Moves `id` to the place before or after `beside` in the list's order. A random order stays unchanged.
    pub(super) fn move_to(&mut self, id: u64, beside: u64, after: bool) {
        let (Some(from), false) = (self.place(id), self.shuffled || id == beside) else {
            return;
        };
        self.sequence.remove(from);
        let to = self.place(beside).map_or(from, |place| place + usize::from(after));
        self.sequence.insert(to, id);
    }

    /// Returns the entry after (or before) `id`, which may be a hole. Wraps around the ends only if `around` is true.
    pub(super) fn beside(&self, id: u64, forward: bool, around: bool) -> Option<u64> {
        let Some(place) = self.place(id) else { return self.first() };
        let (before, after) = (self.sequence.get(..place)?, self.sequence.get(place + 1..)?);
        // If the list has no other entry, the entry is its own neighbour.
        let (before, after, itself) = (before.iter(), after.iter(), self.sequence.get(place));
        let is_entry = |id: &&u64| !self.holes.contains(*id);
        let found = match (forward, around) {
            (true, false) => after.clone().find(is_entry),
            (true, true) => after.chain(before).chain(itself).find(is_entry),
            (false, false) => before.rev().find(is_entry),
            (false, true) => before.rev().chain(after.rev()).chain(itself).find(is_entry),
        };
        found.copied()
    }

    fn place(&self, id: u64) -> Option<usize> {
        self.sequence.iter().position(|other| *other == id)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn round(order: &Order, from: u64) -> Vec<u64> {
        std::iter::successors(Some(from), |id| order.beside(*id, true, false)).collect()
    }

    #[test]
    fn an_order_without_repeat_has_ends() {
        let order = Order::new(0..3);
        assert_eq!(round(&order, 0), [0, 1, 2]);
        assert_eq!((order.beside(2, true, false), order.beside(2, true, true)), (None, Some(0)));
        assert_eq!((order.beside(0, false, false), order.beside(0, false, true)), (None, Some(2)));
        assert_eq!(Order::new(0..0).beside(0, true, true), None);
        assert_eq!(Order::new(7..8).beside(7, true, true), Some(7));
    }

    #[test]
    fn orders_differ_between_runs() {
        let shuffled = || {
            let mut order = Order::new(0..1000);
            order.set(Repeat::All, true, None, 0..1000);
            order.sequence
        };
        assert_ne!(shuffled(), shuffled());
    }

    #[test]
    fn a_removed_entry_keeps_its_successor() {
        let mut order = Order::new(0..5);
        [2, 3].iter().for_each(|id| order.remove(*id));
        assert_eq!((order.beside(2, true, false), order.beside(2, false, false)), (Some(4), Some(1)));
        assert_eq!(round(&order, 0), [0, 1, 4]);
        // The hole stays at its position when other entries move.
        order.move_to(0, 4, true);
        assert_eq!((order.beside(2, true, false), round(&order, 1)), (Some(4), vec![1, 4, 0]));
        [0, 1, 4].iter().for_each(|id| order.remove(*id));
        assert_eq!((order.beside(2, true, true), order.first()), (None, None));
        order.append(5..6, 2);
        assert_eq!(order.beside(2, true, false), Some(5));
    }

    proptest! {
        #[test]
        fn a_random_order_plays_every_track_once_and_can_go_back(count in 1_u64..200, first in 0_u64..200) {
            let first = first % count;
            let mut order = Order::new(0..count);
            order.set(Repeat::All, true, Some(first), 0..count);
            let mut played = round(&order, first);
            for pair in played.windows(2) {
                prop_assert_eq!(order.beside(pair[1], false, true), Some(pair[0]));
            }
            played.sort_unstable();
            prop_assert_eq!(played, (0..count).collect::<Vec<_>>());
            order.set(Repeat::All, false, Some(first), 0..count);
            prop_assert_eq!(round(&order, 0), (0..count).collect::<Vec<_>>());
        }

        #[test]
        fn appended_entries_come_after_the_playing_one(
            count in 1_u64..50, steps in 0_usize..50, added in 1_u64..50,
        ) {
            let mut order = Order::new(0..count);
            order.set(Repeat::Off, true, None, 0..count);
            let before = round(&order, order.first().unwrap());
            let played = &before[..=steps % before.len()];
            order.append(count..count + added, played[played.len() - 1]);
            let mut after = round(&order, order.first().unwrap());
            prop_assert_eq!(&after[..played.len()], played);
            after.sort_unstable();
            prop_assert_eq!(after, (0..count + added).collect::<Vec<_>>());
        }
    }
}
