//! The model of all parameters: values, targets, and who changed them last.

use std::collections::BTreeMap;

use super::binding::Following;
use super::{Bound, ChangedBy, Glide, SoundBinding};
use crate::limits;

/// A parameter as declared in a scene's text. `min <= default <= max`, all finite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Param<'a> {
    /// The name in the scene.
    pub name: &'a str,
    /// The smallest value.
    pub min: f32,
    /// The largest value.
    pub max: f32,
    /// The value in the scene's text.
    pub default: f32,
}

impl Param<'_> {
    /// Clamps a value to the range. A value that is not finite becomes the default.
    pub fn clamped(&self, value: f32) -> f32 {
        let value = if value.is_finite() { value } else { self.default };
        value.max(self.min).min(self.max)
    }

    /// Returns a value's position in the range, 0..1.
    pub fn fraction_of(&self, value: f32) -> f32 {
        let fraction = (value - self.min) / (self.max - self.min);
        if fraction.is_finite() { fraction.clamp(0.0, 1.0) } else { 0.0 }
    }

    /// Returns the value at a fraction of the range, 0..1.
    pub fn value_at(&self, fraction: f32) -> f32 {
        self.clamped(self.min + fraction.clamp(0.0, 1.0) * (self.max - self.min))
    }
}

/// A change of a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn {
    /// The new value in the parameter's unit.
    pub to: f32,
    /// The smoothing time in seconds; 0 jumps.
    pub seconds: f32,
    /// The origin of the change.
    pub changed_by: ChangedBy,
}

/// A show's value for a parameter at a moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Directed {
    /// The value.
    pub value: f32,
    /// An identifier of the movement: constant during one movement and different for the next.
    pub part: u64,
}

/// A parameter's value at a moment, and the origin of this value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// The value, within the range.
    pub value: f32,
    /// The origin of the last change.
    pub changed_by: ChangedBy,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Held {
    changed_by: ChangedBy,
    glide: Glide,
    during: Option<u64>,
}

impl Held {
    fn new(changed_by: ChangedBy, glide: Glide, directed: Option<Directed>) -> Self {
        Self { changed_by, glide, during: directed.map(|directed| directed.part) }
    }
}

/// The changed parameters of all scenes, with their origins and targets.
///
/// Scenes are identified by their titles, so that changes persist when the show returns to a scene. A show controls a
/// parameter until a user changes the parameter. The show regains control with its next movement of the parameter.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Model {
    scenes: BTreeMap<String, BTreeMap<String, Held>>,
    /// The bindings of each scene, including bindings that another controller has replaced.
    bindings: BTreeMap<String, BTreeMap<String, Following>>,
}

impl Model {
    /// Changes a parameter at `now`, in seconds. `directed` is the show's value at this moment, if any. The movement
    /// starts at the parameter's current value. A value that is not finite is ignored.
    pub fn turn(&mut self, scene: &str, param: &Param<'_>, turn: Turn, directed: Option<Directed>, now: f64) {
        if !turn.to.is_finite() {
            return;
        }
        let seconds = if turn.seconds.is_finite() {
            turn.seconds.clamp(0.0, limits::SMOOTHING_SECONDS_MAX)
        } else {
            0.0
        };
        let to = param.clamped(turn.to);
        let seen = self.read(scene, param, directed, now);
        // A repeated change to the same target does not restart the movement.
        let is_repeated = |held: &Held| {
            let is_same = held.changed_by == seen.changed_by && held.changed_by == turn.changed_by;
            is_same && held.glide.target() == to && held.glide.moves(now)
        };
        let glide = self.held(scene, param.name).filter(is_repeated).map(|held| held.glide);
        let glide = glide.unwrap_or_else(|| Glide::at(seen.value).towards(to, seconds, now));
        put(&mut self.scenes, scene, param.name, Held::new(turn.changed_by, glide, directed));
    }

    /// Moves a parameter to the value `to` within `seconds`, as a soft ramp. A value that is not finite is ignored.
    pub fn morph(
        &mut self,
        scene: &str,
        param: &Param<'_>,
        turn: Turn,
        directed: Option<Directed>,
        now: f64,
    ) {
        let Turn { to, seconds, changed_by } = turn;
        if to.is_finite() && seconds.is_finite() {
            let seen = self.read(scene, param, directed, now);
            let glide = Glide::at(seen.value).ramp(param.clamped(to), seconds, now);
            put(&mut self.scenes, scene, param.name, Held::new(changed_by, glide, directed));
        }
    }

