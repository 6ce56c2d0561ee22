//! The queue of controller input between two frames: the newest value of each parameter and knob, and the actions in
//! order. Device threads put input in, and the show takes all input out once per frame. Memory is bounded by the
//! number of different names, and the show is woken only once per batch.

use std::sync::{Arc, Mutex};
use std::time::Instant;

use mariana_work::lock;

use super::action::Action;
use super::midi::KnobMove;
use super::{ChangedBy, Param};
use crate::limits;

/// A new value of a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Amount {
    /// A value in the parameter's unit.
    Value(f32),
    /// A fraction of the parameter's range, 0..1.
    Fraction(f32),
}

impl Amount {
    /// Returns the parameter's value.
    pub fn of(self, param: &Param<'_>) -> f32 {
        match self {
            Self::Value(value) => param.clamped(value),
            Self::Fraction(fraction) => param.value_at(fraction),
        }
    }

    /// True if the amount is a finite number.
    pub fn is_number(self) -> bool {
        let (Self::Value(number) | Self::Fraction(number)) = self;
        number.is_finite()
    }
}

/// A change of a parameter of the current scene.
#[derive(Debug, Clone, PartialEq)]
pub struct ParamChange {
    /// The parameter's name.
    pub name: String,
    /// The new value.
    pub to: Amount,
    /// The smoothing time in seconds.
    pub seconds: f32,
    /// The origin of the change.
    pub changed_by: ChangedBy,
}

/// The input since the last frame.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct InputBatch {
    /// The newest change of each parameter, in the order in which the parameters first changed.
    pub params: Vec<ParamChange>,
    /// The actions in order.
    pub actions: Vec<Action>,
    /// The newest value of each knob that moved, in the order in which the knobs first moved.
    pub knobs: Vec<KnobMove>,
    /// The arrival time of the first input.
    pub since: Option<Instant>,
}

impl InputBatch {
    /// True if there is no input.
    pub fn is_empty(&self) -> bool {
        self.params.is_empty() && self.actions.is_empty() && self.knobs.is_empty()
    }
}

#[derive(Default)]
struct Pending {
    batch: InputBatch,
    messages: u64,
    refused: u64,
}

/// A shared queue of controller input. Clones share the contents.
#[derive(Clone)]
pub struct InputQueue {
    pending: Arc<Mutex<Pending>>,
    wake: Arc<dyn Fn() + Send + Sync>,
}

impl InputQueue {
    /// Creates an empty queue. `wake` is called on the sending thread when the empty queue gets input.
    pub fn new(wake: impl Fn() + Send + Sync + 'static) -> Self {
        Self { pending: Arc::default(), wake: Arc::new(wake) }
    }

    /// Queues a parameter change. A value that is not a number is rejected.
    pub fn turn(&self, change: ParamChange) {
        self.put(|pending| {
            if !change.to.is_number() || !change.seconds.is_finite() {
                pending.refused += 1;
                return;
            }
            let params = &mut pending.batch.params;
            if let Some(known) = params.iter_mut().find(|known| known.name == change.name) {
                *known = change;
            } else if params.len() < limits::PENDING_PARAMS_MAX && change.name.len() <= limits::NAME_BYTES_MAX
            {
                params.push(change);
            } else {
                pending.refused += 1;
            }
        });
    }

    /// Queues an action. If the last queued action is the same action with another number, replaces this number.
    pub fn act(&self, action: Action) {
        self.put(|pending| {
            let actions = &mut pending.batch.actions;
            if let Some(last) =
                actions.last_mut().filter(|last| last.name == action.name && is_newer(last, &action))
            {
                *last = action;
            } else if actions.len() < limits::PENDING_ACTIONS_MAX {
                actions.push(action);
            } else {
                pending.refused += 1;
            }
        });
    }

    /// Queues a knob movement.
    pub fn moved(&self, knob: KnobMove) {
        self.put(|pending| {
            let knobs = &mut pending.batch.knobs;
            let is_same = |known: &&mut KnobMove| known.source == knob.source && known.device == knob.device;
            if let Some(known) = knobs.iter_mut().find(is_same) {
                known.merge(&knob);
            } else if knobs.len() < limits::MOVED_KNOBS_MAX {
                knobs.push(knob);
            } else {
                pending.refused += 1;
            }
        });
    }

    /// Counts a message. Call this after its input is queued or rejected, so that a reader of the count finds the input.
    pub fn count(&self) {
        lock(&self.pending).messages += 1;
    }

    /// Counts rejected input: malformed or unknown messages, values that are no numbers, input beyond the limits between
    /// two frames, and messages scheduled too far ahead.
    pub fn refuse(&self, count: u64) {
        lock(&self.pending).refused += count;
    }

    /// Takes the pending input.
    pub fn drain(&self) -> InputBatch {
        std::mem::take(&mut lock(&self.pending).batch)
    }

