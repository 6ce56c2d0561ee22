//! What a show does with the parameters of a scene at a moment.

use super::knobs::Knob;
use crate::show::{Clip, Moved};
use mariana_control::Directed;

/// The stays that move a scene's parameters at a moment; in a blend one for each of the two worlds.
#[derive(Default)]
pub(super) struct ActiveClips<'a> {
    /// That of the scene, or in a blend of the scene that goes.
    pub first: Option<&'a Clip>,
    /// In a blend that of the scene that comes.
    pub second: Option<&'a Clip>,
}

/// The values that a show gives parameters at a moment, by their names.
pub(super) struct Moves<'a> {
    first: Vec<Moved<'a>>,
    second: Vec<Moved<'a>>,
}

impl<'a> ActiveClips<'a> {
    /// The moves at `time` seconds of the song.
    pub(super) fn moves(&self, time: f64) -> Moves<'a> {
        let of = |clip: Option<&'a Clip>| clip.map(|clip| clip.moved_at(time)).unwrap_or_default();
        Moves { first: of(self.first), second: of(self.second) }
    }

    /// That of the scene which is seen, in a blend of the one that comes.
    pub(super) fn last(&self) -> Option<&'a Clip> {
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
