//! Which entry of a list follows which: in the list's order or a random one, once or repeatedly.

use std::hash::{BuildHasher, Hasher, RandomState};

use crate::track::Repeat;

/// An order of the entries `0..count`.
#[derive(Debug, Clone)]
pub(super) struct Order {
    /// Every entry once.
    sequence: Vec<usize>,
    /// Where in the sequence each entry stands.
    places: Vec<usize>,
    shuffled: bool,
    repeat: Repeat,
    random: u64,
}

impl Order {
    /// The list's own order, repeated.
    pub(super) fn new(count: usize) -> Self {
        // The standard library seeds its hashers randomly.
        let random = RandomState::new().build_hasher().finish();
        Self {
            sequence: (0..count).collect(),
            places: (0..count).collect(),
            shuffled: false,
            repeat: Repeat::All,
            random,
        }
    }

    /// The same settings for `count` other entries.
    pub(super) fn of(&self, count: usize) -> Self {
        let mut order = Self::new(count);
        order.set(self.repeat, self.shuffled, None);
        order
    }

    /// What comes first.
    pub(super) fn first(&self) -> Option<usize> {
        self.sequence.first().copied()
    }

    /// What follows the last entry.
    pub(super) fn repeat(&self) -> Repeat {
        self.repeat
    }

    /// Sets shuffling and repeating. When the order becomes random, `first` comes first, if it is an entry. Each
    /// round then has the same random order, so that going back leads back.
    pub(super) fn set(&mut self, repeat: Repeat, shuffled: bool, first: Option<usize>) {
        self.repeat = repeat;
        if shuffled == self.shuffled {
            return;
        }
        self.shuffled = shuffled;
        self.sequence = (0..self.sequence.len()).collect();
        if shuffled {
            self.shuffle(first);
        }
        for (place, entry) in self.sequence.iter().enumerate() {
            self.places[*entry] = place;
        }
    }

    fn shuffle(&mut self, first: Option<usize>) {
        // The shuffle of Fisher and Yates.
        for last in (1..self.sequence.len()).rev() {
            let other = self.below(last as u64 + 1) as usize;
            self.sequence.swap(last, other);
        }
        if let Some(place) = self.sequence.iter().position(|entry| Some(*entry) == first) {
            self.sequence.swap(0, place);
        }
    }

    /// The entry after (or before) `entry`; wraps around the ends only if `around`.
    pub(super) fn beside(&self, entry: usize, forward: bool, around: bool) -> Option<usize> {
        let count = self.sequence.len();
        let Some(place) = self.places.get(entry).copied() else { return self.first() };
        let beside = match forward {
            true if place + 1 < count => place + 1,
            true => around.then_some(0)?,
            false if place > 0 => place - 1,
            false => around.then_some(count - 1)?,
        };
        self.sequence.get(beside).copied()
    }

    /// A random number below `end` (SplitMix64; its bias is some 1e-15 here).
    fn below(&mut self, end: u64) -> u64 {
        self.random = self.random.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.random;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (mixed ^ (mixed >> 31)) % end.max(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn round(order: &Order, from: usize) -> Vec<usize> {
        std::iter::successors(Some(from), |entry| order.beside(*entry, true, false)).collect()
    }

    #[test]
    fn the_ends_are_met_where_nothing_repeats() {
        let order = Order::new(3);
        assert_eq!(round(&order, 0), [0, 1, 2]);
        assert_eq!((order.beside(2, true, false), order.beside(2, true, true)), (None, Some(0)));
        assert_eq!((order.beside(0, false, false), order.beside(0, false, true)), (None, Some(2)));
        assert_eq!(Order::new(0).beside(0, true, true), None);
    }

    #[test]
    fn orders_are_random_from_one_run_to_the_next() {
        let shuffled = || {
            let mut order = Order::new(1000);
            order.set(Repeat::All, true, None);
            order.sequence
        };
        assert_ne!(shuffled(), shuffled());
    }

    proptest! {
        #[test]
        fn a_random_order_plays_every_track_once_and_leads_back(count in 1_usize..200, first in 0_usize..200) {
            let first = first % count;
            let mut order = Order::new(count);
            order.set(Repeat::All, true, Some(first));
            let mut played = round(&order, first);
            for pair in played.windows(2) {
                prop_assert_eq!(order.beside(pair[1], false, true), Some(pair[0]));
            }
            played.sort_unstable();
            prop_assert_eq!(played, (0..count).collect::<Vec<_>>());
            order.set(Repeat::All, false, Some(first));
            prop_assert_eq!(round(&order, 0), (0..count).collect::<Vec<_>>());
        }
    }
}