    /// Lets a parameter follow a sound, from its present value and within `seconds`. Ignores a binding with a number
    /// that is not finite.
    pub fn bind(
        &mut self,
        scene: &str,
        param: &Param<'_>,
        binding: SoundBinding,
        seconds: f32,
        directed: Option<Directed>,
        now: f64,
    ) {
        let Some(binding) = binding.mended() else { return };
        let seen = self.read(scene, param, directed, now).value;
        // The glide keeps the value that unbinding restores.
        let before = self.held(scene, param.name).map_or(param.default, |held| held.glide.target());
        let held = Held::new(ChangedBy::Sound, Glide::at(before), directed);
        put(&mut self.scenes, scene, param.name, held);
        put(&mut self.bindings, scene, param.name, Following::new(binding, seen, seconds, now));
    }

    /// Removes a binding. If the sound moves the parameter, it returns to its value before the binding.
    pub fn unbind(&mut self, scene: &str, param: &Param<'_>) {
        if let Some(bindings) = self.bindings.get_mut(scene) {
            bindings.remove(param.name);
        }
        let Some(held) = self.held(scene, param.name).filter(|held| held.changed_by == ChangedBy::Sound)
        else {
            return;
        };
        if param.clamped(held.glide.target()) == param.default {
            self.release(scene, param.name);
        } else {
            put(&mut self.scenes, scene, param.name, Held { changed_by: ChangedBy::Slider, ..held });
        }
    }

    /// Moves all bound parameters. `input` returns an input's value at `now`, 0..1; `None` for an unknown input.
    pub fn move_bound(&mut self, now: f64, input: impl Fn(&str) -> Option<f32>) {
        for following in self.bindings.values_mut().flat_map(BTreeMap::values_mut) {
            let value = input(&following.binding.input).unwrap_or(0.0);
            following.follow(value, now);
        }
    }

    /// Returns the binding of a parameter.
    pub fn bound(&self, scene: &str, name: &str) -> Option<Bound> {
        let binding = self.following(scene, name)?.binding.clone();
        let is_active = self.held(scene, name).is_some_and(|held| held.changed_by == ChangedBy::Sound);
        Some(Bound { binding, is_active })
    }

    /// Returns the bindings of a scene that move their parameters, by parameter name.
    pub fn bindings(&self, scene: &str) -> BTreeMap<String, SoundBinding> {
        let names = self.bindings.get(scene).into_iter().flat_map(BTreeMap::keys);
        let active =
            names.filter_map(|name| Some((name, self.bound(scene, name).filter(|bound| bound.is_active)?)));
        active.map(|(name, bound)| (name.clone(), bound.binding)).collect()
    }

    /// True if a sound moves a parameter of the scene.
    pub fn follows_sound(&self, scene: &str) -> bool {
        let params = self.scenes.get(scene).into_iter().flat_map(BTreeMap::values);
        params.into_iter().any(|held| held.changed_by == ChangedBy::Sound)
    }

    fn following(&self, scene: &str, name: &str) -> Option<&Following> {
        self.bindings.get(scene)?.get(name)
    }

    /// Resets a parameter to the value in the scene's text.
    pub fn release(&mut self, scene: &str, name: &str) {
        if let Some(params) = self.scenes.get_mut(scene) {
            params.remove(name);
        }
    }

    /// Returns a parameter's value at `now`. `directed` is the show's value at this moment, if any.
    pub fn read(&self, scene: &str, param: &Param<'_>, directed: Option<Directed>, now: f64) -> Reading {
        match (self.held(scene, param.name), directed) {
            (Some(held), Some(directed)) if held.during != Some(directed.part) => {
                Reading { value: directed.value, changed_by: ChangedBy::Show }
            }
            (Some(held), _) => {
                let following =
                    self.following(scene, param.name).filter(|_| held.changed_by == ChangedBy::Sound);
                let value = following.map_or_else(|| held.glide.value(now), |following| following.value(now));
                Reading { value: param.clamped(value), changed_by: held.changed_by }
            }
            (None, Some(directed)) => Reading { value: directed.value, changed_by: ChangedBy::Show },
            (None, None) => Reading { value: param.clamped(param.default), changed_by: ChangedBy::Text },
        }
    }

