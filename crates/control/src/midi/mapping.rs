//! Mappings from knobs to parameters and actions, and the changes that follow from knob movements.

use serde::{Deserialize, Serialize};

use super::encoding::Encoding;
use super::learn::PickUp;
use super::source::{KnobMove, Source};
use crate::action::{Action, ActionRow, ActionValue, ValueType, row_of};
use crate::limits;
use crate::{Amount, ChangedBy, ParamChange};

/// The target of a mapping.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Target {
    /// A parameter of a scene.
    Param {
        /// The scene's title.
        scene: String,
        /// The parameter's name.
        name: String,
    },
    /// An action.
    Action {
        /// The action's name.
        name: String,
        /// The value of the action, such as a scene's title.
        value: Option<String>,
    },
}

/// The response curve of a mapping.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Curve {
    /// Linear.
    #[default]
    Linear,
    /// Fine control at the start.
    Slow,
    /// Fine control at the end.
    Fast,
    /// Fine control at both ends.
    Soft,
    /// The square root: raises small values.
    Root,
}

impl Curve {
    /// All curves.
    pub const ALL: [Self; 5] = [Self::Linear, Self::Slow, Self::Fast, Self::Soft, Self::Root];

    /// Returns the curve's name in files and panels.
    pub fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Slow => "slow",
            Self::Fast => "fast",
            Self::Soft => "soft",
            Self::Root => "root",
        }
    }

    /// Returns the curve of `x`, an expression of the scene language.
    pub fn expression(self, x: &str) -> String {
        let is_word = x.chars().all(|c| c.is_ascii_alphanumeric() || "_.".contains(c));
        let factor = if is_word { x.to_owned() } else { format!("({x})") };
        match self {
            Self::Linear => x.to_owned(),
            Self::Slow => format!("{factor} ^ 2"),
            Self::Fast => format!("{factor} * (2 - {factor})"),
            Self::Soft => format!("smoothstep(0, 1, {x})"),
            Self::Root => format!("sqrt({x})"),
        }
    }

    /// Returns the position at which the curve has the value `y`, 0..1.
    fn position(self, y: f32) -> f32 {
        match self {
            Self::Linear => y,
            Self::Slow => y.sqrt(),
            Self::Fast => 1.0 - (1.0 - y).sqrt(),
            Self::Soft => 0.5 - ((1.0 - 2.0 * y).asin() / 3.0).sin(),
            Self::Root => y * y,
        }
    }

    /// Returns the curve's value at `x`, 0..1. It rises from 0 at 0 to 1 at 1.
    pub fn at(self, x: f32) -> f32 {
        match self {
            Self::Linear => x,
            Self::Slow => x * x,
            Self::Fast => x * (2.0 - x),
            Self::Soft => x * x * (3.0 - 2.0 * x),
            Self::Root => x.max(0.0).sqrt(),
        }
    }
}

/// A mapping from one control to one target.
#[derive(Debug, Clone, PartialEq)]
pub struct Mapping {
    /// The device's name.
    pub device: String,
    /// The control on the device.
    pub source: Source,
    /// The target.
    pub target: Target,
    /// The target's values at the two ends of the control: fractions of the parameter's range, 0..1, or numbers for
    /// an action that takes a number. If the first value is larger than the second, the control is inverted.
    pub range: [f32; 2],
    /// The response curve.
    pub curve: Curve,
    /// The smoothing time in seconds.
    pub smoothing: f32,
    /// True if the control has no effect until it passes the parameter's value (pick-up). Has no meaning for steps.
    pub picks_up: bool,
    /// The encoding of the control's values; `None` until it is known, and until then the values are positions.
    pub encoding: Option<Encoding>,
}

/// The default smoothing time in seconds. It hides the 128 steps of a knob.
const SMOOTHING: f32 = 0.05;
/// The default tempos at the two ends of a knob, in beats per minute.
const TEMPOS: [f32; 2] = [60.0, 180.0];
/// The steps of an encoder from one end of the range to the other.
const STEPS: f32 = 128.0;

impl Mapping {
    /// Returns the mapping with default settings.
    pub fn learned(device: &str, source: Source, target: Target) -> Self {
        let is_number = matches!(&target, Target::Action { name, .. } if name == "tempo");
        let turns = !source.is_pressed();
        Self {
            device: device.to_owned(),
            source,
            target,
            range: if is_number { TEMPOS } else { [0.0, 1.0] },
            curve: Curve::Linear,
            smoothing: if turns { SMOOTHING } else { 0.0 },
            picks_up: turns,
            encoding: None,
        }
    }

