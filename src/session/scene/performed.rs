//! The scene that shows at a moment, to be recorded.

use super::camera::SceneCamera;
use super::fading::Fading;
use super::prepared_scenes::PreparedScenes;
use super::show_follower::ShowFollower;
use crate::config::SdfChoice;
use crate::frame::orbit_controls::OrbitControls;
use crate::scenes::SceneSource;
use crate::show::{Finish, Move, TimedTransition, Turned};
use mariana_control::ChangedBy;

/// The scene that shows at a moment, and how it is shown.
pub(crate) struct Performed<'a> {
    /// What it comes from.
    pub source: &'a SceneSource,
    /// One of its cameras.
    pub camera: Option<&'a str>,
    /// How it came and when that began, in seconds of the song, where a show says so.
    pub directed: Option<(TimedTransition, f64)>,
    /// How it came where no show says so, and when that began, in seconds of the song; none if it was cut.
    pub faded: Option<(f64, f64)>,
    /// Whether another scene fades away in it.
    pub fades: bool,
    /// Its parameters.
    pub params: Vec<Turned<'a>>,
    /// What a show does with them.
    pub moves: &'a [Move],
    /// How the camera is moved by hand.
    pub orbit: OrbitControls,
    /// What is done to the whole picture.
    pub picture: Finish,
}

impl<'a> Performed<'a> {
    /// What shows at `time` seconds of the song.
    pub(super) fn at(
        time: f64,
        scenes: &'a PreparedScenes,
        show: &'a ShowFollower,
        (fading, camera): (&Fading, &SceneCamera),
        sdf: SdfChoice,
    ) -> Option<Self> {
        let scene = scenes.shown.as_ref()?;
        let (clips, _) = show.clips(scene, time);
        let split = scene.resources.world().blended.unwrap_or(0);
        let staged = clips.last();
        // The show goes on to turn a scene to which somebody came back, or which somebody keeps.
        let clip = staged.filter(|_| !show.is_overruled() && !show.is_locked());
        let params = scene.knobs.iter().filter(|(_, knob)| knob.place >= split);
        let params = params.map(|(slider, _)| Turned {
            name: &slider.name,
            value: slider.value,
            own: slider.default,
            is_shown: slider.changed_by == ChangedBy::Show && clip.is_some(),
        });
        let source = match &scene.source {
            SceneSource::Blend(blend) => &blend.to.source,
            source => source,
        };
        let faded = fading.of_scene_with_song();
        Some(Self {
            source,
            camera: staged.and_then(|clip| clip.camera.as_deref()),
            directed: clip.map(|clip| (clip.transition, clip.start)),
            faded,
            fades: faded.is_some() || (!fading.goes_on() && show.outgoing(time, scenes, sdf).is_some()),
            params: params.collect(),
            moves: clip.map_or(&[], |clip| &clip.moves),
            orbit: camera.at(&clips, time),
            picture: Finish::NOTHING,
        })
    }
}
