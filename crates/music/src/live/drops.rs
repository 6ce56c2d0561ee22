//! Drops in live input: the low frequencies return with full energy after they were withdrawn (Yadati et al. 2014).
//!
//! After a build, the return is reported at once. Without a build, the music must also become much louder and stay so
//! for a second, because a bass that enters in a ballad returns just as suddenly.

use crate::bands::decibels;

/// The duration of the fast levels, in seconds.
const FAST: f64 = 0.3;
/// The fast levels are compared with earlier levels that are at least this old, in seconds.
const APART: f64 = 0.45;
/// Low frequencies are withdrawn if they were quiet for this long, in seconds.
const WITHDRAWN: f64 = 3.5;
/// The level before is the mean over this time, in seconds.
const LEVEL: f64 = 4.0;
/// Music has sounded for this long, in seconds, for at least the fraction. After silence, music only begins.
const SOUNDED: (f64, f32) = (8.0, 0.7);
/// Levels below the loudest level minus this many decibels are silence.
const SILENT_DB: f32 = 30.0;
/// The onset density is measured over this time, in seconds.
const DENSITY: f64 = 6.0;
/// The minimum time between drops, in seconds.
const BETWEEN: f32 = 8.0;
/// A drop without a build is confirmed after this time, in seconds.
const CONFIRMED: f64 = 1.0;
/// After a return with a build, the low frequencies may rise for this long, in seconds.
const RISING: f64 = 0.4;

/// Low frequencies return if they are this much louder than their loudest level before, in decibels.
const RETURN_DB: f32 = 8.0;
/// The same for a drop after a build.
const RETURN_AFTER_BUILD_DB: f32 = 10.0;
/// At a return without a build, everything is at least this much louder than before, in decibels.
const JUMP_DB: f32 = 2.0;
/// A return is at most this far below the loudest level, in decibels.
const LOUD_DB: f32 = 4.0;
/// The same after a build, whose noise may be louder than the drop.
const LOUD_AFTER_BUILD_DB: f32 = 8.0;
/// Low frequencies that return are at most this far below the level of everything, in decibels. The noise of a build
/// has less low frequencies.
const LOW_SHARE_DB: f32 = 7.0;
/// The confirmed differences of the total level and of the low level, in decibels. The bass of a ballad raises the
/// total level by up to 8.5 dB.
const CONFIRMED_JUMP_DB: f32 = 9.0;
const CONFIRMED_RETURN_DB: f32 = 8.0;
/// A confirmed drop is at most this far below the loudest level, in decibels.
const CONFIRMED_LOUD_DB: f32 = 5.0;
/// The minimum sum of the onsets per second before and after a confirmed drop. Ballads have up to 3.8, clubs at least
/// 4.4.
const ONSETS_MIN: f32 = 4.2;

/// The decay of the loudest level, in decibels a second.
const FORGOTTEN_DB: f32 = 0.03;

/// The slots of [`SOUNDED`] are at most 247 at any sample rate.
const SLOTS_MAX: usize = 256;

/// Measurements of a slot.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Slot {
    /// Mean powers of the low frequencies and of all.
    pub(super) low: f32,
    pub(super) total: f32,
    /// The number of onsets.
    pub(super) onsets: f32,
}

/// A return of the low frequencies that is not yet a drop.
#[derive(Clone, Copy)]
struct Return {
    /// Slots since the return.
    age: usize,
    after_build: bool,
    /// Onsets per second.
    onsets_before: f32,
    low_before: f32,
    level_before: f32,
}

pub(super) struct Drops {
    /// The duration of a slot.
    slot_seconds: f64,
    /// Slots, and the fast levels of low frequencies and of all at their ends in decibels. The newest is first.
    slots: [(Slot, [f32; 2]); SLOTS_MAX],
    /// The number of known slots, at most as many as the time of [`SOUNDED`] holds.
    known: usize,
    loudest: f32,
    since: f32,
    pending: Option<Return>,
}