    /// Returns the target of a parameter. A knob picks up the parameter at this value.
    pub fn target(&self, scene: &str, param: &Param<'_>, directed: Option<Directed>) -> f32 {
        self.read(scene, param, directed, f64::INFINITY).value
    }

    /// True if a parameter of the scene still moves at `now`.
    pub fn moves(&self, scene: &str, now: f64) -> bool {
        let params = self.scenes.get(scene);
        let bindings = self.bindings.get(scene);
        params.is_some_and(|params| params.values().any(|held| held.glide.moves(now)))
            || bindings.is_some_and(|bindings| bindings.values().any(|following| following.moves(now)))
    }

    /// Returns the changed parameters of a scene with their targets and origins. The target of a bound parameter is its
    /// value before the binding.
    pub fn turned(&self, scene: &str) -> impl Iterator<Item = (&str, f32, ChangedBy)> {
        let params = self.scenes.get(scene).into_iter().flatten();
        let targets = params.map(|(name, held)| (&**name, held.glide.target(), held.changed_by));
        targets.filter(|(_, target, _)| target.is_finite())
    }

    /// Restores a value from an earlier run. The scene's text may have changed since that run.
    pub fn remember(&mut self, scene: &str, name: &str, value: f32) {
        if value.is_finite() {
            put(&mut self.scenes, scene, name, Held::new(ChangedBy::Slider, Glide::at(value), None));
        }
    }

    /// Restores a binding from an earlier run, which leads back to the restored value of the parameter.
    pub fn remember_binding(&mut self, scene: &str, name: &str, binding: SoundBinding) {
        let Some(binding) = binding.mended() else { return };
        // NaN means the text's default, which is not known yet.
        let before = self.held(scene, name).map_or(f32::NAN, |held| held.glide.target());
        let held = Held::new(ChangedBy::Sound, Glide::at(before), None);
        put(&mut self.scenes, scene, name, held);
        put(&mut self.bindings, scene, name, Following::new(binding, 0.0, 0.0, 0.0));
    }

    fn held(&self, scene: &str, name: &str) -> Option<Held> {
        self.scenes.get(scene)?.get(name).copied()
    }
}

