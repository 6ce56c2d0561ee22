//! The parameters of the scene that shows, to be read and to be turned.

use std::collections::BTreeMap;

use super::parameters::Parameters;
use super::prepared_scene::PreparedScene;
use super::show_follower::ShowFollower;
use mariana_control::{ChangedBy, ParamChange};

/// The parameters of the scene that shows.
pub(crate) struct ShownParameters<'a> {
    pub(super) scene: Option<&'a PreparedScene>,
    pub(super) show: &'a ShowFollower,
    pub(super) parameters: &'a Parameters,
}

impl ShownParameters<'_> {
    /// Whether one of them is on its way to where a hand has turned it.
    pub(crate) fn are_turning(&self) -> bool {
        self.scene.is_some_and(|scene| self.parameters.is_turning(scene))
    }

    /// Where one of them goes, or stands, and who holds it.
    pub(crate) fn target(&self, name: &str) -> Option<(f32, ChangedBy)> {
        let scene = self.scene?;
        let (clips, _) = self.show.clips(scene, self.parameters.song_time());
        self.parameters.target(scene, &clips, name)
    }

    /// Those that hands have turned, by their names.
    pub(crate) fn moved(&self) -> BTreeMap<String, f32> {
        self.scene.map(|scene| self.parameters.moved(scene)).unwrap_or_default()
    }
}

/// The same, to be turned.
pub(crate) struct TurnedParameters<'a> {
    pub(super) scene: Option<&'a mut PreparedScene>,
    pub(super) show: &'a ShowFollower,
    pub(super) parameters: &'a mut Parameters,
}

impl TurnedParameters<'_> {
    /// Brings the sliders up to date.
    pub(super) fn update_sliders(self) {
        if let Some(scene) = self.scene {
            let (clips, _) = self.show.clips(scene, self.parameters.song_time());
            self.parameters.update_sliders(scene, &clips);
        }
    }

    /// Turns one of them by its name, if there is one. Returns whether there is.
    pub(crate) fn turn(self, change: &ParamChange) -> bool {
        let Some(scene) = self.scene else { return false };
        let (clips, _) = self.show.clips(scene, self.parameters.song_time());
        self.parameters.turn(scene, &clips, change)
    }

    /// Takes over what the user did to the sliders.
    pub(crate) fn note_moved(self) {
        if let Some(scene) = self.scene {
            let (clips, _) = self.show.clips(scene, self.parameters.song_time());
            self.parameters.note_moved(scene, &clips);
        }
    }
}
