//! The parameters of scenes. All controllers change one model; sliders and frames read it. A frame is drawn with the
//! values of one moment, which is set between frames and never during a frame.

use std::cell::LazyCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use super::active_clips::ActiveClips;
use super::beat_count::BeatCount;
use super::knobs::param_of;
use super::prepared_scene::PreparedScene;
use crate::clock;
use crate::config::Snapshot;
use crate::frame::sound_inputs;
use mariana_control::{ChangedBy, Model, ParamChange, Reading, SoundBinding, Turn};
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
    turned: Option<TurnedNumbers>,
    /// Counts the changes after which a frame of the same moment would look different.
    pub(super) revision: u64,
}

/// New values for numbers in a text, by their offsets in it. They become inputs: nothing is parsed or compiled.
#[derive(Debug, Clone, PartialEq)]
struct TurnedNumbers {
    file: PathBuf,
    values: Vec<(usize, f32)>,
}

impl Parameters {
    /// Starts with the values of `model`, whose clock started at `begun`.
    pub(super) fn new(model: Model, begun: Instant) -> Self {
        let now = clock::since(begun).as_secs_f64();
        Self { model, begun, now, song_time: 0.0, beats: BeatCount::default(), turned: None, revision: 0 }
    }

    pub(super) fn kept(self) -> (Model, Instant) {
        (self.model, self.begun)
    }

    pub(super) fn adopt(&mut self, model: Model, begun: Instant) {
        let (beats, turned) = (self.beats, self.turned.take());
        *self = Self { revision: self.revision, beats, turned, ..Self::new(model, begun) };
    }

    /// Returns the time of the model's clock, in seconds.
    pub(super) fn clock(&self) -> f64 {
        clock::since(self.begun).as_secs_f64()
    }

    pub(super) fn seek(&mut self, moment: &Moment) {
        let Moment { song_time, features, song, .. } = moment;
        (self.now, self.song_time) = (clock::since(self.begun).as_secs_f64(), *song_time);
        self.beats.record(features.phase, song.beat_in_bar);
        let sound = LazyCell::new(|| sound_inputs(features, song));
        let beats = self.beats.beats();
        self.model.move_bound(self.now, |name| Some(UnitInput::named(name)?.value(&sound, beats)));
    }

    pub(super) fn follow_sound(&self, scene: &PreparedScene) -> bool {
        scene.knobs.titles().into_iter().any(|title| self.model.follows_sound(title))
    }

    pub(super) fn record_turning(&mut self) {
        self.revision += 1;
    }

    pub(super) fn is_turning(&self, scene: &PreparedScene) -> bool {
        scene.knobs.titles().into_iter().any(|title| self.model.moves(title, self.now))
    }

    pub(super) fn update_sliders(&mut self, scene: &mut PreparedScene, clips: &ActiveClips<'_>) {
        let readings = self.read(scene, clips, self.song_time);
        let mut is_turned = false;
        for (slider, reading) in scene.knobs.sliders.iter_mut().zip(readings) {
            // Ignore parameters that the show moves: a running show draws new frames anyway.
            is_turned |=
                slider.value.to_bits() != reading.value.to_bits() && reading.changed_by != ChangedBy::Show;
            (slider.value, slider.changed_by) = (reading.value, reading.changed_by);
        }
        scene.knobs.update_bindings(|scene, name| self.model.bound(scene, name));
        if is_turned {
            self.revision += 1;
        }
    }

    /// Applies `change` to a parameter; in a blend, of the incoming scene. Returns `false` for an unknown name.
    pub(super) fn turn(
        &mut self,
        scene: &mut PreparedScene,
        clips: &ActiveClips<'_>,
        change: &ParamChange,
    ) -> bool {
        let place = scene.knobs.place_of(&change.name);
        if let Some((place, (slider, _))) = place.and_then(|place| Some((place, scene.knobs.get(place)?))) {
            let to = change.to.of(&param_of(slider));
            self.turn_at(
                scene,
                clips,
                place,
                Turn { to, seconds: change.seconds, changed_by: change.changed_by },
            );
        }
        place.is_some()
    }

    pub(super) fn record_moved(&mut self, scene: &mut PreparedScene, clips: &ActiveClips<'_>) {
        let before = self.read(scene, clips, self.song_time);
        let moved: Vec<(usize, f32)> = (scene.knobs.sliders.iter().zip(before).enumerate())
            .filter(|(_, (slider, before))| slider.value.to_bits() != before.value.to_bits())
            .map(|(place, (slider, _))| (place, slider.value))
            .collect();
        for (place, to) in moved {
            self.turn_at(scene, clips, place, Turn { to, seconds: 0.0, changed_by: ChangedBy::Slider });
        }
        self.revision += 1;
    }

    /// Sets the parameter of a slider. A slider moved back to the text's default follows the text again.
    fn turn_at(&mut self, scene: &mut PreparedScene, clips: &ActiveClips<'_>, place: usize, turn: Turn) {
        let Some((slider, knob)) = scene.knobs.get(place) else { return };
        let param = param_of(slider);
        let directed = clips.moves(self.song_time).of(knob, &slider.name, scene.split());
        if turn.changed_by == ChangedBy::Slider && turn.to == param.default && directed.is_none() {
            self.model.release(&knob.scene, param.name);
        } else {
            self.model.turn(&knob.scene, &param, turn, directed, self.now);
        }
        self.update_sliders(scene, clips);
    }

