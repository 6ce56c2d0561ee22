//! The user's hand at the camera of the scene.

use super::active_clips::ActiveClips;
use crate::frame::orbit_controls::OrbitControls;

/// See the module.
pub(super) struct SceneCamera {
    orbit: OrbitControls,
    /// How the camera was moved in the last picture, by the hand or by a show.
    shown: OrbitControls,
    /// How far above its target the scene's own camera was in the last picture, in radians.
    own_pitch: f64,
    /// Counts the moves.
    revision: u64,
}

impl Default for SceneCamera {
    fn default() -> Self {
        Self { orbit: OrbitControls::OFF, shown: OrbitControls::OFF, own_pitch: 0.0, revision: 0 }
    }
}

impl SceneCamera {
    /// Moves it by hand, from where a show has it. Returns what is said of the first move.
    pub(super) fn move_by(&mut self, change: impl FnOnce(&mut OrbitControls, f64)) -> Option<&'static str> {
        let was_off = self.orbit == OrbitControls::OFF;
        if was_off {
            self.orbit = self.shown;
        }
        change(&mut self.orbit, self.own_pitch);
        self.revision += 1;
        (was_off && self.orbit != OrbitControls::OFF)
            .then_some("you are moving the camera: press Home to return to the scene's own")
    }

    /// Gives it back to the scene. Returns what is said.
    pub(super) fn give_back(&mut self) -> &'static str {
        self.orbit = OrbitControls::OFF;
        self.revision += 1;
        "the scene's own camera"
    }

    /// Another scene shows, whose camera no hand has moved.
    pub(super) fn forget(&mut self) {
        self.orbit = OrbitControls::OFF;
    }

    /// How the hand has moved it.
    pub(super) fn orbit(&self) -> OrbitControls {
        self.orbit
    }

    /// How it is moved at `time` seconds of the song: by the hand, or else as a show turns it.
    pub(super) fn at(&self, clips: &ActiveClips<'_>, time: f64) -> OrbitControls {
        match clips.last() {
            Some(clip) if self.orbit == OrbitControls::OFF => OrbitControls::of_turns(clip.turns_at(time)),
            _ => self.orbit,
        }
    }

    /// Notes how it is moved in a picture that is begun.
    pub(super) fn note_shown(&mut self, shown: OrbitControls) {
        self.shown = shown;
    }

    /// Notes how far above its target the scene's own camera is, in radians.
    pub(super) fn note_own_pitch(&mut self, pitch: f64) {
        self.own_pitch = pitch;
    }

    /// A number that changes with each move.
    pub(super) fn revision(&self) -> u64 {
        self.revision
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_move_begins_where_a_show_has_the_camera_and_says_how_to_return() {
        let mut camera = SceneCamera::default();
        let turned = OrbitControls::of_turns([0.25, 0.0, 1.0]);
        camera.note_shown(turned);
        assert!(camera.move_by(|orbit, _| orbit.zoom(1.0)).is_some());
        let mut wanted = turned;
        wanted.zoom(1.0);
        assert_eq!(camera.at(&ActiveClips::default(), 0.0), wanted);
        assert!(camera.move_by(|orbit, _| orbit.zoom(1.0)).is_none(), "once");
        camera.give_back();
        assert_eq!((camera.orbit(), camera.revision()), (OrbitControls::OFF, 3));
    }
}
