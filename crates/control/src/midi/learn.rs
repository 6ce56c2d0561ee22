//! MIDI learn: the user chooses a target and moves a knob, which is then mapped to the target.

use std::sync::Arc;

use super::device::{DECREMENT, INCREMENT};
use super::mapping::{Mapping, Target};
use super::source::{KnobMove, Source};

/// A knob counts as 7-bit if no message with its low bits arrives within this time, in seconds.
const WAITS: f64 = 0.08;
/// A knob with the number of data increments counts as one that sends its position if it does not repeat a value within
/// this time, in seconds.
const WAITS_FOR_STEPS: f64 = 1.0;

/// The state while a control is being learned.
#[derive(Debug, Clone, PartialEq)]
pub struct Learning {
    target: Target,
    /// The device and control that moved first, and the time in seconds.
    moved: Option<(Arc<str>, Source, f64)>,
}

impl Learning {
    /// Starts learning a control for `target`.
    pub fn of(target: Target) -> Self {
        Self { target, moved: None }
    }

    /// Returns the target of the new mapping.
    pub fn target(&self) -> &Target {
        &self.target
    }

    /// Processes a knob movement at `now`, in seconds. Released keys and key pressure are ignored.
    pub fn notice(&mut self, moved: &KnobMove, now: f64) {
        let is_let_go = moved.source.is_pressed() && moved.presses == 0;
        if is_let_go || matches!(moved.source, Source::Pressure { .. }) {
            return;
        }
        let Some((device, known, _)) = &mut self.moved else {
            self.moved = Some((moved.device.clone(), moved.source, now));
            return;
        };
        let is_same_knob = match (*known, moved.source) {
            // The knob that moved has 14 bits: learn the 14-bit control.
            (Source::Control { channel, number }, Source::FineControl { channel: of, number: coarse }) => {
                channel == of && [number, number.wrapping_sub(32)].contains(&coarse)
            }
            // The knob repeats data increments: learn its steps.
            (
                Source::Control { channel, number: INCREMENT | DECREMENT },
                Source::Increment { channel: of },
            ) => channel == of,
            _ => false,
        };
        if is_same_knob && *device == moved.device {
            *known = moved.source;
        }
    }

    /// Returns the time when it is known what the moved knob sends; `None` if no knob has moved.
    pub fn known_at(&self) -> Option<f64> {
        self.moved.as_ref().map(|(_, source, since)| match source {
            Source::Control { number: INCREMENT | DECREMENT, .. } => since + WAITS_FOR_STEPS,
            Source::Control { .. } => since + WAITS,
            _ => *since,
        })
    }

    /// Returns the new mapping once it is known what the knob sends.
    pub fn learned(&self, now: f64) -> Option<Mapping> {
        let (device, source, _) =
            self.moved.as_ref().filter(|_| self.known_at().is_some_and(|at| now >= at))?;
        Some(Mapping::learned(device, *source, self.target.clone()))
    }
}

// Pick-up of knobs: a knob has no effect until it passes the parameter's value, so that the value never jumps.

/// A knob within this distance of the value picks up the parameter. The distance is a fraction of the range, slightly
/// over one 7-bit step.
const NEAR: f32 = 0.012;

/// The state of one mapping. All values are fractions of the range, 0..1.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct PickUp {
    last: Option<f32>,
    /// The value that the knob set last; `None` until the knob picks up the parameter.
    put: Option<f32>,
}

