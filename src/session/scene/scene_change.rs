//! The change from one scene to another, of a show and of the user: both scenes go on while one fades into the other, as
//! in a video of the show.
//!
//! ```text
//! the scene that goes, its light alone → kept → the scene that comes, with a share of that light
//! ```
//!
//! Both are drawn at the same moment of the song, one after the other. Where the scene that goes is no longer there, or
//! takes too long, its last picture fades instead ([`super::fading`]).
//!
//! A scene that the user leaves goes on as hands left it: they turn the one that comes.

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

/// A scene whose picture takes longer than this stands still while it goes.
const LIVE_MAX: Duration = Duration::from_millis(100);

/// See the module.
#[derive(Default)]
pub(super) struct SceneChange {
    /// The picture of which the scene that goes was begun.
    begun: Option<Begun>,
    /// How the scene was left that the user left.
    left: Option<LeftScene>,
    /// How the camera was moved by hand in the scene that goes.
    orbit: OrbitControls,
}

/// How a scene was left.
struct LeftScene {
    source: SceneSource,
    /// As a show had it on.
    clip: Option<Clip>,
    /// Its parameters.
    numbers: Vec<f32>,
    /// Places of those that the show moves on, with their names.
    moved: Vec<(usize, String)>,
}

/// A picture of two scenes.
struct Begun {
    shown: Shown,
    sound: Sound,
    /// How long the light of the scene that goes took, once it is kept.
    lit: Option<Duration>,
}

impl SceneChange {
    /// The picture that was begun for `wanted`, or before it and looks the same otherwise; else `wanted`.
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

    /// How long the light of the scene that goes took, if it is kept for the picture that was begun.
    pub(super) fn lit(&self) -> Option<Duration> {
        self.begun.as_ref().and_then(|begun| begun.lit)
    }

    /// The scene that goes is drawn for a picture.
    pub(super) fn begin(&mut self, shown: Shown, sound: Sound) {
        self.begun = Some(Begun { shown, sound, lit: None });
    }

    /// Its light is kept, which took so long.
    pub(super) fn note_light(&mut self, spent: Duration) {
        if let Some(begun) = &mut self.begun {
            begun.lit = Some(spent);
        }
    }

    /// Whether a picture of two scenes was begun and is not finished.
    pub(super) fn is_begun(&self) -> bool {
        self.begun.is_some()
    }

    /// The picture is finished or given up.
    pub(super) fn end(&mut self) {
        self.begun = None;
    }

    /// The scene that the user left, if it goes on.
    pub(super) fn left(&self) -> Option<&SceneSource> {
        self.left.as_ref().map(|left| &left.source)
    }

    /// Notes how the scene that goes was left, of which the last picture took so long, and whose camera was moved by
    /// `orbit`.
    pub(super) fn note_left(
        &mut self,
        scene: &PreparedScene,
        took: Duration,
        orbit: OrbitControls,
        show: &ShowFollower,
        parameters: &Parameters,
    ) {
        self.orbit = orbit;
        let time = parameters.song_time();
        let (clips, fraction) = show.clips(scene, time);
        if fraction.is_some() || took > LIVE_MAX {
            self.left = None;
            return;
        }
        let mut numbers = parameters.numbers(scene, &clips, time);
        let mut moved = Vec::new();
        for (slider, knob) in scene.knobs.iter() {
            if let Some(number) = numbers.get_mut(knob.place) {
                // As they were in its last picture.
                *number = slider.value;
            }
            if slider.changed_by == ChangedBy::Show {
                moved.push((knob.place, slider.name.clone()));
            }
        }
        let clip = clips.first.cloned();
        self.left = Some(LeftScene { source: scene.source.clone(), clip, numbers, moved });
    }

    /// The parameters and the camera's number of what fades out, at `time` seconds of the song.
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
            let clips = ActiveClips { first: Some(clip), second: None };
            return (parameters.numbers(scene, &clips, time), camera(clip));
        }
        let Some(left) = &self.left else { return Default::default() };
        let mut numbers = left.numbers.clone();
        let params = left.clip.as_ref().map(|clip| clip.params_at(time)).unwrap_or_default();
        for (place, name) in &left.moved {
            let value = params.iter().find(|(moved, _)| moved == name).map(|(_, value)| *value);
            if let Some((number, value)) = numbers.get_mut(*place).zip(value) {
                *number = value;
            }
        }
        (numbers, left.clip.as_ref().and_then(camera))
    }

    /// How the camera is moved of what fades out, at `time` seconds of the song: as it was left, or as the show turns it.
    /// `orbit` is how the user has moved that of the scene that shows.
    pub(super) fn camera(&self, outgoing: &Outgoing, time: f64, orbit: OrbitControls) -> OrbitControls {
        let by_hand = if outgoing.place == Place::Shown { orbit } else { self.orbit };
        let left = self.left.as_ref().and_then(|left| left.clip.as_ref());
        match outgoing.clip.as_ref().or(left) {
            Some(clip) if by_hand == OrbitControls::OFF => OrbitControls::of_turns(clip.turns_at(time)),
            _ => by_hand,
        }
    }
}