    /// True if a movement of this control moves the target.
    pub fn is_moved_by(&self, moved: &KnobMove) -> bool {
        self.device == *moved.device && self.source == moved.source
    }

    /// True if the control is an encoder, which sends steps.
    pub fn is_in_steps(&self) -> bool {
        self.encoding.is_some_and(|encoding| encoding != Encoding::Absolute)
    }

    /// Reverses the direction of the control.
    pub fn invert(&mut self) {
        self.range.reverse();
    }

    fn leads_to(&self, value: f32) -> f32 {
        let [from, to] = self.range;
        from + (to - from) * self.curve.at(value.clamp(0.0, 1.0))
    }

    /// Returns the target's value after a movement from the value `present`, which is needed only for steps.
    fn moved_to(&self, moved: &KnobMove, present: Option<f32>) -> Option<f32> {
        let Some(encoding) = self.encoding.filter(|_| self.is_in_steps()) else {
            return Some(self.leads_to(moved.value));
        };
        let [from, to] = self.range;
        let share = (present? - from) / (to - from);
        let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
        Some(self.leads_to(self.curve.position(share) + moved.steps(encoding) as f32 / STEPS))
    }

    /// Clamps numbers that a user wrote in the file. Returns false if the mapping is not usable.
    pub(super) fn mend(&mut self) -> bool {
        let most = if matches!(self.target, Target::Action { .. }) { 1_000.0 } else { 1.0 };
        if !self.range.iter().all(|end| end.is_finite()) || !self.smoothing.is_finite() {
            return false;
        }
        self.range = self.range.map(|end| end.clamp(0.0, most));
        self.smoothing = self.smoothing.clamp(0.0, limits::SMOOTHING_SECONDS_MAX);
        !self.device.is_empty()
    }
}

/// The effect of a knob movement.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// A parameter of the current scene changes.
    Turn(ParamChange),
    /// An action runs.
    Act(Action),
    /// The knob moved but has not picked up the parameter yet. The values are fractions, 0..1.
    Waits {
        /// The parameter.
        name: String,
        /// The value that the knob would set.
        leads_to: f32,
        /// The current value of the parameter.
        stands: f32,
    },
}

/// All mappings, in the order in which they were learned.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mappings {
    list: Vec<Mapping>,
    holds: Vec<PickUp>,
}

impl Mappings {
    /// Uses a list of mappings. Entries beyond the limit are ignored.
    pub fn of(mut list: Vec<Mapping>) -> Self {
        list.truncate(limits::MAPPINGS_MAX);
        Self { holds: vec![PickUp::default(); list.len()], list }
    }

    /// Returns all mappings.
    pub fn list(&self) -> &[Mapping] {
        &self.list
    }

    /// Adds a mapping. Returns false if the mapping exists already or the limit is reached.
    pub fn add(&mut self, mapping: Mapping) -> bool {
        let same = |one: &Mapping| {
            one.device == mapping.device && one.source == mapping.source && one.target == mapping.target
        };
        if self.list.len() >= limits::MAPPINGS_MAX || self.list.iter().any(same) {
            return false;
        }
        self.list.push(mapping);
        self.holds.push(PickUp::default());
        true
    }

    /// Removes the mapping at this index.
    pub fn remove(&mut self, place: usize) {
        if place < self.list.len() {
            self.list.remove(place);
            self.holds.remove(place);
        }
    }

    /// Changes the mapping at this index and resets its pick-up state.
    pub fn change(&mut self, place: usize, change: impl FnOnce(&mut Mapping)) {
        if let Some((mapping, hold)) = self.list.get_mut(place).zip(self.holds.get_mut(place)) {
            change(mapping);
            *hold = PickUp::default();
        }
    }

    /// Returns the effects of a knob movement. `stands` returns the current value of a target: a parameter's as a
    /// fraction of its range, and an action's in the unit of [`Mapping::range`]. It returns `None` for a parameter that
    /// the current scene does not have, and for an action without a value.
    pub fn apply(
        &mut self,
        moved: &KnobMove,
        actions: &[ActionRow],
        stands: impl Fn(&Target) -> Option<f32>,
    ) -> Vec<Outcome> {
        let mut outcomes = Vec::new();
        for (mapping, hold) in self.list.iter().zip(&mut self.holds) {
            if !mapping.is_moved_by(moved) {
                continue;
            }
            let stands = stands(&mapping.target);
            let to = mapping.moved_to(moved, stands);
            match &mapping.target {
                Target::Param { name, .. } => {
                    let Some((stands, fraction)) = stands.zip(to) else { continue };
                    let way = moved.way.map(|end| mapping.leads_to(end));
                    let takes_over = mapping.is_in_steps() || !mapping.picks_up;
                    outcomes.push(match takes_over || hold.takes(fraction, way, stands) {
                        true => Outcome::Turn(ParamChange {
                            name: name.clone(),
                            to: Amount::Fraction(fraction),
                            seconds: mapping.smoothing,
                            changed_by: ChangedBy::Midi,
                        }),
                        false => Outcome::Waits { name: name.clone(), leads_to: fraction, stands },
                    });
                }
                Target::Action { name, value } => {
                    if let Some(row) = row_of(actions, name) {
                        let acts = actions_of(to, row, value.as_deref(), moved);
                        outcomes.extend(acts.map(Outcome::Act));
                    }
                }
            }
        }
        outcomes
    }
}

