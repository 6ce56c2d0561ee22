//! The parameters of scenes. All controllers change one model; sliders and frames read it. A frame is drawn with the
//! values of one moment, which is set between frames and never during a frame.

use std::cell::LazyCell;
use std::collections::BTreeMap;
use std::time::Instant;

use super::active_clips::ActiveClips;
use super::beat_count::BeatCount;
use super::knobs::Knob;
use super::prepared_scene::PreparedScene;
use super::show_follower::ShowFollower;
use crate::clock;
use crate::commands::TurnedNumbers;
use crate::config::Snapshot;
use crate::frame::sound_inputs;
use mariana_control::{ChangedBy, Directed, Model, ParamChange, Reading, Slider, SoundBinding, Turn};
use mariana_field::graph::UnitInput;
use mariana_player::Moment;

pub(crate) struct Parameters {
    model: Model,
    begun: Instant,
    /// The moment of the shown frame, in seconds of the model's clock.
    now: f64,
    /// The moment of the shown frame, in seconds of the song.
    pub(super) song_time: f64,
    beats: BeatCount,
    /// New values for numbers in a text. They become inputs: nothing is parsed or compiled.
    turned: Option<TurnedNumbers>,
    /// Counts the changes after which a frame of the same moment would look different.
    pub(super) revision: u64,
}

impl Parameters {
    /// Starts with the values of `model`, whose clock started at `begun`.
    pub(super) fn new(model: Model, begun: Instant) -> Self {
        let now = clock::since(begun).as_secs_f64();
        Self { model, begun, now, song_time: 0.0, beats: BeatCount::default(), turned: None, revision: 0 }
    }

    /// Returns the time of the model's clock, in seconds.
    pub(super) fn clock(&self) -> f64 {
        clock::since(self.begun).as_secs_f64()
    }

    pub(super) fn seek(&mut self, moment: &Moment) {
        let Moment { song_time, features, song, .. } = moment;
        (self.now, self.song_time) = (self.clock(), *song_time);
        self.beats.record(features.phase, song.beat_in_bar);
        let sound = LazyCell::new(|| sound_inputs(features, song));
        let beats = self.beats.beats();
        self.model.move_bound(self.now, |name| Some(UnitInput::named(name)?.value(&sound, beats)));
    }

    /// Restores the saved values and bindings of the scene with this title.
    pub(crate) fn remember(&mut self, title: &str, moved: &Snapshot) {
        for (name, value) in &moved.sliders {
            self.model.remember(title, name, *value);
        }
        for (name, binding) in &moved.bindings {
            self.model.remember_binding(title, name, binding.clone());
        }
    }

    /// All parameters at `time` seconds of the song: set by controllers and clips, otherwise the text's defaults.
    pub(super) fn numbers(&self, scene: &PreparedScene, clips: &ActiveClips<'_>, time: f64) -> Vec<f32> {
        let mut numbers: Vec<f32> =
            scene.resources.world().scene.params.iter().map(|param| param.default).collect();
        for ((_, knob), reading) in scene.knobs.iter().zip(self.read(scene, clips, time)) {
            if let Some(number) = numbers.get_mut(knob.place) {
                *number = reading.value;
            }
        }
        self.turn_in(scene, &mut numbers);
        numbers
    }

    fn read(&self, scene: &PreparedScene, clips: &ActiveClips<'_>, time: f64) -> Vec<Reading> {
        let [first, second] = clips.all_directed(time);
        let read = |(slider, knob): (&Slider, &Knob)| {
            let of_world = if knob.place < scene.split() { &first } else { &second };
            let directed = of_world.iter().find(|(name, _)| *name == slider.name).map(|(_, value)| *value);
            self.model.read(&knob.scene, &slider.param(), directed, self.now)
        };
        scene.knobs.iter().map(read).collect()
    }

    /// Sets values for the numbers of a text. Only numbers with a range change.
    pub(crate) fn turn_numbers(&mut self, turned: TurnedNumbers) {
        self.turned = Some(turned);
        self.revision += 1;
    }

    fn turn_in(&self, scene: &PreparedScene, numbers: &mut [f32]) {
        let world = scene.resources.world();
        let Some(turned) = &self.turned else { return };
        if world.blended.is_some() || scene.source.file() != Some(&turned.file) {
            return;
        }
        // Skip numbers without a range, which are no longer being dragged.
        for (digits, value) in &turned.values {
            let place = world.scene.params.iter().position(|param| {
                param.is_number && param.span.start as usize == *digits && param.min < param.max
            });
            if let Some(number) = place.and_then(|place| numbers.get_mut(place)) {
                *number = *value;
            }
        }
    }
}

/// Read access to the parameters of the scene in hand, which sliders and controllers change: the shown scene, or the
/// scene on one of two decks.
pub(crate) struct ParametersInHand<'a> {
    pub(super) scene: Option<&'a PreparedScene>,
    pub(super) show: &'a ShowFollower,
    pub(super) parameters: &'a Parameters,
}

