//! The clips of a show that set the parameters of a scene at a moment of the song.

use super::knobs::Knob;
use crate::show::{Clip, Moved};
use mariana_control::Directed;

/// The active clips of a scene; in a blend, one for each of its two worlds.
#[derive(Default)]
pub(super) struct ActiveClips<'a> {
    /// The clip of the scene; in a blend, the outgoing scene's clip.
    pub first: Option<&'a Clip>,
    /// In a blend, the incoming scene's clip.
    pub second: Option<&'a Clip>,
}

pub(super) struct Moves<'a> {
    first: Vec<Moved<'a>>,
    second: Vec<Moved<'a>>,
}

impl<'a> ActiveClips<'a> {
    pub(super) fn moves(&self, time: f64) -> Moves<'a> {
        let of = |clip: Option<&'a Clip>| clip.map(|clip| clip.moved_at(time)).unwrap_or_default();
        Moves { first: of(self.first), second: of(self.second) }
    }

    /// Returns the clip of the visible scene; in a blend, the incoming scene's clip.
    pub(super) fn last(&self) -> Option<&'a Clip> {
        self.second.or(self.first)
    }
}

impl Moves<'_> {
    /// Returns the show's value for a knob's parameter. The first `split` parameters belong to the outgoing scene.
    pub(super) fn of(&self, knob: &Knob, name: &str, split: usize) -> Option<Directed> {
        let moves = if knob.place < split { &self.first } else { &self.second };
        let moved = moves.iter().find(|moved| moved.name == name)?;
        Some(Directed { value: moved.value, part: moved.part })
    }
}
