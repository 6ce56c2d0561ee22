//! What hands wish for between two frames: the newest value of each parameter and knob, and the actions in their order.
//!
//! Threads of devices put wishes in, and the show takes them out once for each frame. However many there are meanwhile,
//! they take no more room than there are different names, and the show is woken once.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use super::deed::Deed;
use super::midi::{KnobMove, Source};
use super::{Hand, Param};
use crate::limits::LIMITS;

/// How far a parameter is turned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Amount {
    /// To a value in its own units.
    Value(f32),
    /// To a share of its range, 0..1.
    Share(f32),
}

impl Amount {
    /// The value that this is of a parameter.
    pub fn of(self, param: &Param<'_>) -> f32 {
        match self {
            Self::Value(value) => param.clamped(value),
            Self::Share(share) => param.value_at(share),
        }
    }

    fn is_number(self) -> bool {
        let (Self::Value(number) | Self::Share(number)) = self;
        number.is_finite()
    }
}

/// A parameter of the scene on the stage that is to be turned.
#[derive(Debug, Clone, PartialEq)]
pub struct ParamWish {
    /// Its name.
    pub name: String,
    /// Where to.
    pub to: Amount,
    /// In which smoothing time, in seconds.
    pub seconds: f32,
    /// Whose hand it is.
    pub hand: Hand,
}

/// What was put in and could not be used, counted since the start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Refusals {
    /// Messages that are broken, too large, or no message at all.
    pub rubbish: u64,
    /// Messages that are sound, but nothing here is meant by them.
    pub unknown: u64,
    /// Values that are not numbers.
    pub not_numbers: u64,
    /// Wishes beyond what one frame takes, and messages for a time that nobody waits for.
    pub too_many: u64,
}

impl Refusals {
    /// All of them.
    pub fn count(self) -> u64 {
        self.rubbish + self.unknown + self.not_numbers + self.too_many
    }
}

/// What was wished for since the last time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Heard {
    /// The newest wish for each parameter, in the order in which they were first named.
    pub params: Vec<ParamWish>,
    /// Actions in their order.
    pub deeds: Vec<Deed>,
    /// Where each knob that moved is now, in the order in which they first did.
    pub knobs: Vec<KnobMove>,
    /// When the first of all this came.
    pub since: Option<Instant>,
}

impl Heard {
    /// Whether there is nothing.
    pub fn is_empty(&self) -> bool {
        self.params.is_empty() && self.deeds.is_empty() && self.knobs.is_empty()
    }
}

#[derive(Default)]
struct Pending {
    heard: Heard,
    /// The place of each name in [`Heard::params`].
    places: HashMap<String, usize>,
    /// The place of each knob in [`Heard::knobs`].
    knob_places: HashMap<(Arc<str>, Source), usize>,
    messages: u64,
    refusals: Refusals,
    is_woken: bool,
}

/// Where wishes are put in and taken out; copies are the same place.
#[derive(Clone)]
pub struct Wishes {
    pending: Arc<Mutex<Pending>>,
    wake: Arc<dyn Fn() + Send + Sync>,
}

impl Wishes {
    /// A place without wishes. `wake` is called, on the thread that puts one in, when there is one again.
    pub fn new(wake: impl Fn() + Send + Sync + 'static) -> Self {
        Self { pending: Arc::default(), wake: Arc::new(wake) }
    }

    /// Wishes for a parameter. A value that is not a number is refused.
    pub fn turn(&self, wish: ParamWish) {
        self.put(|pending| {
            if !wish.to.is_number() || !wish.seconds.is_finite() {
                pending.refusals.not_numbers += 1;
                return;
            }
            if let Some(known) =
                pending.places.get(&wish.name).and_then(|place| pending.heard.params.get_mut(*place))
            {
                *known = wish;
            } else if pending.heard.params.len() < LIMITS.wished_params_max
                && wish.name.len() <= LIMITS.name_bytes_max
            {
                pending.places.insert(wish.name.clone(), pending.heard.params.len());
                pending.heard.params.push(wish);
            } else {
                pending.refusals.too_many += 1;
            }
        });
    }

    /// Wishes for an action. Of a level, the newest value counts.
    pub fn act(&self, deed: Deed) {
        self.put(|pending| {
            let deeds = &mut pending.heard.deeds;
            if let Some(last) =
                deeds.last_mut().filter(|last| last.name == deed.name && is_newer(last, &deed))
            {
                *last = deed;
            } else if deeds.len() < LIMITS.wished_deeds_max {
                deeds.push(deed);
            } else {
                pending.refusals.too_many += 1;
            }
        });
    }

    /// Takes notice of a knob that moved.
    pub fn moved(&self, knob: KnobMove) {
        self.put(|pending| {
            let (knobs, name) = (&mut pending.heard.knobs, (knob.device.clone(), knob.source));
            if let Some(known) = pending.knob_places.get(&name).and_then(|place| knobs.get_mut(*place)) {
                known.go_on(&knob);
            } else if knobs.len() < LIMITS.moved_knobs_max {
                pending.knob_places.insert(name, knobs.len());
                knobs.push(knob);
            } else {
                pending.refusals.too_many += 1;
            }
        });
    }

    /// Counts a message that came in.
    pub fn count(&self) {
        self.lock().messages += 1;
    }