impl<'a> ParametersInHand<'a> {
    pub(crate) fn title(&self) -> Option<String> {
        self.scene.map(PreparedScene::title)
    }

    pub(crate) fn sliders(&self) -> &'a [Slider] {
        self.scene.map_or(&[], |scene| &scene.knobs.sliders)
    }

    /// The titles of the scenes whose parameters these are: two in a blend.
    fn titles(&self) -> impl Iterator<Item = &'a str> + use<'a> {
        self.scene.into_iter().flat_map(|scene| scene.knobs.titles())
    }

    pub(crate) fn are_turning(&self) -> bool {
        self.titles().any(|title| self.parameters.model.moves(title, self.parameters.now))
    }

    pub(super) fn follow_sound(&self) -> bool {
        self.titles().any(|title| self.parameters.model.follows_sound(title))
    }

    /// The value to which a parameter moves, and the controller that set this value.
    pub(crate) fn target(&self, name: &str) -> Option<(f32, ChangedBy)> {
        let (slider, knob) = self.scene?.knobs.named(name)?;
        Some((self.target_of(slider, knob)?, slider.changed_by))
    }

    fn target_of(&self, slider: &Slider, knob: &Knob) -> Option<f32> {
        let (scene, time) = (self.scene?, self.parameters.song_time);
        let directed = self.show.clips(&scene.source, time).directed(scene, slider, knob, time);
        Some(self.parameters.model.target(&knob.scene, &slider.param(), directed))
    }

    /// The parameters of the scene that differ from its text, and the bindings.
    pub(crate) fn moved(&self) -> Snapshot {
        let Some(scene) = self.scene else { return Snapshot::default() };
        let title = scene.title();
        let turned = self.parameters.model.turned(&title).filter(|(name, value, _)| {
            let slider = scene.knobs.sliders.iter().find(|slider| slider.name == *name);
            slider.is_some_and(|slider| slider.default.to_bits() != value.to_bits())
        });
        let sliders = turned.map(|(name, value, _)| (name.to_owned(), value)).collect();
        Snapshot { sliders, bindings: self.bindings(scene) }
    }

    /// All sliders of the scene, and the sounds that move them; in a blend, of the incoming scene. `None` if it has no
    /// sliders.
    pub(crate) fn snapshot(&self) -> Option<Snapshot> {
        let scene = self.scene?;
        let target =
            |(slider, knob): (&Slider, &Knob)| Some((slider.name.clone(), self.target_of(slider, knob)?));
        let sliders: BTreeMap<_, _> = scene.own_knobs().filter_map(target).collect();
        (!sliders.is_empty()).then(|| Snapshot { sliders, bindings: self.bindings(scene) })
    }

    fn bindings(&self, scene: &PreparedScene) -> BTreeMap<String, SoundBinding> {
        let mut bindings = self.parameters.model.bindings(&scene.title());
        bindings.retain(|name, _| scene.knobs.place_of(name).is_some());
        bindings
    }
}

/// Write access to the parameters of a scene.
pub(crate) struct TurnedParameters<'a> {
    scene: &'a mut PreparedScene,
    clips: ActiveClips<'a>,
    parameters: &'a mut Parameters,
}

impl<'a> TurnedParameters<'a> {
    pub(super) fn of(
        scene: &'a mut PreparedScene,
        show: &'a ShowFollower,
        parameters: &'a mut Parameters,
    ) -> Self {
        let clips = show.clips(&scene.source, parameters.song_time);
        Self { scene, clips, parameters }
    }

    fn directed(&self, slider: &Slider, knob: &Knob) -> Option<Directed> {
        self.clips.directed(self.scene, slider, knob, self.parameters.song_time)
    }

    pub(super) fn update_sliders(&mut self) {
        let readings = self.parameters.read(self.scene, &self.clips, self.parameters.song_time);
        let mut is_turned = false;
        for (slider, reading) in self.scene.knobs.sliders.iter_mut().zip(readings) {
            // Ignore parameters that the show moves: a running show draws new frames anyway.
            is_turned |=
                slider.value.to_bits() != reading.value.to_bits() && reading.changed_by != ChangedBy::Show;
            (slider.value, slider.changed_by) = (reading.value, reading.changed_by);
        }
        self.scene.knobs.update_bindings(|scene, name| self.parameters.model.bound(scene, name));
        if is_turned {
            self.parameters.revision += 1;
        }
    }

    /// Applies `change` to a parameter; in a blend, of the incoming scene. Returns `false` for an unknown name.
    pub(crate) fn turn(&mut self, change: &ParamChange) -> bool {
        let knobs = &self.scene.knobs;
        let Some((place, (slider, _))) = knobs.place_of(&change.name).zip(knobs.named(&change.name)) else {
            return false;
        };
        let to = change.to.of(&slider.param());
        self.turn_at(place, Turn { to, seconds: change.seconds, changed_by: change.changed_by });
        true
    }

