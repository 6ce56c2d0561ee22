//! What a show does with the parameters of a scene at a moment.

use super::knobs::Knob;
use crate::show::{Moved, Stay};
use mariana_control::Directed;

/// The stays that move a scene's parameters at a moment; in a blend one for each of the two worlds.
#[derive(Default)]
pub(super) struct Stays<'a> {
    /// That of the scene, or in a blend of the scene that goes.
    pub first: Option<&'a Stay>,
    /// In a blend that of the scene that comes.
    pub second: Option<&'a Stay>,
}

/// The values that a show gives parameters at a moment, by their names.
pub(super) struct Moves<'a> {
    first: Vec<Moved<'a>>,
    second: Vec<Moved<'a>>,
}

impl<'a> Stays<'a> {
    /// The moves at `time` seconds of the song.
    pub(super) fn moves(&self, time: f64) -> Moves<'a> {
        let of = |stay: Option<&'a Stay>| stay.map(|stay| stay.moved_at(time)).unwrap_or_default();
        Moves { first: of(self.first), second: of(self.second) }
    }

    /// That of the scene which is seen, in a blend of the one that comes.
    pub(super) fn last(&self) -> Option<&'a Stay> {
        self.second.or(self.first)
    }
}

impl Moves<'_> {
    /// What the show does with the parameter of a knob, in a scene of which `split` parameters belong to the scene that
    /// goes.
    pub(super) fn of(&self, knob: &Knob, name: &str, split: usize) -> Option<Directed> {
        let moves = if knob.place < split { &self.first } else { &self.second };
        let moved = moves.iter().find(|moved| moved.name == name)?;
        Some(Directed { value: moved.value, part: moved.part })
    }
}
