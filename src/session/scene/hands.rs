//! Hands on the parameters of scenes: all of them turn one model, and sliders and pictures read it.
//!
//! Pictures are drawn with the values of one moment: it is noted between two pictures, never within one.

use std::collections::BTreeMap;
use std::rc::Rc;
use std::time::Instant;

use super::{Cast, SceneStage};
use crate::scenes::{ReadyScene, SceneSource};
use crate::show::{Moved, Stay};
use mariana_control::{Directed, Hand, Model, Param, ParamWish, Reading, Slider, Turn};

/// What the stage knows of hands.
pub(super) struct Hands {
    pub(super) model: Model,
    /// The zero of the model's seconds.
    begun: Instant,
    /// The moment of what is shown, in those seconds.
    now: f64,
    /// The same in seconds of the song.
    song_time: f64,
}

impl Hands {
    /// Hands that have turned what `model` holds.
    pub(super) fn new(model: Model, begun: Instant) -> Self {
        Self { model, begun, now: begun.elapsed().as_secs_f64(), song_time: 0.0 }
    }

    /// The moment of what is shown, in seconds of the song.
    pub(super) fn song_time(&self) -> f64 {
        self.song_time
    }

    /// What outlives the stage.
    pub(super) fn kept(self) -> (Model, Instant) {
        (self.model, self.begun)
    }
}

/// Which parameter a slider turns.
pub(super) struct Knob {
    /// Its place among those of the world.
    pub(super) place: usize,
    /// The title of the scene that it belongs to.
    scene: Rc<str>,
}

/// The stays that move a scene's parameters at a moment; in a blend one for each of the two worlds.
#[derive(Default)]
pub(super) struct Stays<'a> {
    pub(super) first: Option<&'a Stay>,
    pub(super) second: Option<&'a Stay>,
}

/// The sliders of a scene, and what each turns.
pub(super) fn sliders_of(source: &SceneSource, ready: &ReadyScene) -> (Vec<Slider>, Vec<Knob>) {
    let title: Rc<str> = source.title().into();
    let leaving: Option<(usize, Rc<str>)> = match (source, ready.world.blended) {
        (SceneSource::Blend(blend), Some(split)) => Some((split, blend.from.source.title().into())),
        _ => None,
    };
    let params = ready.world.scene.params.iter().enumerate().filter(|(_, param)| !param.is_number);
    params
        .map(|(place, param)| {
            let scene = leaving.as_ref().filter(|(split, _)| place < *split).map_or(&title, |(_, from)| from);
            let slider = Slider {
                name: param.name.clone(),
                value: param.default,
                min: param.min,
                max: param.max,
                default: param.default,
                hand: Hand::Text,
            };
            (slider, Knob { place, scene: scene.clone() })
        })
        .unzip()
}

fn param_of(slider: &Slider) -> Param<'_> {
    Param { name: &slider.name, min: slider.min, max: slider.max, default: slider.default }
}

impl SceneStage {
    /// Goes on to this moment of the song: sliders and the next picture are as hands and show have the parameters now.
    pub(crate) fn follow_hands(&mut self, song_time: f64) {
        if self.mixing.is_begun() {
            // Both scenes of a picture are drawn with the same values.
            return;
        }
        (self.hands.now, self.hands.song_time) = (self.hands.begun.elapsed().as_secs_f64(), song_time);
        self.update_sliders();
        if self.is_turning() {
            self.revision += 1;
        }
    }

    /// Whether a parameter of the scene on the stage is on its way to where a hand has turned it.
    pub(crate) fn is_turning(&self) -> bool {
        let knobs = self.on_stage.iter().flat_map(|cast| &cast.knobs);
        let mut scenes: Vec<&str> = knobs.map(|knob| &*knob.scene).collect();
        scenes.dedup();
        scenes.into_iter().any(|scene| self.hands.model.moves(scene, self.hands.now))
    }

    /// Brings the sliders of the scene on the stage up to date.
    pub(super) fn update_sliders(&mut self) {
        let Some(cast) = &self.on_stage else { return };
        let readings = self.read(cast, &self.stays(cast, self.hands.song_time).0);
        let Some(cast) = &mut self.on_stage else { return };
        let mut is_turned = false;
        for (slider, reading) in cast.sliders.iter_mut().zip(readings) {
            // What a show moves is drawn anew in any case.
            is_turned |= slider.value.to_bits() != reading.value.to_bits() && reading.hand != Hand::Show;
            (slider.value, slider.hand) = (reading.value, reading.hand);
        }
        if is_turned {
            self.revision += 1;
        }
    }

    /// Turns a parameter of the scene on the stage by its name, if there is one. Returns whether there is.
    pub(crate) fn turn(&mut self, wish: &ParamWish) -> bool {
        // In a blend, the one of the scene that comes.
        let place = self
            .on_stage
            .as_ref()
            .and_then(|cast| cast.sliders.iter().rposition(|slider| slider.name == wish.name));
        if let Some(place) = place {
            let to = self.sliders().get(place).map_or(0.0, |slider| wish.to.of(&param_of(slider)));
            self.turn_at(place, Turn { to, seconds: wish.seconds, hand: wish.hand });
        }
        place.is_some()
    }

    /// The parameters of the scene on the stage, in their order.
    pub(crate) fn sliders(&self) -> &[Slider] {
        self.on_stage.as_ref().map_or(&[], |cast| &cast.sliders)
    }