    pub(crate) fn move_slider(&mut self, place: usize, to: f32) {
        self.turn_at(place, Turn { to, seconds: 0.0, changed_by: ChangedBy::Slider });
        self.parameters.revision += 1;
    }

    /// Sets the parameter of a slider. A slider moved back to the text's default follows the text again.
    fn turn_at(&mut self, place: usize, turn: Turn) {
        let Some((slider, knob)) = self.scene.knobs.get(place) else { return };
        let (param, directed) = (slider.param(), self.directed(slider, knob));
        let Parameters { model, now, .. } = &mut *self.parameters;
        if turn.changed_by == ChangedBy::Slider && turn.to == param.default && directed.is_none() {
            model.release(&knob.scene, param.name);
        } else {
            model.turn(&knob.scene, &param, turn, directed, *now);
        }
        self.update_sliders();
    }

    /// Binds a parameter to a sound, or ends its binding. Returns `false` for an unknown name.
    pub(crate) fn bind(&mut self, name: &str, binding: Option<SoundBinding>) -> bool {
        let Some((slider, knob)) = self.scene.knobs.named(name) else { return false };
        let (param, directed) = (slider.param(), self.directed(slider, knob));
        let Parameters { model, now, .. } = &mut *self.parameters;
        match binding {
            Some(binding) => model.bind(&knob.scene, &param, binding, 0.0, directed, *now),
            None => model.unbind(&knob.scene, &param),
        }
        self.update_sliders();
        self.parameters.revision += 1;
        true
    }

    /// Moves all sliders of the scene to a snapshot within `seconds`. Sliders that are not in the snapshot stay.
    pub(crate) fn recall(&mut self, snapshot: &Snapshot, seconds: f32) {
        for (slider, knob) in self.scene.own_knobs() {
            let (param, directed) = (slider.param(), self.directed(slider, knob));
            let Parameters { model, now, .. } = &mut *self.parameters;
            if let Some(binding) = snapshot.bindings.get(param.name) {
                model.bind(&knob.scene, &param, binding.clone(), seconds, directed, *now);
            } else if let Some(to) = snapshot.sliders.get(param.name) {
                let turn = Turn { to: *to, seconds, changed_by: ChangedBy::Slider };
                model.morph(&knob.scene, &param, turn, directed, *now);
            }
        }
        self.update_sliders();
        self.parameters.revision += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{text, uploaded};
    use super::*;
    use crate::gpu::headless::Headless;
    use mariana_control::Amount;

    const BALL: &str = "param size = 1 in 0 .. 4\nobject ball { shape = sphere(p, size) }";

    fn change(name: &str, to: f32, changed_by: ChangedBy) -> ParamChange {
        ParamChange { name: name.to_owned(), to: Amount::Value(to), seconds: 0.0, changed_by }
    }

    #[test]
    fn a_controlled_value_appears_in_the_next_frame_and_is_saved_by_scene_title() {
        let context = Headless::new(false).unwrap();
        let mut scene = uploaded(context.gl(), 0, &text(BALL));
        let mut parameters = Parameters::new(Model::default(), Instant::now());
        let (show, clips) = (ShowFollower::default(), ActiveClips::default());
        let mut turned = TurnedParameters::of(&mut scene, &show, &mut parameters);
        assert!(!turned.turn(&change("width", 2.0, ChangedBy::Midi)), "no such parameter");
        assert_eq!(turned.parameters.revision, 0);
        assert!(turned.turn(&change("size", 2.5, ChangedBy::Midi)));
        assert_eq!(parameters.numbers(&scene, &clips, 0.0), [2.5]);
        let in_hand = ParametersInHand { scene: Some(&scene), show: &show, parameters: &parameters };
        assert_eq!(in_hand.target("size"), Some((2.5, ChangedBy::Midi)));
        assert!(parameters.revision > 0, "the same moment looks different");
        let moved = in_hand.moved();
        assert_eq!(moved.sliders.get("size"), Some(&2.5));
        // A slider moved back to the text's default follows the text again.
        TurnedParameters::of(&mut scene, &show, &mut parameters).move_slider(0, 1.0);
        let in_hand = ParametersInHand { scene: Some(&scene), show: &show, parameters: &parameters };
        assert_eq!(in_hand.target("size"), Some((1.0, ChangedBy::Text)));
        assert_eq!(in_hand.moved(), Snapshot::default());
        let mut again = Parameters::new(Model::default(), Instant::now());
        again.remember(&scene.title(), &moved);
        assert_eq!(again.numbers(&scene, &clips, 0.0), [2.5]);
    }
}
