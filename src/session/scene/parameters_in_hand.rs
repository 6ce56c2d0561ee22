//! Read and write access to the parameters of the scene in hand, which sliders and controllers change: the shown scene,
//! or the scene on one of two decks.

use super::active_clips::ActiveClips;
use super::parameters::Parameters;
use super::prepared_scene::PreparedScene;
use super::show_follower::ShowFollower;
use crate::config::Snapshot;
use mariana_control::{ChangedBy, ParamChange, Slider, SoundBinding};

/// Read access to the parameters of the scene in hand.
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

    pub(crate) fn are_turning(&self) -> bool {
        self.scene.is_some_and(|scene| self.parameters.is_turning(scene))
    }

    pub(super) fn follow_sound(&self) -> bool {
        self.scene.is_some_and(|scene| self.parameters.follow_sound(scene))
    }

    pub(crate) fn target(&self, name: &str) -> Option<(f32, ChangedBy)> {
        let scene = self.scene?;
        let (clips, _) = self.show.clips(scene, self.parameters.song_time);
        self.parameters.target(scene, &clips, name)
    }

    pub(crate) fn moved(&self) -> Snapshot {
        self.scene.map(|scene| self.parameters.moved(scene)).unwrap_or_default()
    }

    /// A snapshot of the sliders; `None` if the scene has no sliders.
    pub(crate) fn snapshot(&self) -> Option<Snapshot> {
        let scene = self.scene?;
        let (clips, _) = self.show.clips(scene, self.parameters.song_time);
        Some(self.parameters.snapshot(scene, &clips)).filter(|snapshot| !snapshot.sliders.is_empty())
    }
}

/// Write access to the parameters of the scene in hand.
pub(crate) struct TurnedParameters<'a> {
    pub(super) scene: Option<&'a mut PreparedScene>,
    pub(super) show: &'a ShowFollower,
    pub(super) parameters: &'a mut Parameters,
}

impl TurnedParameters<'_> {
    fn with<T>(self, act: impl FnOnce(&mut Parameters, &mut PreparedScene, &ActiveClips) -> T) -> Option<T> {
        let scene = self.scene?;
        let (clips, _) = self.show.clips(scene, self.parameters.song_time);
        Some(act(self.parameters, scene, &clips))
    }

    pub(super) fn update_sliders(self) {
        self.with(|parameters, scene, clips| parameters.update_sliders(scene, clips));
    }

    pub(crate) fn turn(self, change: &ParamChange) -> bool {
        self.with(|parameters, scene, clips| parameters.turn(scene, clips, change)).unwrap_or(false)
    }

    pub(crate) fn bind(self, name: &str, binding: Option<SoundBinding>) -> bool {
        self.with(|parameters, scene, clips| parameters.bind(scene, clips, name, binding)).unwrap_or(false)
    }

    pub(crate) fn recall(self, snapshot: &Snapshot, seconds: f32) {
        self.with(|parameters, scene, clips| parameters.recall(scene, clips, snapshot, seconds));
    }

    pub(crate) fn record_moved(self) {
        self.with(|parameters, scene, clips| parameters.record_moved(scene, clips));
    }
}