fn actions_of(
    to: Option<f32>,
    row: ActionRow,
    value: Option<&str>,
    moved: &KnobMove,
) -> impl Iterator<Item = Action> {
    let presses = moved.presses.min(limits::PRESSES_MAX) as usize;
    let (times, given) = match row.takes {
        ValueType::Press | ValueType::Switch => (presses, ActionValue::Nothing),
        ValueType::Level | ValueType::Number => {
            (usize::from(to.is_some()), ActionValue::Number(to.unwrap_or_default()))
        }
        ValueType::Choice | ValueType::Index(_) => match value {
            Some(name) => (presses, ActionValue::Text(name.to_owned())),
            // Programs are numbered from 0, scenes from 1.
            None => (presses.min(1), ActionValue::Number((moved.value * 127.0).round() + 1.0)),
        },
    };
    (0..times).filter_map(move |_| row.wanted(given.clone()))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::encoding::tests::value_of;
    use super::*;

    const KNOB: Source = Source::Control { channel: 0, number: 7 };
    const PAD: Source = Source::Note { channel: 9, key: 36 };
    const ACTIONS: &[ActionRow] = &[
        ActionRow { name: "next", takes: ValueType::Press, meaning: "" },
        ActionRow { name: "pause", takes: ValueType::Switch, meaning: "" },
        ActionRow { name: "scene", takes: ValueType::Choice, meaning: "" },
        ActionRow { name: "tempo", takes: ValueType::Number, meaning: "" },
        ActionRow { name: "volume", takes: ValueType::Level, meaning: "" },
    ];

    fn param(name: &str) -> Target {
        Target::Param { scene: "orb".to_owned(), name: name.to_owned() }
    }

    fn action(name: &str, value: Option<&str>) -> Target {
        Target::Action { name: name.to_owned(), value: value.map(str::to_owned) }
    }

    fn moved(source: Source, value: f32, presses: u32) -> KnobMove {
        KnobMove { presses, ..KnobMove::to("desk".into(), source, value, false) }
    }

    fn mapped(source: Source, target: Target) -> Mapping {
        Mapping { picks_up: false, smoothing: 0.0, ..Mapping::learned("desk", source, target) }
    }

    fn apply(mappings: &mut Mappings, moved: &KnobMove) -> Vec<Outcome> {
        mappings.apply(moved, ACTIONS, |target| match target {
            Target::Param { scene, name } => (scene == "orb" && name != "gone").then_some(0.5),
            Target::Action { .. } => None,
        })
    }

    fn turned(name: &str, fraction: f32) -> Outcome {
        let to = Amount::Fraction(fraction);
        Outcome::Turn(ParamChange { name: name.to_owned(), to, seconds: 0.0, changed_by: ChangedBy::Midi })
    }

    #[test]
    fn one_knob_turns_several_parameters_each_by_its_range_and_curve() {
        let mut inverted = mapped(KNOB, param("glow"));
        inverted.invert();
        let narrow = Mapping { range: [0.2, 0.6], curve: Curve::Slow, ..mapped(KNOB, param("speed")) };
        let other = Mapping { device: "other".to_owned(), ..mapped(KNOB, param("size")) };
        let elsewhere = Target::Param { scene: "city".to_owned(), name: "size".to_owned() };
        let mut mappings = Mappings::of(vec![
            mapped(KNOB, param("size")),
            inverted,
            narrow,
            other,
            mapped(KNOB, elsewhere),
            mapped(KNOB, param("gone")),
        ]);
        let outcomes = apply(&mut mappings, &moved(KNOB, 0.5, 0));
        assert_eq!(outcomes, [turned("size", 0.5), turned("glow", 0.5), turned("speed", 0.3)]);
        assert_eq!(apply(&mut mappings, &moved(PAD, 0.5, 1)), []);
    }

    #[test]
    fn a_knob_waits_until_it_passes_the_parameter() {
        let mut mappings = Mappings::of(vec![Mapping::learned("desk", KNOB, param("size"))]);
        let waits = |at| [Outcome::Waits { name: "size".to_owned(), leads_to: at, stands: 0.5 }];
        assert_eq!(apply(&mut mappings, &moved(KNOB, 0.1, 0)), waits(0.1));
        assert!(matches!(apply(&mut mappings, &moved(KNOB, 0.6, 0))[..], [Outcome::Turn(_)]));
        // The knob may pass the value and return between two frames.
        let mut mappings = Mappings::of(vec![Mapping::learned("desk", KNOB, param("size"))]);
        let swept = KnobMove { way: [0.0, 0.9], ..moved(KNOB, 0.1, 0) };
        assert!(matches!(apply(&mut mappings, &swept)[..], [Outcome::Turn(_)]));
    }

    #[test]
    fn pads_and_buttons_act_once_per_press_and_knobs_set_levels() {
        let mut mappings = Mappings::of(vec![
            mapped(PAD, action("next", None)),
            mapped(PAD, action("scene", Some("city"))),
            mapped(KNOB, action("volume", None)),
            Mapping::learned("desk", KNOB, action("tempo", None)),
            mapped(KNOB, action("pause", None)),
            mapped(KNOB, action("unheard of", None)),
            mapped(Source::Program { channel: 0 }, action("scene", None)),
        ]);
        let act = |name, given| Outcome::Act(Action { name, given });
        let city = || act("scene", ActionValue::Text("city".to_owned()));
        let next = || act("next", ActionValue::Nothing);
        assert_eq!(apply(&mut mappings, &moved(PAD, 0.0, 2)), [next(), next(), city(), city()]);
        assert_eq!(apply(&mut mappings, &moved(PAD, 0.0, 0)), [], "a released pad does nothing");
        let level = act("volume", ActionValue::Number(0.5));
        assert_eq!(
            apply(&mut mappings, &moved(KNOB, 0.5, 0)),
            [level.clone(), act("tempo", ActionValue::Number(120.0))]
        );
        let pressed = apply(&mut mappings, &moved(KNOB, 0.5, 1));
        assert_eq!(pressed.last(), Some(&act("pause", ActionValue::Nothing)));
        let third = moved(Source::Program { channel: 0 }, 2.0 / 127.0, 1);
        assert_eq!(apply(&mut mappings, &third), [act("scene", ActionValue::Number(3.0))]);
        let many = apply(&mut mappings, &moved(PAD, 1.0, u32::MAX));
        assert_eq!(many.len(), 2 * limits::PRESSES_MAX as usize);
    }

    #[test]
    fn mappings_are_added_once_changed_and_removed() {
        let mut mappings = Mappings::default();
        let one = mapped(KNOB, param("size"));
        assert!(mappings.add(one.clone()) && !mappings.add(one.clone()));
        mappings.change(0, Mapping::invert);
        mappings.change(7, Mapping::invert);
        assert_eq!(mappings.list()[0].range, [1.0, 0.0]);
        mappings.remove(7);
        mappings.remove(0);
        assert_eq!(mappings.list(), []);
        for number in 0..limits::MAPPINGS_MAX + 1 {
            assert_eq!(mappings.add(mapped(KNOB, param(&number.to_string()))), number < limits::MAPPINGS_MAX);
        }
        assert_eq!(Mappings::of(vec![one; limits::MAPPINGS_MAX + 1]).list().len(), limits::MAPPINGS_MAX);
    }

    /// Returns the movement of an encoder by `turns`, which arrive between two frames.
    fn turns(encoding: Encoding, turns: &[i32]) -> KnobMove {
        let moves = turns.iter().map(|steps| {
            KnobMove::to("desk".into(), KNOB, f32::from(value_of(encoding, *steps)) / 127.0, false)
        });
        let merged = moves.reduce(|mut moved, later| {
            moved.merge(&later);
            moved
        });
        merged.unwrap()
    }

    fn stepped(encoding: Encoding, target: Target) -> Mapping {
        Mapping { encoding: Some(encoding), ..Mapping::learned("desk", KNOB, target) }
    }

    /// Applies a movement to a single mapping, and returns the new fraction or number.
    fn moved_from(mapping: &Mapping, moved: &KnobMove, present: f32) -> f32 {
        let mut mappings = Mappings::of(vec![mapping.clone()]);
        match &mappings.apply(moved, ACTIONS, |_| Some(present))[..] {
            [Outcome::Turn(ParamChange { to: Amount::Fraction(to), .. })] => *to,
            [Outcome::Act(Action { given: ActionValue::Number(to), .. })] => *to,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn encoders_move_levels_and_the_tempo_from_their_present_values() {
        let moved = turns(Encoding::Sign, &[1, 1, 2]);
        assert_eq!(moved_from(&stepped(Encoding::Sign, action("volume", None)), &moved, 0.25), 0.28125);
        assert_eq!(moved_from(&stepped(Encoding::Sign, action("tempo", None)), &moved, 120.0), 123.75);
        let unknown = stepped(Encoding::Sign, action("volume", None));
        assert_eq!(
            apply(&mut Mappings::of(vec![unknown]), &moved),
            [],
            "without a volume there is nothing to turn"
        );
    }

    #[test]
    fn an_absolute_knob_that_is_known_ignores_its_steps() {
        let known = Mapping { picks_up: false, ..stepped(Encoding::Absolute, param("size")) };
        assert_eq!(moved_from(&known, &moved(KNOB, 1.0, 0), 0.5), 1.0);
        let picks_up = stepped(Encoding::Absolute, param("size"));
        assert!(matches!(
            apply(&mut Mappings::of(vec![picks_up]), &moved(KNOB, 0.9, 0))[..],
            [Outcome::Waits { .. }]
        ));
    }

    fn mappings_of_encoders() -> impl Strategy<Value = Mapping> {
        let curve = proptest::sample::select(Curve::ALL.to_vec());
        let ends =
            (0.0_f32..=1.0, 0.0_f32..=1.0).prop_filter("too narrow", |(from, to)| (to - from).abs() > 0.05);
        let encoding = proptest::sample::select(Encoding::OF_STEPS.to_vec());
        (encoding, curve, ends).prop_map(|(encoding, curve, (from, to))| Mapping {
            range: [from, to],
            curve,
            ..stepped(encoding, param("size"))
        })
    }

    proptest! {
        #[test]
        fn an_encoder_moves_a_parameter_from_its_present_value_in_proportion_to_its_steps(
            encoding in proptest::sample::select(Encoding::OF_STEPS.to_vec()),
            all in proptest::collection::vec((1_i32..64, any::<bool>()), 1..40),
            frames in 1_usize..9,
            present in 0.0_f32..=1.0,
        ) {
            let mapping = stepped(encoding, param("size"));
            let all: Vec<i32> = all.iter().map(|(steps, up)| if *up { *steps } else { -steps }).collect();
            // The result does not depend on the frames, except where a frame ends at an end of the range.
            let mut is_inside = true;
            let at = all.chunks(all.len().div_ceil(frames)).fold(present, |at, turned| {
                let to = moved_from(&mapping, &turns(encoding, turned), at);
                is_inside &= to > 0.0 && to < 1.0;
                to
            });
            let sum = present + all.iter().sum::<i32>() as f32 / 128.0;
            prop_assert!(!is_inside || (at - sum).abs() < 1e-4, "{} instead of {}", at, sum);
            let once = moved_from(&mapping, &turns(encoding, &all), present);
            prop_assert!((once - sum.clamp(0.0, 1.0)).abs() < 1e-4, "{} instead of {}", once, sum);
        }

        #[test]
        fn an_encoder_goes_through_its_range_and_back(mapping in mappings_of_encoders(), slow in 1_i32..9) {
            let encoding = mapping.encoding.unwrap();
            let [from, to] = mapping.range;
            let mut at = from;
            for (way, end) in [(slow, to), (-slow, from)] {
                for _ in 0..2 * 128 / slow + 2 {
                    let next = moved_from(&mapping, &turns(encoding, &[way]), at);
                    let goes_on = (next - at) * (to - from) * way as f32;
                    prop_assert!(goes_on >= -1e-6, "{} after {}", next, at);
                    at = next;
                }
                prop_assert!((at - end).abs() < 1e-5, "{} instead of {}", at, end);
            }
        }
    }

    #[test]
    fn curves_rise_from_zero_to_one() {
        for curve in Curve::ALL {
            for at in (0..=100).map(|n| n as f32 / 100.0) {
                let again = curve.position(curve.at(at));
                assert!((again - at).abs() < 1e-3, "{curve:?} at {at}: {again}");
            }
            assert_eq!((curve.at(0.0), curve.at(1.0)), (0.0, 1.0), "{curve:?}");
            let rises = (0..100).all(|n| curve.at(n as f32 / 100.0) < curve.at((n + 1) as f32 / 100.0));
            assert!(rises, "{curve:?}");
        }
    }
}