impl Drops {
    pub(super) fn new(slot_seconds: f64) -> Self {
        Self {
            slot_seconds,
            slots: [(Slot::default(), [0.0; 2]); _],
            known: 0,
            loudest: f32::MIN,
            since: BETWEEN,
            pending: None,
        }
    }

    /// Processes a slot. Returns true at a drop.
    pub(super) fn follow(&mut self, slot: Slot, after_build: bool) -> bool {
        let (sounded, seconds) = (self.count(SOUNDED.0), self.slot_seconds as f32);
        self.slots.rotate_right(1);
        self.slots[0].0 = slot;
        let fast = self.levels(0, self.count(FAST));
        self.slots[0].1 = fast;
        self.known = (self.known + 1).min(sounded);
        self.loudest = (self.loudest - FORGOTTEN_DB * seconds).max(fast[1]);
        self.since += seconds;
        if self.since < BETWEEN || self.known < sounded {
            self.pending = None;
            return false;
        }
        let returned = match self.pending {
            Some(pending) => Some(Return { age: pending.age + 1, ..pending }),
            None => self.returned(fast, after_build),
        };
        let is_drop = returned.is_some_and(|returned| self.is_drop(fast[0], &returned));
        self.pending = returned.filter(|returned| !is_drop && returned.age < self.count(CONFIRMED));
        if is_drop {
            self.since = 0.0;
        }
        is_drop
    }

    /// The number of slots of a duration.
    fn count(&self, seconds: f64) -> usize {
        (seconds / self.slot_seconds).round().max(1.0) as usize
    }

    /// The mean levels of low frequencies and of all over `count` slots, the newest of them `first` slots ago.
    fn levels(&self, first: usize, count: usize) -> [f32; 2] {
        let slots = self.slots.iter().skip(first).take(count);
        let (low, total) =
            slots.fold((0.0, 0.0), |(low, total), (slot, _)| (low + slot.low, total + slot.total));
        [low, total].map(|sum| decibels(sum / count as f32))
    }

    fn onsets_per_second(&self, first: usize, count: usize) -> f32 {
        let onsets = self.slots.iter().skip(first).take(count).map(|(slot, _)| slot.onsets).sum::<f32>();
        onsets / (count as f32 * self.slot_seconds as f32)
    }

    fn returned(&self, [low, level]: [f32; 2], after_build: bool) -> Option<Return> {
        let (apart, sounded) = (self.count(APART), self.count(SOUNDED.0));
        let before = |count: usize| self.slots.iter().skip(apart).take(count.saturating_sub(apart));
        let low_before = before(self.count(WITHDRAWN)).map(|(_, [low, _])| *low).fold(f32::MIN, f32::max);
        let [_, level_before] = self.levels(apart, self.count(LEVEL));
        let sounding =
            before(sounded).filter(|(_, [_, level])| *level > self.loudest - SILENT_DB).count() as f32;
        let loud = if after_build {
            self.loudest - LOUD_AFTER_BUILD_DB
        } else {
            (level_before + JUMP_DB).max(self.loudest - LOUD_DB)
        };
        let returns = low >= (low_before + RETURN_DB).max(level - LOW_SHARE_DB)
            && level >= loud
            && sounding >= SOUNDED.1 * (sounded - apart) as f32;
        returns.then(|| Return {
            age: 0,
            after_build,
            onsets_before: self.onsets_per_second(apart, self.count(DENSITY)),
            low_before,
            level_before,
        })
    }

    fn is_drop(&self, low: f32, returned: &Return) -> bool {
        let Return { age, after_build, onsets_before, low_before, level_before } = *returned;
        let confirmed = self.count(CONFIRMED);
        if after_build && age <= self.count(RISING) && low >= low_before + RETURN_AFTER_BUILD_DB {
            return true;
        }
        let [low, level] = self.levels(0, confirmed);
        age >= confirmed
            && low >= low_before + CONFIRMED_RETURN_DB
            && level >= (level_before + CONFIRMED_JUMP_DB).max(self.loudest - CONFIRMED_LOUD_DB)
            && onsets_before + self.onsets_per_second(0, confirmed) >= ONSETS_MIN
    }
}
