//! The user's control of the scene's camera.

use super::active_clips::ActiveClips;
use crate::frame::orbit_controls::OrbitControls;

#[derive(Default)]
pub(super) struct SceneCamera {
    pub(super) orbit: OrbitControls,
    /// The motion of the camera in the last frame.
    pub(super) shown: OrbitControls,
    /// The pitch of the scene's own camera above its target in the last frame, in radians.
    pub(crate) own_pitch: f64,
    pub(super) revision: u64,
}

impl SceneCamera {
    /// Moves the camera by hand, starting from the show's motion. The first move returns a message.
    pub(super) fn move_by(&mut self, change: impl FnOnce(&mut OrbitControls, f64)) -> Option<&'static str> {
        let was_off = self.orbit == OrbitControls::OFF;
        if was_off {
            self.orbit = self.shown;
        }
        change(&mut self.orbit, self.own_pitch);
        self.revision += 1;
        (was_off && self.orbit != OrbitControls::OFF)
            .then_some("you are moving the camera: press Home to return to the scene's camera")
    }

    pub(super) fn give_back(&mut self) -> &'static str {
        self.orbit = OrbitControls::OFF;
        self.revision += 1;
        "the scene's own camera"
    }

    /// Returns the camera motion at `time` seconds of the song: the user's, or otherwise the show's.
    pub(super) fn at(&self, clips: &ActiveClips<'_>, time: f64) -> OrbitControls {
        match clips.last() {
            Some(clip) if self.orbit == OrbitControls::OFF => OrbitControls::of_turns(clip.turns_at(time)),
            _ => self.orbit,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_move_starts_from_the_shows_camera_and_explains_how_to_return() {
        let turned = OrbitControls::of_turns([0.25, 0.0, 1.0]);
        let mut camera = SceneCamera { shown: turned, ..SceneCamera::default() };
        assert!(camera.move_by(|orbit, _| orbit.zoom(1.0)).is_some());
        let mut wanted = turned;
        wanted.zoom(1.0);
        assert_eq!(camera.at(&ActiveClips::default(), 0.0), wanted);
        assert!(camera.move_by(|orbit, _| orbit.zoom(1.0)).is_none(), "once");
        camera.give_back();
        assert_eq!((camera.orbit, camera.revision), (OrbitControls::OFF, 3));
    }
}