impl PickUp {
    /// Returns true if a knob that moved to `knob` sets a parameter whose value is `stands`. `way` has the smallest and
    /// the largest value of the movement.
    pub(super) fn takes(&mut self, knob: f32, way: [f32; 2], stands: f32) -> bool {
        let has_hold = self.put.is_some_and(|put| (put - stands).abs() <= NEAR);
        let ends = || way.into_iter().chain([knob]).chain(self.last);
        let passes = ends().any(|end| end <= stands) && ends().any(|end| end >= stands);
        self.last = Some(knob);
        let takes = has_hold || passes || (knob - stands).abs() <= NEAR;
        self.put = takes.then_some(knob);
        takes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn learning() -> Learning {
        Learning::of(Target::Action { name: "next".to_owned(), value: None })
    }

    fn moved(source: Source, presses: u32) -> KnobMove {
        KnobMove { presses, ..KnobMove::to("desk".into(), source, 0.5, false) }
    }

    const COARSE: Source = Source::Control { channel: 0, number: 7 };
    const FINE: Source = Source::FineControl { channel: 0, number: 7 };

    #[test]
    fn the_first_moved_knob_is_learned_once_its_resolution_is_known() {
        let mut learning = learning();
        assert_eq!(learning.learned(9.0), None);
        learning.notice(&moved(COARSE, 0), 1.0);
        learning.notice(&moved(Source::Control { channel: 0, number: 9 }, 0), 1.01);
        assert_eq!(learning.learned(1.05), None, "the fine number may still arrive");
        assert_eq!(learning.learned(1.08).map(|mapping| mapping.source), Some(COARSE));
        learning.notice(&moved(FINE, 0), 1.06);
        assert_eq!(learning.learned(1.06).map(|mapping| mapping.source), Some(FINE));
    }

    #[test]
    fn the_fine_half_may_come_first() {
        let mut learning = learning();
        learning.notice(&moved(Source::Control { channel: 0, number: 39 }, 0), 1.0);
        learning.notice(&moved(FINE, 0), 1.0);
        assert_eq!(learning.learned(1.0).map(|mapping| mapping.source), Some(FINE));
    }

    #[test]
    fn data_increments_are_learned_once_they_repeat() {
        let increment = Source::Increment { channel: 0 };
        let learned = |second: Source, now: f64| {
            let mut learning = learning();
            learning.notice(&moved(Source::Control { channel: 0, number: 97 }, 0), 1.0);
            learning.notice(&moved(second, 0), 1.2);
            learning.learned(now).map(|mapping| mapping.source)
        };
        assert_eq!(learned(increment, 1.2), Some(increment));
        let knob = Source::Control { channel: 0, number: 97 };
        assert_eq!((learned(knob, 1.9), learned(knob, 2.0)), (None, Some(knob)));
        assert_eq!(learned(Source::Increment { channel: 1 }, 2.0), Some(knob), "of another channel");
    }

    #[test]
    fn key_presses_are_learned_and_pressure_is_not() {
        let mut learning = learning();
        let key = Source::Note { channel: 0, key: 60 };
        learning.notice(&moved(Source::Pressure { channel: 0 }, 0), 1.0);
        learning.notice(&moved(key, 0), 1.0);
        assert_eq!(learning.learned(9.0), None);
        learning.notice(&moved(key, 1), 2.0);
        let mapping = learning.learned(2.0).unwrap();
        assert_eq!((mapping.source, mapping.picks_up, &*mapping.device), (key, false, "desk"));
    }
}

#[cfg(test)]
mod pick_up_tests {
    use super::*;

    #[test]
    fn a_knob_takes_hold_until_another_controller_moves_the_parameter() {
        let mut knob = PickUp::default();
        let mut stands = 0.5;
        let mut turn = |to: f32, stands: &mut f32| {
            let takes = knob.takes(to, [to; 2], *stands);
            if takes {
                *stands = to;
            }
            takes
        };
        assert!(!turn(0.1, &mut stands) && !turn(0.4, &mut stands));
        assert!(turn(0.6, &mut stands), "the knob has passed the value");
        assert!(turn(0.9, &mut stands) && turn(0.2, &mut stands), "and keeps its hold");
        stands = 0.7;
        assert!(!turn(0.25, &mut stands) && !turn(0.6, &mut stands));
        assert!(turn(0.695, &mut stands), "the knob is close enough");
    }

    #[test]
    fn the_first_movement_takes_hold_only_if_close() {
        assert!(PickUp::default().takes(0.505, [0.505; 2], 0.5));
        assert!(!PickUp::default().takes(0.6, [0.6; 2], 0.5));
    }
}
