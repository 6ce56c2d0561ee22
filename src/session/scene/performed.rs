//! The shown scene, in the form in which it is recorded.

use super::active_clips::ActiveClips;
use super::decks::Decks;
use super::parameters::Parameters;
use super::prepared_scenes::PreparedScenes;
use super::session::SceneSession;
use crate::frame::orbit_controls::OrbitControls;
use crate::scenes::SceneSource;
use crate::show::{Finish, Move, OtherDeck, TimedTransition, Turned, name_of};
use mariana_control::ChangedBy;

pub(crate) struct Performed<'a> {
    pub source: &'a SceneSource,
    /// Name of the camera; `None` for the default one.
    pub camera: Option<&'a str>,
    /// The show's transition, and its start in seconds of the song, if the show controls the scene.
    pub directed: Option<(TimedTransition, f64)>,
    /// Duration and start of a fade without a show, in seconds of the song; `None` for a cut.
    pub faded: Option<(f64, f64)>,
    pub fades: bool,
    pub params: Vec<Turned<'a>>,
    pub moves: &'a [Move],
    /// Camera changes by the user, as [`OrbitControls::turns`] returns them.
    pub turns: [f32; 3],
    pub picture: Finish,
    /// The deck at the beginning of the fader; `None` without decks.
    pub other: Option<OtherDeck<'a>>,
}

impl<'a> Performed<'a> {
    /// The frame at `time` seconds of the song.
    pub(crate) fn of(session: &'a SceneSession, time: f64) -> Option<Self> {
        let performed = Self::at(session, time)?;
        Some(match &session.decks {
            Some(decks) => performed.on_decks(decks, session),
            None => performed,
        })
    }

    fn at(session: &'a SceneSession, time: f64) -> Option<Self> {
        let SceneSession { scenes, show, composer, preparation, .. } = session;
        let (scene, fading, sdf) = (scenes.shown.as_ref()?, &composer.fading, preparation.choice.sdf);
        let clips = show.clips(&scene.source, time);
        let staged = clips.last();
        // Ignore the show's values if the user chose or locked the scene: then the show only turns the camera.
        let clip = staged.filter(|_| !show.is_overruled() && !show.is_locked);
        let params = scene.own_knobs().map(|(slider, _)| Turned {
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
            turns: composer.camera.at(&clips, time).turns(),
            picture: Finish::NOTHING,
            other: None,
        })
    }

    /// The same frame as a mix of two decks.
    fn on_decks(self, decks: &'a Decks, session: &'a SceneSession) -> Self {
        let [from, to] = decks.pair();
        let fader = session.show.course.fader.unwrap_or_default();
        let of = |source: &SceneSource| turned_of(source, &session.scenes, &session.parameters);
        let orbit = session.composer.camera.orbit;
        let turns_if = |is_its: bool| if is_its { orbit.turns() } else { OrbitControls::OFF.turns() };
        let (of_from, of_to) = (fader < 1.0, fader > 0.0);
        let other = OtherDeck {
            scene: named(from),
            params: if of_from { of(from) } else { Vec::new() },
            turns: turns_if(!of_to),
            fader,
        };
        Self {
            source: to,
            camera: None,
            directed: Some((TimedTransition::by_fader(decks.transition()), decks.loaded)),
            faded: None,
            fades: false,
            params: if of_to { of(to) } else { Vec::new() },
            moves: &[],
            turns: turns_if(of_to),
            other: Some(other),
            ..self
        }
    }
}

/// The name of a scene in shows, independent of the current folder.
pub(crate) fn named(source: &SceneSource) -> String {
    match source {
        SceneSource::File(path) => {
            let path = std::path::absolute(path).unwrap_or_else(|_| path.clone());
            name_of(&SceneSource::File(path))
        }
        source => name_of(source),
    }
}

/// The parameters of a scene on a deck; empty while it is not loaded.
fn turned_of<'a>(
    source: &SceneSource,
    scenes: &'a PreparedScenes,
    parameters: &Parameters,
) -> Vec<Turned<'a>> {
    let Some(scene) = scenes.all().find(|scene| scene.source == *source) else { return Vec::new() };
    let numbers = parameters.numbers(scene, &ActiveClips::default(), parameters.song_time);
    let turned = scene.knobs.iter().map(|(slider, knob)| Turned {
        name: &slider.name,
        value: numbers.get(knob.place).copied().unwrap_or(slider.value),
        own: slider.default,
        is_shown: false,
    });
    turned.collect()
}