    /// Binds a parameter to a sound, or ends its binding. Returns `false` for an unknown name.
    pub(super) fn bind(
        &mut self,
        scene: &mut PreparedScene,
        clips: &ActiveClips<'_>,
        name: &str,
        binding: Option<SoundBinding>,
    ) -> bool {
        let Some((slider, knob)) = scene.knobs.place_of(name).and_then(|place| scene.knobs.get(place)) else {
            return false;
        };
        match binding {
            Some(binding) => {
                let directed = clips.moves(self.song_time).of(knob, &slider.name, scene.split());
                self.model.bind(&knob.scene, &param_of(slider), binding, 0.0, directed, self.now);
            }
            None => self.model.unbind(&knob.scene, &param_of(slider)),
        }
        self.update_sliders(scene, clips);
        self.revision += 1;
        true
    }

    /// All sliders of the scene, and the sounds that move them; in a blend, of the incoming scene.
    pub(super) fn snapshot(&self, scene: &PreparedScene, clips: &ActiveClips<'_>) -> Snapshot {
        let (title, moves) = (scene.title(), clips.moves(self.song_time));
        let begin = scene.resources.world().blended.unwrap_or(0);
        let own = scene.knobs.iter().filter(|(_, knob)| knob.place >= begin);
        let sliders = own.map(|(slider, knob)| {
            let directed = moves.of(knob, &slider.name, scene.split());
            (slider.name.clone(), self.model.target(&knob.scene, &param_of(slider), directed))
        });
        Snapshot { sliders: sliders.collect(), bindings: self.bindings(scene, &title) }
    }

    /// Moves all sliders of the scene to a snapshot within `seconds`. Sliders that are not in the snapshot stay.
    pub(super) fn recall(
        &mut self,
        scene: &mut PreparedScene,
        clips: &ActiveClips<'_>,
        snapshot: &Snapshot,
        seconds: f32,
    ) {
        let (split, moves) = (scene.split(), clips.moves(self.song_time));
        let begin = scene.resources.world().blended.unwrap_or(0);
        for (slider, knob) in scene.knobs.iter().filter(|(_, knob)| knob.place >= begin) {
            let (param, directed) = (param_of(slider), moves.of(knob, &slider.name, split));
            if let Some(binding) = snapshot.bindings.get(param.name) {
                self.model.bind(&knob.scene, &param, binding.clone(), seconds, directed, self.now);
            } else if let Some(to) = snapshot.sliders.get(param.name) {
                let turn = Turn { to: *to, seconds, changed_by: ChangedBy::Slider };
                self.model.morph(&knob.scene, &param, turn, directed, self.now);
            }
        }
        self.update_sliders(scene, clips);
        self.revision += 1;
    }

    fn bindings(&self, scene: &PreparedScene, title: &str) -> BTreeMap<String, SoundBinding> {
        let mut bindings = self.model.bindings(title);
        bindings.retain(|name, _| scene.knobs.place_of(name).is_some());
        bindings
    }

    /// The value to which a parameter moves, and the controller that set this value.
    pub(super) fn target(
        &self,
        scene: &PreparedScene,
        clips: &ActiveClips<'_>,
        name: &str,
    ) -> Option<(f32, ChangedBy)> {
        let (slider, knob) = scene.knobs.get(scene.knobs.place_of(name)?)?;
        let directed = clips.moves(self.song_time).of(knob, &slider.name, scene.split());
        Some((self.model.target(&knob.scene, &param_of(slider), directed), slider.changed_by))
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

    /// The parameters of a scene that differ from its text, and the bindings.
    pub(super) fn moved(&self, scene: &PreparedScene) -> Snapshot {
        let title = scene.title();
        let turned = self.model.turned(&title).filter(|(name, value, _)| {
            let slider = scene.knobs.sliders.iter().find(|slider| slider.name == *name);
            slider.is_some_and(|slider| slider.default.to_bits() != value.to_bits())
        });
        let sliders = turned.map(|(name, value, _)| (name.to_owned(), value)).collect();
        Snapshot { sliders, bindings: self.bindings(scene, &title) }
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
        let (split, moves) = (scene.split(), clips.moves(time));
        let read = |(slider, knob): (&mariana_control::Slider, &super::knobs::Knob)| {
            let directed = moves.of(knob, &slider.name, split);
            self.model.read(&knob.scene, &param_of(slider), directed, self.now)
        };
        scene.knobs.iter().map(read).collect()
    }

    /// Sets values for the numbers of a text. Only numbers with a range change.
    pub(crate) fn turn_numbers(&mut self, file: &Path, values: Vec<(usize, f32)>) {
        self.turned = Some(TurnedNumbers { file: file.to_owned(), values });
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
        let clips = ActiveClips::default();
        assert!(
            !parameters.turn(&mut scene, &clips, &change("width", 2.0, ChangedBy::Midi)),
            "no such parameter"
        );
        assert_eq!(parameters.revision, 0);
        assert!(parameters.turn(&mut scene, &clips, &change("size", 2.5, ChangedBy::Midi)));
        assert_eq!(parameters.numbers(&scene, &clips, 0.0), [2.5]);
        assert_eq!(parameters.target(&scene, &clips, "size"), Some((2.5, ChangedBy::Midi)));
        assert!(parameters.revision > 0, "the same moment looks different");
        let moved = parameters.moved(&scene);
        assert_eq!(moved.sliders.get("size"), Some(&2.5));
        // A slider moved back to the text's default follows the text again.
        if let Some(slider) = scene.knobs.sliders.first_mut() {
            slider.value = slider.default;
        }
        parameters.record_moved(&mut scene, &clips);
        assert_eq!(parameters.target(&scene, &clips, "size"), Some((1.0, ChangedBy::Text)));
        assert_eq!(parameters.moved(&scene), Snapshot::default());
        let mut again = Parameters::new(Model::default(), Instant::now());
        again.remember(&scene.title(), &moved);
        assert_eq!(again.numbers(&scene, &clips, 0.0), [2.5]);
    }
}