fn put<T>(scenes: &mut BTreeMap<String, BTreeMap<String, T>>, scene: &str, name: &str, value: T) {
    match scenes.get_mut(scene) {
        Some(params) => drop(params.insert(name.to_owned(), value)),
        None => drop(scenes.insert(scene.to_owned(), BTreeMap::from([(name.to_owned(), value)]))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Curve;

    const SIZE: Param<'static> = Param { name: "size", min: 0.0, max: 4.0, default: 1.0 };

    fn turn(changed_by: ChangedBy, to: f32) -> Turn {
        Turn { to, seconds: 0.0, changed_by }
    }

    fn read(model: &Model, directed: Option<Directed>, now: f64) -> (f32, ChangedBy) {
        let Reading { value, changed_by } = model.read("orb", &SIZE, directed, now);
        (value, changed_by)
    }

    #[test]
    fn the_last_change_wins_from_any_origin() {
        let mut model = Model::default();
        assert_eq!(read(&model, None, 0.0), (1.0, ChangedBy::Text));
        use ChangedBy::{Midi, Osc, Phone, Recording, Show, Slider, Sound, Text};
        for changed_by in [Text, Slider, Midi, Osc, Phone, Show, Recording, Sound] {
            model.turn("orb", &SIZE, turn(changed_by, 2.5), None, 1.0);
            assert_eq!(read(&model, None, 1.0), (2.5, changed_by));
        }
        model.release("orb", "size");
        assert_eq!(read(&model, None, 1.0), (1.0, ChangedBy::Text));
    }

    #[test]
    fn each_scene_keeps_its_own_values() {
        let mut model = Model::default();
        model.turn("orb", &SIZE, turn(ChangedBy::Midi, 3.0), None, 0.0);
        assert_eq!(model.read("city", &SIZE, None, 0.0).value, 1.0);
        assert_eq!(read(&model, None, 0.0), (3.0, ChangedBy::Midi));
        assert_eq!(model.turned("orb").collect::<Vec<_>>(), [("size", 3.0, ChangedBy::Midi)]);
    }

    #[test]
    fn values_stay_in_range_and_non_numbers_are_ignored() {
        let mut model = Model::default();
        model.turn("orb", &SIZE, turn(ChangedBy::Osc, 99.0), None, 0.0);
        assert_eq!(read(&model, None, 0.0).0, 4.0);
        for rubbish in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            model.turn("orb", &SIZE, turn(ChangedBy::Osc, rubbish), None, 0.0);
            let rubbish = Turn { seconds: rubbish, ..turn(ChangedBy::Osc, 4.0) };
            model.turn("orb", &SIZE, rubbish, None, 0.0);
            assert_eq!(read(&model, None, 0.0).0, 4.0);
        }
        // The text now declares another range.
        let narrow = Param { max: 2.0, ..SIZE };
        assert_eq!(model.read("orb", &narrow, None, 0.0).value, 2.0);
    }

    #[test]
    fn a_show_takes_a_parameter_back_with_its_next_movement() {
        let mut model = Model::default();
        let directed = |part| Some(Directed { value: 2.0, part });
        assert_eq!(read(&model, directed(1), 0.0), (2.0, ChangedBy::Show));
        model.turn("orb", &SIZE, turn(ChangedBy::Slider, 3.0), directed(1), 0.0);
        assert_eq!(read(&model, directed(1), 1.0), (3.0, ChangedBy::Slider));
        assert_eq!(read(&model, directed(2), 2.0), (2.0, ChangedBy::Show));
        assert_eq!(read(&model, None, 3.0), (3.0, ChangedBy::Slider), "the show is over");
    }

    #[test]
    fn a_turn_starts_at_the_current_value_and_is_smoothed() {
        let mut model = Model::default();
        let slow = |to| Turn { seconds: 1.0, ..turn(ChangedBy::Midi, to) };
        model.turn("orb", &SIZE, slow(3.0), None, 0.0);
        assert_eq!(read(&model, None, 0.0).0, 1.0);
        let half = read(&model, None, 0.5).0;
        assert!(model.moves("orb", 0.5) && half > 1.0 && half < 3.0);
        // The same target does not restart the movement, and a new target causes no jump.
        model.turn("orb", &SIZE, slow(3.0), None, 0.5);
        let one = 3.0 - 2.0 / std::f32::consts::E;
        assert!((read(&model, None, 1.0).0 - one).abs() < 1e-5);
        model.turn("orb", &SIZE, slow(0.0), None, 1.0);
        assert!((read(&model, None, 1.0).0 - one).abs() < 1e-5);
        assert_eq!(model.target("orb", &SIZE, None), 0.0);
        assert!(!model.moves("orb", 99.0));
    }

    #[test]
    fn a_user_takes_over_from_a_show_without_a_jump() {
        let mut model = Model::default();
        let slow = Turn { seconds: 1.0, ..turn(ChangedBy::Midi, 4.0) };
        let directed = |part| Some(Directed { value: 2.0, part });
        model.turn("orb", &SIZE, slow, directed(1), 0.0);
        assert_eq!(read(&model, directed(1), 0.0), (2.0, ChangedBy::Midi));
        // The smoothed movement approaches the user's target, not the show's value.
        assert!(read(&model, directed(1), 9.0).0 > 3.9);
        model.turn("orb", &SIZE, slow, directed(2), 9.0);
        assert_eq!(read(&model, directed(2), 9.0), (2.0, ChangedBy::Midi));
    }

    #[test]
    fn smoothing_is_clamped_to_the_limit() {
        let mut model = Model::default();
        model.turn("orb", &SIZE, Turn { seconds: 1e9, ..turn(ChangedBy::Osc, 4.0) }, None, 0.0);
        let gone = f64::from(limits::SMOOTHING_SECONDS_MAX) * 7.0;
        assert!(model.moves("orb", gone - 1.0) && !model.moves("orb", gone));
    }

    fn by_bass(low: f32, high: f32, smoothing: f32) -> SoundBinding {
        SoundBinding { input: "bass".to_owned(), low, high, curve: Curve::Linear, smoothing, release: None }
    }

    #[test]
    fn a_bound_parameter_follows_its_input_until_a_controller_turns_it() {
        let mut model = Model::default();
        model.turn("orb", &SIZE, turn(ChangedBy::Slider, 2.0), None, 0.0);
        model.bind("orb", &SIZE, by_bass(0.0, 8.0, 0.0), 0.0, None, 1.0);
        let hear = |model: &mut Model, now, value| {
            model.move_bound(now, |name| (name == "bass").then_some(value));
            read(model, None, now)
        };
        assert_eq!(hear(&mut model, 1.0, 0.25), (2.0, ChangedBy::Sound));
        assert_eq!(hear(&mut model, 1.1, 1.0), (4.0, ChangedBy::Sound), "the value stays in the range");
        assert_eq!(model.bindings("orb").len(), 1);
        assert_eq!(model.turned("orb").collect::<Vec<_>>(), [("size", 2.0, ChangedBy::Sound)]);
        model.turn("orb", &SIZE, turn(ChangedBy::Midi, 1.5), None, 2.0);
        assert_eq!(hear(&mut model, 2.0, 0.0), (1.5, ChangedBy::Midi));
        let bound = model.bound("orb", "size").unwrap();
        assert!(!bound.is_active && model.bindings("orb").is_empty());
        model.bind("orb", &SIZE, bound.binding, 0.0, None, 3.0);
        assert_eq!(hear(&mut model, 3.0, 0.125), (1.0, ChangedBy::Sound));
        model.unbind("orb", &SIZE);
        assert_eq!(read(&model, None, 3.0), (1.5, ChangedBy::Slider));
        assert_eq!(model.bound("orb", "size"), None);
    }

    #[test]
    fn a_binding_is_smoothed_and_begins_at_the_present_value() {
        let mut model = Model::default();
        model.bind("orb", &SIZE, by_bass(4.0, 0.0, 1.0), 0.0, None, 0.0);
        for step in 0..=10 {
            model.move_bound(f64::from(step) / 10.0, |_| Some(0.0));
        }
        let one = 4.0 - 3.0 / std::f32::consts::E;
        assert!((read(&model, None, 1.0).0 - one).abs() < 1e-5 && model.moves("orb", 1.0));
        // A recalled binding takes over within its time.
        model.bind("orb", &SIZE, by_bass(0.0, 4.0, 0.0), 2.0, None, 8.0);
        let before = read(&model, None, 8.0).0;
        model.move_bound(9.0, |_| Some(0.0));
        assert!((read(&model, None, 9.0).0 - 0.5 * before).abs() < 1e-5);
        assert_eq!(read(&model, None, 10.0).0, 0.0);
        model.bind("orb", &SIZE, by_bass(f32::NAN, 4.0, 0.0), 0.0, None, 11.0);
        assert_eq!(model.bindings("orb")["size"].low, 0.0, "such a binding is ignored");
    }

    #[test]
    fn a_show_takes_a_bound_parameter_over_with_its_next_movement() {
        let mut model = Model::default();
        let directed = |part| Some(Directed { value: 3.0, part });
        model.bind("orb", &SIZE, by_bass(0.0, 4.0, 0.0), 0.0, directed(1), 0.0);
        model.move_bound(1.0, |_| Some(0.5));
        assert_eq!(read(&model, directed(1), 1.0), (2.0, ChangedBy::Sound));
        assert_eq!(read(&model, directed(2), 1.0), (3.0, ChangedBy::Show));
    }

    #[test]
    fn a_morph_takes_its_time() {
        let mut model = Model::default();
        let slow = Turn { seconds: 2.0, ..turn(ChangedBy::Slider, 3.0) };
        model.morph("orb", &SIZE, slow, None, 0.0);
        assert_eq!([0.0, 1.0, 2.0].map(|now| read(&model, None, now).0), [1.0, 2.0, 3.0]);
    }

    #[test]
    fn remembered_values_are_restored() {
        let mut model = Model::default();
        model.remember("orb", "size", 0.5);
        model.remember("orb", "gone", f32::NAN);
        assert_eq!(read(&model, None, 0.0), (0.5, ChangedBy::Slider));
        assert_eq!(model.turned("orb").count(), 1);
    }

    #[test]
    fn fractions_and_values_convert_both_ways() {
        assert_eq!([0.0, 0.25, 1.0, 7.0].map(|fraction| SIZE.value_at(fraction)), [0.0, 1.0, 4.0, 4.0]);
        assert_eq!([0.0, 1.0, 4.0, -3.0].map(|value| SIZE.fraction_of(value)), [0.0, 0.25, 1.0, 0.0]);
        let none = Param { min: 1.0, max: 1.0, ..SIZE };
        assert_eq!((none.fraction_of(1.0), none.value_at(0.7)), (0.0, 1.0));
    }
}
