//! The change from one scene to another, by a show or the user. Both scenes keep moving during the fade, as in a video
//! of the show. The outgoing scene is drawn first, for the same moment of the song, and a fraction of its light is
//! mixed into the incoming scene. If the outgoing scene is no longer loaded or too slow, its last frame fades out
//! ([`super::fading`]).
//!
//! A scene that the user leaves keeps its parameter values, because controllers now act on the incoming scene.

use std::time::Duration;

use super::active_clips::ActiveClips;
use super::parameters::Parameters;
use super::prepared_scene::PreparedScene;
use super::prepared_scenes::Place;
use super::regions::Shown;
use super::show_follower::{Outgoing, ShowFollower};
use crate::frame::orbit_controls::OrbitControls;
use crate::scenes::{SceneSource, camera_number};
use crate::show::Clip;
use mariana_control::ChangedBy;
use mariana_music::Sound;

/// If a frame of the outgoing scene takes longer than this, only its last frame fades out.
const LIVE_MAX: Duration = Duration::from_millis(100);

#[derive(Default)]
pub(super) struct SceneChange {
    /// The frame in progress, whose outgoing scene is drawn first.
    pub(super) begun: Option<Begun>,
    /// The scene that the user left, if the scene keeps moving while it fades out.
    pub(super) left: Option<LeftScene>,
    orbit: OrbitControls,
}

pub(super) struct LeftScene {
    pub source: SceneSource,
    clip: Option<Clip>,
    numbers: Vec<f32>,
    /// Indices and names of the parameters that the show still moves.
    moved: Vec<(usize, String)>,
}

pub(super) struct Begun {
    pub shown: Shown,
    pub sound: Sound,
    /// Drawing time of the outgoing scene; `None` until the scene is drawn.
    pub lit: Option<Duration>,
}

impl SceneChange {
    /// Returns the frame in progress if it equals `wanted` apart from its moment; otherwise `wanted`.
    pub(super) fn resume(&mut self, wanted: Shown, sound: Sound) -> (Shown, Sound) {
        let goes_on = |begun: &Begun| begun.shown == Shown { moment: begun.shown.moment, ..wanted };
        match self.begun.as_ref().filter(|begun| goes_on(begun)) {
            Some(begun) => (begun.shown, begun.sound.clone()),
            None => {
                self.begun = None;
                (wanted, sound)
            }
        }
    }

    /// Saves the state of the outgoing scene. `took` is the time of its last frame, `orbit` its camera motion.
    pub(super) fn save_outgoing(
        &mut self,
        scene: &PreparedScene,
        took: Duration,
        orbit: OrbitControls,
        show: &ShowFollower,
        parameters: &Parameters,
    ) {
        self.orbit = orbit;
        let time = parameters.song_time;
        let clips = show.clips(&scene.source, time);
        if clips.fraction.is_some() || took > LIVE_MAX {
            self.left = None;
            return;
        }
        let mut numbers = parameters.numbers(scene, &clips, time);
        let mut moved = Vec::new();
        for (slider, knob) in scene.knobs.iter() {
            if let Some(number) = numbers.get_mut(knob.place) {
                // Keep the value that the parameter had in the last frame.
                *number = slider.value;
            }
            if slider.changed_by == ChangedBy::Show {
                moved.push((knob.place, slider.name.clone()));
            }
        }
        let clip = clips.first.cloned();
        self.left = Some(LeftScene { source: scene.source.clone(), clip, numbers, moved });
    }

    /// The parameters of the outgoing scene at `time` seconds of the song, and the number of its camera.
    pub(super) fn numbers(
        &self,
        scene: &PreparedScene,
        outgoing: &Outgoing,
        time: f64,
        parameters: &Parameters,
    ) -> (Vec<f32>, Option<usize>) {
        let world = scene.resources.world();
        let camera = |clip: &Clip| camera_number(world, clip.camera.as_deref());
        if let Some(clip) = &outgoing.clip {
            let clips = ActiveClips { first: Some(clip), ..ActiveClips::default() };
            return (parameters.numbers(scene, &clips, time), camera(clip));
        }
        let Some(left) = &self.left else { return Default::default() };
        let mut numbers = left.numbers.clone();
        for (place, name) in &left.moved {
            let moved = left.clip.as_ref().and_then(|clip| clip.moved(name, time));
            if let Some((number, moved)) = numbers.get_mut(*place).zip(moved) {
                *number = moved.value;
            }
        }
        (numbers, left.clip.as_ref().and_then(camera))
    }

    /// The camera motion of the outgoing scene at `time` seconds of the song: as the user left it, or as
    /// the show turns it. `orbit` is the user's motion in the shown scene.
    pub(super) fn camera(&self, outgoing: &Outgoing, time: f64, orbit: OrbitControls) -> OrbitControls {
        let by_hand = if outgoing.place == Place::Shown { orbit } else { self.orbit };
        let left = self.left.as_ref().and_then(|left| left.clip.as_ref());
        match outgoing.clip.as_ref().or(left) {
            Some(clip) if by_hand == OrbitControls::OFF => OrbitControls::of_turns(clip.turns_at(time)),
            _ => by_hand,
        }
    }
}
