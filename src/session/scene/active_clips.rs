//! The clips of a show that set the parameters of a scene at a moment of the song.

use super::knobs::Knob;
use super::prepared_scene::PreparedScene;
use crate::show::Clip;
use mariana_control::{Directed, Slider};

/// The active clips of a scene; in a blend, one for each of its two worlds.
#[derive(Default)]
pub(super) struct ActiveClips<'a> {
    /// The clip of the scene; in a blend, the outgoing scene's clip.
    pub first: Option<&'a Clip>,
    /// In a blend, the incoming scene's clip.
    pub second: Option<&'a Clip>,
    /// In a blend, the fraction of the incoming scene.
    pub fraction: Option<f32>,
}

impl<'a> ActiveClips<'a> {
    /// Returns the clip of the visible scene; in a blend, the incoming scene's clip.
    pub(super) fn last(&self) -> Option<&'a Clip> {
        self.second.or(self.first)
    }

    /// Returns what the first and the second clip set at `time` seconds of the song: names of parameters and their values.
    pub(super) fn all_directed(&self, time: f64) -> [Vec<(&'a str, Directed)>; 2] {
        [self.first, self.second].map(|clip| {
            let moved = clip.map(|clip| clip.all_moved(time)).unwrap_or_default();
            let directed = moved.into_iter();
            directed.map(|(name, moved)| (name, Directed { value: moved.value, part: moved.part })).collect()
        })
    }

    /// Returns the show's value for the parameter of a knob of `scene`, at `time` seconds of the song.
    pub(super) fn directed(
        &self,
        scene: &PreparedScene,
        slider: &Slider,
        knob: &Knob,
        time: f64,
    ) -> Option<Directed> {
        let clip = if knob.place < scene.split() { self.first } else { self.second };
        let moved = clip?.moved(&slider.name, time)?;
        Some(Directed { value: moved.value, part: moved.part })
    }
}