    /// Counts what could not be used.
    pub fn refuse(&self, count: impl FnOnce(&mut Refusals)) {
        count(&mut self.lock().refusals);
    }

    /// Takes out what there is.
    pub fn take(&self) -> Heard {
        let mut pending = self.lock();
        pending.is_woken = false;
        pending.places.clear();
        pending.knob_places.clear();
        std::mem::take(&mut pending.heard)
    }

    /// Whether there is something to take out.
    pub fn has_any(&self) -> bool {
        !self.lock().heard.is_empty()
    }

    /// How many messages came in since the start, and what of them could not be used.
    pub fn counts(&self) -> (u64, Refusals) {
        let pending = self.lock();
        (pending.messages, pending.refusals)
    }

    fn put(&self, put: impl FnOnce(&mut Pending)) {
        let is_new = {
            let mut pending = self.lock();
            put(&mut pending);
            if !pending.heard.is_empty() {
                pending.heard.since.get_or_insert_with(Instant::now);
            }
            !pending.heard.is_empty() && !std::mem::replace(&mut pending.is_woken, true)
        };
        if is_new {
            (self.wake)();
        }
    }

    fn lock(&self) -> MutexGuard<'_, Pending> {
        self.pending.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Whether an action says the same as the one before it, with a newer number.
fn is_newer(last: &Deed, deed: &Deed) -> bool {
    use super::deed::Given::Number;
    matches!((&last.given, &deed.given), (Number(_), Number(_)))
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::super::deed::Given;
    use super::*;

    fn place() -> (Wishes, Arc<AtomicUsize>) {
        let woken = Arc::new(AtomicUsize::new(0));
        let count = woken.clone();
        (Wishes::new(move || _ = count.fetch_add(1, Ordering::Relaxed)), woken)
    }

    fn wish(name: &str, to: f32) -> ParamWish {
        ParamWish { name: name.to_owned(), to: Amount::Value(to), seconds: 0.0, hand: Hand::Osc }
    }

    #[test]
    fn a_flood_is_one_value_for_each_parameter_and_wakes_once() {
        let (wishes, woken) = place();
        for number in 0..100_000 {
            wishes.turn(wish(["size", "glow"][number % 2], number as f32));
        }
        assert_eq!(woken.load(Ordering::Relaxed), 1);
        assert_eq!(wishes.take().params, [wish("size", 99_998.0), wish("glow", 99_999.0)]);
        assert!(wishes.take().is_empty());
        wishes.turn(wish("glow", 1.0));
        assert_eq!((woken.load(Ordering::Relaxed), wishes.take().params.len()), (2, 1));
    }

    #[test]
    fn what_a_frame_cannot_take_is_refused_and_counted() {
        let (wishes, _) = place();
        for number in 0..LIMITS.wished_params_max + 3 {
            wishes.turn(wish(&number.to_string(), 0.0));
        }
        wishes.turn(wish("0", 7.0));
        wishes.turn(wish(&"x".repeat(LIMITS.name_bytes_max + 1), 0.0));
        for _ in 0..LIMITS.wished_deeds_max + 2 {
            wishes.act(Deed { name: "next", given: Given::Nothing });
        }
        wishes.turn(wish("0", f32::NAN));
        wishes.turn(ParamWish { seconds: f32::INFINITY, ..wish("0", 0.0) });
        let refusals = wishes.counts().1;
        assert_eq!((refusals.too_many, refusals.not_numbers, refusals.count()), (6, 2, 8));
        let heard = wishes.take();
        assert_eq!(heard.params.len(), LIMITS.wished_params_max);
        assert_eq!((heard.params[0].to, heard.deeds.len()), (Amount::Value(7.0), LIMITS.wished_deeds_max));
    }

    #[test]
    fn of_a_knob_the_newest_place_counts_and_every_press() {
        let (wishes, woken) = place();
        let knob = |key: u8, value, is_press| {
            KnobMove::to("desk".into(), Source::Note { channel: 0, key }, value, is_press)
        };
        for _ in 0..10_000 {
            wishes.moved(knob(1, 1.0, true));
            wishes.moved(knob(1, 0.0, false));
        }
        assert_eq!(
            wishes.take().knobs,
            [KnobMove { way: [0.0, 1.0], presses: 10_000, ..knob(1, 0.0, false) }]
        );
        assert_eq!(woken.load(Ordering::Relaxed), 1);
        for number in 0..LIMITS.moved_knobs_max + 5 {
            let source = Source::Note { channel: (number >> 8) as u8, key: number as u8 };
            wishes.moved(KnobMove::to("desk".into(), source, 0.0, false));
        }
        assert_eq!((wishes.counts().1.too_many, wishes.take().knobs.len()), (5, LIMITS.moved_knobs_max));
    }

    #[test]
    fn of_a_level_the_newest_value_counts_and_presses_are_kept() {
        let (wishes, _) = place();
        let deed = |name, given| Deed { name, given };
        for level in [0.1, 0.2, 0.9] {
            wishes.act(deed("volume", Given::Number(level)));
        }
        wishes.act(deed("next", Given::Nothing));
        wishes.act(deed("next", Given::Nothing));
        let next = || deed("next", Given::Nothing);
        assert_eq!(wishes.take().deeds, [deed("volume", Given::Number(0.9)), next(), next()]);
    }
}
