//! The parameters of scenes, whoever turns them: all hands turn one model, and sliders and pictures read it.
//!
//! Pictures are drawn with the values of one moment: it is noted between two pictures, never within one.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use super::active_clips::ActiveClips;
use super::knobs::param_of;
use super::prepared_scene::PreparedScene;
use crate::clock;
use mariana_control::{ChangedBy, Model, ParamChange, Reading, Turn};

/// See the module.
pub(crate) struct Parameters {
    model: Model,
    /// The zero of the model's seconds.
    begun: Instant,
    /// The moment of what is shown, in those seconds.
    now: f64,
    /// The same in seconds of the song.
    song_time: f64,
    /// The numbers of a text that a hand turns.
    turned: Option<TurnedNumbers>,
    /// Counts the changes that make the same moment look different.
    revision: u64,
}

/// Numbers of a file's text, by where their digits begin in the text that was loaded. Their values go into the frame, and
/// nothing is read or compiled.
#[derive(Debug, Clone, PartialEq)]
struct TurnedNumbers {
    file: PathBuf,
    values: Vec<(usize, f32)>,
}

impl Parameters {
    /// Those that hands have turned as `model` says, whose seconds began at `begun`.
    pub(super) fn new(model: Model, begun: Instant) -> Self {
        let now = clock::since(begun).as_secs_f64();
        Self { model, begun, now, song_time: 0.0, turned: None, revision: 0 }
    }

    /// What outlives the session: what hands have turned, and the zero of its seconds.
    pub(super) fn kept(self) -> (Model, Instant) {
        (self.model, self.begun)
    }

    /// Goes on with what hands have turned elsewhere.
    pub(super) fn take_over(&mut self, (model, begun): (Model, Instant)) {
        *self = Self { revision: self.revision, turned: self.turned.take(), ..Self::new(model, begun) };
    }

    /// A number that changes whenever the same moment looks different because of parameters.
    pub(super) fn revision(&self) -> u64 {
        self.revision
    }

    /// The moment of what is shown, in seconds of the song.
    pub(super) fn song_time(&self) -> f64 {
        self.song_time
    }

    /// Goes on to this moment of the song.
    pub(super) fn go_to(&mut self, song_time: f64) {
        (self.now, self.song_time) = (clock::since(self.begun).as_secs_f64(), song_time);
    }

    /// Notes that parameters are on their way to where hands have turned them.
    pub(super) fn note_turning(&mut self) {
        self.revision += 1;
    }

    /// Whether a parameter of a scene is on its way to where a hand has turned it.
    pub(super) fn is_turning(&self, scene: &PreparedScene) -> bool {
        scene.knobs.titles().into_iter().any(|title| self.model.moves(title, self.now))
    }

    /// Brings the sliders of a scene up to date, which shows in these stays.
    pub(super) fn update_sliders(&mut self, scene: &mut PreparedScene, clips: &ActiveClips<'_>) {
        let readings = self.read(scene, clips, self.song_time);
        let mut is_turned = false;
        for (slider, reading) in scene.knobs.sliders_mut().iter_mut().zip(readings) {
            // What a show moves is drawn anew in any case.
            is_turned |=
                slider.value.to_bits() != reading.value.to_bits() && reading.changed_by != ChangedBy::Show;
            (slider.value, slider.changed_by) = (reading.value, reading.changed_by);
        }
        if is_turned {
            self.revision += 1;
        }
    }

    /// Turns a parameter of a scene by its name, if there is one; in a blend, the one of the scene that comes. Returns
    /// whether there is.
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

    /// Takes over what the user did to the sliders of a scene.
    pub(super) fn note_moved(&mut self, scene: &mut PreparedScene, clips: &ActiveClips<'_>) {
        let before = self.read(scene, clips, self.song_time);
        let moved: Vec<(usize, f32)> = (scene.knobs.sliders().iter().zip(before).enumerate())
            .filter(|(_, (slider, before))| slider.value.to_bits() != before.value.to_bits())
            .map(|(place, (slider, _))| (place, slider.value))
            .collect();
        for (place, to) in moved {
            self.turn_at(scene, clips, place, Turn { to, seconds: 0.0, changed_by: ChangedBy::Slider });
        }
        self.revision += 1;
    }

    /// Turns the parameter of a slider. One that is put back by hand to where the text has it is the text's again.
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

    /// Where a parameter of a scene goes, or stands, and who holds it.
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

    /// Moves sliders of the scene with this title as they were moved before, by their names.
    pub(crate) fn remember(&mut self, title: &str, moved: &BTreeMap<String, f32>) {
        for (name, value) in moved {
            self.model.remember(title, name, *value);
        }
    }

    /// The parameters of a scene that hands have turned, by their names.
    pub(super) fn moved(&self, scene: &PreparedScene) -> BTreeMap<String, f32> {
        let title = scene.title();
        let turned = self.model.turned(&title).filter(|(name, value, _)| {
            let slider = scene.knobs.sliders().iter().find(|slider| slider.name == *name);
            slider.is_some_and(|slider| slider.default.to_bits() != value.to_bits())
        });
        turned.map(|(name, value, _)| (name.to_owned(), value)).collect()
    }

    /// All parameters of a scene at `time` seconds of the song: those that hands can turn as they and the stays have them,
    /// the others as in the text.
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

    /// Gives numbers of a text values, in a scene in which they have a range.
    pub(crate) fn turn_numbers(&mut self, file: &Path, values: Vec<(usize, f32)>) {
        self.turned = Some(TurnedNumbers { file: file.to_owned(), values });
        self.revision += 1;
    }

    /// Puts the values of the numbers that a hand turns among the parameters of a scene, if they are some of them.
    fn turn_in(&self, scene: &PreparedScene, numbers: &mut [f32]) {
        let world = scene.resources.world();
        let Some(turned) = &self.turned else { return };
        if world.blended.is_some() || scene.source.file() != Some(&turned.file) {
            return;
        }
        // Once the hand has let go, the numbers have no range.
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
    fn what_a_hand_turns_is_in_the_next_picture_and_remembered_by_the_scenes_title() {
        let context = Headless::new(false).unwrap();
        let mut scene = uploaded(context.gl(), 0, &text(BALL));
        let mut parameters = Parameters::new(Model::default(), Instant::now());
        let clips = ActiveClips::default();
        assert!(
            !parameters.turn(&mut scene, &clips, &change("width", 2.0, ChangedBy::Midi)),
            "there is none"
        );
        assert_eq!(parameters.revision(), 0);
        assert!(parameters.turn(&mut scene, &clips, &change("size", 2.5, ChangedBy::Midi)));
        assert_eq!(parameters.numbers(&scene, &clips, 0.0), [2.5]);
        assert_eq!(parameters.target(&scene, &clips, "size"), Some((2.5, ChangedBy::Midi)));
        assert!(parameters.revision() > 0, "the same moment looks different");
        let moved = parameters.moved(&scene);
        assert_eq!(moved.get("size"), Some(&2.5));
        // A slider that is put back to where the text has it is the text's again.
        if let Some(slider) = scene.knobs.sliders_mut().first_mut() {
            slider.value = slider.default;
        }
        parameters.note_moved(&mut scene, &clips);
        assert_eq!(parameters.target(&scene, &clips, "size"), Some((1.0, ChangedBy::Text)));
        assert!(parameters.moved(&scene).is_empty());
        // In the next run.
        let mut again = Parameters::new(Model::default(), Instant::now());
        again.remember(&scene.title(), &moved);
        assert_eq!(again.numbers(&scene, &clips, 0.0), [2.5]);
    }
}
