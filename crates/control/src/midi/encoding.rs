//! Encodings of knobs: a knob sends its position, or an endless knob (an encoder) sends its steps.

use serde::{Deserialize, Serialize};

/// The meaning of the values that a control sends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Encoding {
    /// The control's position.
    Absolute,
    /// Steps in offset binary: 64 + n upwards, 64 - n downwards.
    Offset,
    /// Steps in two's complement: n upwards, 128 - n downwards.
    Complement,
    /// Steps as sign and magnitude: n upwards, 64 + n downwards.
    Sign,
}

impl Encoding {
    /// The encodings of steps.
    pub const OF_STEPS: [Self; 3] = [Self::Offset, Self::Complement, Self::Sign];

    /// Returns the steps in a value from 0 to 127, positive upwards.
    pub fn steps(self, value: u8) -> i32 {
        let value = i32::from(value);
        match self {
            Self::Absolute => 0,
            Self::Offset => value - 64,
            Self::Complement if value >= 64 => value - 128,
            Self::Sign if value >= 64 => 64 - value,
            Self::Complement | Self::Sign => value,
        }
    }
}

/// An encoder is recognized by this many single steps in succession each way. A position does not repeat its value.
const SINGLE_STEPS: u8 = 3;
/// An encoder that turns faster than this, in steps per message, is not recognized: values this far apart are
/// positions.
const STEPS_MAX: i32 = 15;
const UP: u8 = 1;
const DOWN: u8 = 2;

/// The evidence that a control is an encoder.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Evidence {
    /// The number of equal values in succession.
    run: u8,
    /// For each of [`Encoding::OF_STEPS`], the ways of the single steps since the last value that does not fit.
    ways: [u8; 3],
}

impl Evidence {
    /// Adds a value that follows the value `before`. Returns the encoding if the control is an encoder.
    ///
    /// A knob that sends positions is not taken for an encoder: between values near both ends of an encoding it sends
    /// other values, and it rests at few of them.
    pub(super) fn add(&mut self, value: u8, before: u8) -> Option<Encoding> {
        self.run = if value == before { self.run.saturating_add(1) } else { 1 };
        for (encoding, ways) in Encoding::OF_STEPS.into_iter().zip(&mut self.ways) {
            match encoding.steps(value) {
                1 if self.run >= SINGLE_STEPS => *ways |= UP,
                -1 if self.run >= SINGLE_STEPS => *ways |= DOWN,
                steps if steps == 0 || steps.abs() > STEPS_MAX => *ways = 0,
                _ => {}
            }
        }
        let mut all = Encoding::OF_STEPS.into_iter().zip(self.ways);
        all.find(|(_, ways)| *ways == UP | DOWN).map(|(encoding, _)| encoding)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Returns the value that an encoder sends for `steps`.
    pub(in crate::midi) fn value_of(encoding: Encoding, steps: i32) -> u8 {
        (0..128).find(|value| *value != 64 && encoding.steps(*value) == steps).unwrap()
    }

    fn recognized(values: impl IntoIterator<Item = u8>) -> Vec<Option<Encoding>> {
        let (mut evidence, mut before) = (Evidence::default(), 0);
        values.into_iter().map(|value| evidence.add(value, std::mem::replace(&mut before, value))).collect()
    }

    #[test]
    fn the_values_of_the_manuals_are_their_steps() {
        let steps = |encoding: Encoding| [1, 3, 61, 63, 65, 67, 125, 127].map(|value| encoding.steps(value));
        assert_eq!(steps(Encoding::Offset), [-63, -61, -3, -1, 1, 3, 61, 63]);
        assert_eq!(steps(Encoding::Complement), [1, 3, 61, 63, -63, -61, -3, -1]);
        assert_eq!(steps(Encoding::Sign), [1, 3, 61, 63, -1, -3, -61, -63]);
        assert_eq!(steps(Encoding::Absolute), [0; 8]);
    }

    #[test]
    fn buttons_and_resting_knobs_are_no_encoders() {
        let button = [127, 127, 127, 0, 0, 0].repeat(9);
        let one_way = [65; 99].to_vec();
        // A fader that repeats its position moves through the middle, and rests near it.
        let middle = [60, 63, 63, 63, 64, 65, 65, 65, 64, 63, 63, 63].repeat(9);
        let ends = [1, 1, 1, 40, 127, 127, 127, 90].repeat(9);
        for values in [button, one_way, middle, ends] {
            assert!(recognized(values.iter().copied()).iter().all(Option::is_none), "{values:?}");
        }
    }

    fn encodings() -> impl Strategy<Value = Encoding> {
        proptest::sample::select(Encoding::OF_STEPS.to_vec())
    }

    proptest! {
        #[test]
        fn every_encoder_is_recognized_after_slow_turns_both_ways(
            encoding in encodings(),
            first in prop_oneof![Just(1), Just(-1)],
            faster in proptest::collection::vec((1..=STEPS_MAX, any::<bool>()), 0..40),
            slow in 3_usize..9,
        ) {
            let faster = faster.into_iter().map(|(steps, up)| if up { steps } else { -steps });
            let slow_turn = |way: i32| std::iter::repeat_n(way, slow);
            let turns: Vec<i32> =
                slow_turn(first).chain(faster).chain(slow_turn(-first)).chain([first]).collect();
            let found = recognized(turns.iter().map(|steps| value_of(encoding, *steps)));
            prop_assert_eq!(found.last(), Some(&Some(encoding)));
            prop_assert!(found.iter().flatten().all(|found| *found == encoding), "{:?}", found);
        }

        #[test]
        fn a_fader_that_jumps_is_no_encoder(positions in proptest::collection::vec(0_u8..128, 0..400)) {
            let mut positions = positions;
            positions.dedup();
            prop_assert!(recognized(positions).iter().all(Option::is_none));
        }

        #[test]
        fn a_fader_that_repeats_its_position_is_no_encoder(
            moves in proptest::collection::vec((-1_i32..=1, 1_usize..6), 0..400),
            start in 0_u8..128,
        ) {
            let mut at = start;
            let positions = moves.into_iter().flat_map(|(way, times)| {
                at = at.saturating_add_signed(way as i8).min(127);
                std::iter::repeat_n(at, times)
            });
            prop_assert!(recognized(positions).iter().all(Option::is_none));
        }
    }
}