    /// True if there is pending input.
    pub fn has_any(&self) -> bool {
        !lock(&self.pending).batch.is_empty()
    }

    /// Returns the number of messages since the start, and of rejected input.
    pub fn counts(&self) -> (u64, u64) {
        let pending = lock(&self.pending);
        (pending.messages, pending.refused)
    }

    fn put(&self, put: impl FnOnce(&mut Pending)) {
        let mut pending = lock(&self.pending);
        put(&mut pending);
        let is_first = pending.batch.since.is_none() && !pending.batch.is_empty();
        if is_first {
            pending.batch.since = Some(Instant::now());
        }
        drop(pending);
        if is_first {
            (self.wake)();
        }
    }
}

fn is_newer(last: &Action, action: &Action) -> bool {
    use super::action::ActionValue::Number;
    matches!((&last.given, &action.given), (Number(_), Number(_)))
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::super::action::ActionValue;
    use super::super::midi::Source;
    use super::*;

    fn place() -> (InputQueue, Arc<AtomicUsize>) {
        let woken = Arc::new(AtomicUsize::new(0));
        let count = woken.clone();
        (InputQueue::new(move || _ = count.fetch_add(1, Ordering::Relaxed)), woken)
    }

    fn change(name: &str, to: f32) -> ParamChange {
        ParamChange { name: name.to_owned(), to: Amount::Value(to), seconds: 0.0, changed_by: ChangedBy::Osc }
    }

    #[test]
    fn a_flood_is_one_value_for_each_parameter_and_wakes_once() {
        let (input_queue, woken) = place();
        for number in 0..100_000 {
            input_queue.turn(change(["size", "glow"][number % 2], number as f32));
        }
        assert_eq!(woken.load(Ordering::Relaxed), 1);
        assert_eq!(input_queue.drain().params, [change("size", 99_998.0), change("glow", 99_999.0)]);
        assert!(input_queue.drain().is_empty());
        input_queue.turn(change("glow", 1.0));
        assert_eq!((woken.load(Ordering::Relaxed), input_queue.drain().params.len()), (2, 1));
    }

    #[test]
    fn input_beyond_the_limits_is_rejected_and_counted() {
        let (input_queue, _) = place();
        for number in 0..limits::PENDING_PARAMS_MAX + 3 {
            input_queue.turn(change(&number.to_string(), 0.0));
        }
        input_queue.turn(change("0", 7.0));
        input_queue.turn(change(&"x".repeat(limits::NAME_BYTES_MAX + 1), 0.0));
        for _ in 0..limits::PENDING_ACTIONS_MAX + 2 {
            input_queue.act(Action { name: "next", given: ActionValue::Nothing });
        }
        input_queue.turn(change("0", f32::NAN));
        input_queue.turn(ParamChange { seconds: f32::INFINITY, ..change("0", 0.0) });
        assert_eq!(input_queue.counts().1, 8);
        let batch = input_queue.drain();
        assert_eq!(batch.params.len(), limits::PENDING_PARAMS_MAX);
        assert_eq!(
            (batch.params[0].to, batch.actions.len()),
            (Amount::Value(7.0), limits::PENDING_ACTIONS_MAX)
        );
    }

    #[test]
    fn the_newest_knob_value_and_every_press_are_kept() {
        let (input_queue, woken) = place();
        let knob = |key: u8, value, is_press| {
            KnobMove::to("desk".into(), Source::Note { channel: 0, key }, value, is_press)
        };
        for _ in 0..10_000 {
            input_queue.moved(knob(1, 1.0, true));
            input_queue.moved(knob(1, 0.0, false));
        }
        let steps = [-10_000, -10_000, -630_000];
        let merged = KnobMove { way: [0.0, 1.0], presses: 10_000, steps, ..knob(1, 0.0, false) };
        assert_eq!(input_queue.drain().knobs, [merged]);
        assert_eq!(woken.load(Ordering::Relaxed), 1);
        for number in 0..limits::MOVED_KNOBS_MAX + 5 {
            let source = Source::Note { channel: (number >> 8) as u8, key: number as u8 };
            input_queue.moved(KnobMove::to("desk".into(), source, 0.0, false));
        }
        assert_eq!((input_queue.counts().1, input_queue.drain().knobs.len()), (5, limits::MOVED_KNOBS_MAX));
    }

    #[test]
    fn the_newest_level_and_every_press_are_kept() {
        let (input_queue, _) = place();
        let action = |name, given| Action { name, given };
        for level in [0.1, 0.2, 0.9] {
            input_queue.act(action("volume", ActionValue::Number(level)));
        }
        input_queue.act(action("next", ActionValue::Nothing));
        input_queue.act(action("next", ActionValue::Nothing));
        let next = || action("next", ActionValue::Nothing);
        assert_eq!(input_queue.drain().actions, [action("volume", ActionValue::Number(0.9)), next(), next()]);
    }
}
