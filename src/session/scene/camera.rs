//! The user's hand at the camera of the scene.

use super::stays::Stays;
use crate::frame::orbit_controls::OrbitControls;

/// See the module.
pub(super) struct SceneCamera {
    hand: OrbitControls,
    /// How the camera was moved in the last picture, by the hand or by a show.
    shown: OrbitControls,
    /// How far above its target the scene's own camera was in the last picture, in radians.
    own_pitch: f64,
    /// Counts the moves.
    revision: u64,
}

impl Default for SceneCamera {
    fn default() -> Self {
        Self { hand: OrbitControls::OFF, shown: OrbitControls::OFF, own_pitch: 0.0, revision: 0 }
    }
}

impl SceneCamera {
    /// Moves it by hand, from where a show has it. Returns what is said of the first move.
    pub(super) fn move_by(&mut self, change: impl FnOnce(&mut OrbitControls, f64)) -> Option<&'static str> {
        let was_off = self.hand == OrbitControls::OFF;
        if was_off {
            self.hand = self.shown;
        }
        change(&mut self.hand, self.own_pitch);
        self.revision += 1;
        (was_off && self.hand != OrbitControls::OFF)
            .then_some("you are moving the camera: press Home to return to the scene's own")
    }

    /// Gives it back to the scene. Returns what is said.
    pub(super) fn give_back(&mut self) -> &'static str {
        self.hand = OrbitControls::OFF;
        self.revision += 1;
        "the scene's own camera"
    }

    /// Another scene shows, whose camera no hand has moved.
    pub(super) fn forget(&mut self) {
        self.hand = OrbitControls::OFF;
    }

    /// How the hand has moved it.
    pub(super) fn hand(&self) -> OrbitControls {
        self.hand
    }

    /// How it is moved at `time` seconds of the song: by the hand, or else as a show turns it.
    pub(super) fn at(&self, stays: &Stays<'_>, time: f64) -> OrbitControls {
        match stays.last() {
            Some(stay) if self.hand == OrbitControls::OFF => OrbitControls::of_turns(stay.turns_at(time)),
            _ => self.hand,
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
        assert!(camera.move_by(|hand, _| hand.zoom(1.0)).is_some());
        let mut wanted = turned;
        wanted.zoom(1.0);
        assert_eq!(camera.at(&Stays::default(), 0.0), wanted);
        assert!(camera.move_by(|hand, _| hand.zoom(1.0)).is_none(), "once");
        camera.give_back();
        assert_eq!((camera.hand(), camera.revision()), (OrbitControls::OFF, 3));
    }
}