    /// Where a parameter of the scene on the stage goes, or stands, and who holds it.
    pub(crate) fn param_target(&self, name: &str) -> Option<(f32, Hand)> {
        let cast = self.on_stage.as_ref()?;
        let place = cast.sliders.iter().rposition(|slider| slider.name == name)?;
        let (slider, knob) = (cast.sliders.get(place)?, cast.knobs.get(place)?);
        let directed = directed(knob, &slider.name, self.split(cast), &self.moves(cast));
        let target = self.hands.model.target(&knob.scene, &param_of(slider), directed);
        Some((target, slider.hand))
    }

    /// Moves sliders of the scene that was asked for as they were moved before, by their names.
    pub(crate) fn move_sliders(&mut self, moved: &BTreeMap<String, f32>) {
        let title = self.source.title();
        for (name, value) in moved {
            self.hands.model.remember(&title, name, *value);
        }
    }

    /// The parameters of the scene on the stage that hands have turned, by their names.
    pub(crate) fn moved_sliders(&self) -> BTreeMap<String, f32> {
        let Some(cast) = &self.on_stage else { return BTreeMap::new() };
        let title = cast.source.title();
        let turned = self.hands.model.turned(&title).filter(|(name, value, _)| {
            let slider = cast.sliders.iter().find(|slider| slider.name == *name);
            slider.is_some_and(|slider| slider.default.to_bits() != value.to_bits())
        });
        turned.map(|(name, value, _)| (name.to_owned(), value)).collect()
    }

    /// Takes over what the user did to the sliders.
    pub(crate) fn note_moved(&mut self) {
        let Some(cast) = &self.on_stage else { return };
        let before = self.read(cast, &self.stays(cast, self.hands.song_time).0);
        let moved: Vec<(usize, f32)> = (cast.sliders.iter().zip(before).enumerate())
            .filter(|(_, (slider, before))| slider.value.to_bits() != before.value.to_bits())
            .map(|(place, (slider, _))| (place, slider.value))
            .collect();
        for (place, to) in moved {
            self.turn_at(place, Turn { to, seconds: 0.0, hand: Hand::Slider });
        }
        self.revision += 1;
    }

    /// Turns the parameter of a slider. One that is put back by hand to where the text has it is the text's again.
    fn turn_at(&mut self, place: usize, turn: Turn) {
        let Some(cast) = &self.on_stage else { return };
        let Some((slider, knob)) = cast.sliders.get(place).zip(cast.knobs.get(place)) else { return };
        let param = param_of(slider);
        let directed = directed(knob, &slider.name, self.split(cast), &self.moves(cast));
        if turn.hand == Hand::Slider && turn.to == param.default && directed.is_none() {
            self.hands.model.release(&knob.scene, param.name);
        } else {
            self.hands.model.turn(&knob.scene, &param, turn, directed, self.hands.now);
        }
        self.update_sliders();
    }

    /// What all parameters of a scene are: those that hands can turn as they and the stays have them, the others as in
    /// the text.
    pub(super) fn numbers(&self, cast: &Cast, stays: &Stays<'_>, time: f64) -> Vec<f32> {
        let mut numbers: Vec<f32> =
            cast.resources.world().scene.params.iter().map(|param| param.default).collect();
        for (knob, reading) in cast.knobs.iter().zip(self.read_at(cast, stays, time)) {
            if let Some(number) = numbers.get_mut(knob.place) {
                *number = reading.value;
            }
        }
        self.turn_in(cast, &mut numbers);
        numbers
    }

    fn read(&self, cast: &Cast, stays: &Stays<'_>) -> Vec<Reading> {
        self.read_at(cast, stays, self.hands.song_time)
    }

    fn read_at(&self, cast: &Cast, stays: &Stays<'_>, time: f64) -> Vec<Reading> {
        let (split, moves) = (self.split(cast), Moves::of(stays, time));
        let knobs = cast.sliders.iter().zip(&cast.knobs);
        let read = |(slider, knob): (&Slider, &Knob)| {
            let directed = directed(knob, &slider.name, split, &moves);
            self.hands.model.read(&knob.scene, &param_of(slider), directed, self.hands.now)
        };
        knobs.map(read).collect()
    }

    fn split(&self, cast: &Cast) -> usize {
        cast.resources.world().blended.unwrap_or(usize::MAX)
    }

    fn moves(&self, cast: &Cast) -> Moves<'_> {
        Moves::of(&self.stays(cast, self.hands.song_time).0, self.hands.song_time)
    }
}

/// What a show does with parameters at a moment, by their names: those of a scene, or of the two of a blend.
struct Moves<'a> {
    first: Vec<Moved<'a>>,
    second: Vec<Moved<'a>>,
}

impl<'a> Moves<'a> {
    fn of(stays: &Stays<'a>, time: f64) -> Self {
        let of = |stay: Option<&'a Stay>| stay.map(|stay| stay.moved_at(time)).unwrap_or_default();
        Self { first: of(stays.first), second: of(stays.second) }
    }
}

/// What a show does with the parameter of a knob.
fn directed(knob: &Knob, name: &str, split: usize, moves: &Moves<'_>) -> Option<Directed> {
    let moves = if knob.place < split { &moves.first } else { &moves.second };
    let moved = moves.iter().find(|moved| moved.name == name)?;
    Some(Directed { value: moved.value, part: moved.part })
}
