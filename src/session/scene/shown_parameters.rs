//! Read and write access to the parameters of the shown scene.

use std::collections::BTreeMap;

use super::parameters::Parameters;
use super::prepared_scene::PreparedScene;
use super::show_follower::ShowFollower;
use mariana_control::{ChangedBy, ParamChange};

/// Read access to the parameters of the shown scene.
pub(crate) struct ShownParameters<'a> {
    pub(super) scene: Option<&'a PreparedScene>,
    pub(super) show: &'a ShowFollower,
    pub(super) parameters: &'a Parameters,
}

impl ShownParameters<'_> {
    pub(crate) fn are_turning(&self) -> bool {
        self.scene.is_some_and(|scene| self.parameters.is_turning(scene))
    }

    pub(crate) fn target(&self, name: &str) -> Option<(f32, ChangedBy)> {
        let scene = self.scene?;
        let (clips, _) = self.show.clips(scene, self.parameters.song_time());
        self.parameters.target(scene, &clips, name)
    }

    pub(crate) fn moved(&self) -> BTreeMap<String, f32> {
        self.scene.map(|scene| self.parameters.moved(scene)).unwrap_or_default()
    }
}

/// Write access to the parameters of the shown scene.
pub(crate) struct TurnedParameters<'a> {
    pub(super) scene: Option<&'a mut PreparedScene>,
    pub(super) show: &'a ShowFollower,
    pub(super) parameters: &'a mut Parameters,
}

impl TurnedParameters<'_> {
    pub(super) fn update_sliders(self) {
        if let Some(scene) = self.scene {
            let (clips, _) = self.show.clips(scene, self.parameters.song_time());
            self.parameters.update_sliders(scene, &clips);
        }
    }

    pub(crate) fn turn(self, change: &ParamChange) -> bool {
        let Some(scene) = self.scene else { return false };
        let (clips, _) = self.show.clips(scene, self.parameters.song_time());
        self.parameters.turn(scene, &clips, change)
    }

    pub(crate) fn note_moved(self) {
        if let Some(scene) = self.scene {
            let (clips, _) = self.show.clips(scene, self.parameters.song_time());
            self.parameters.note_moved(scene, &clips);
        }
    }
}
