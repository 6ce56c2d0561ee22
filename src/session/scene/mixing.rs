//! Fades, of a show and of the user: both scenes go on while one fades into the other, as in a video of the show.
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

use super::regions::Shown;
use super::{Cast, SceneStage};
use crate::frame::orbit_controls::OrbitControls;
use crate::scenes::{SceneSource, camera_number};
use crate::show::Stay;
use mariana_control::Hand;
use mariana_music::Sound;
use mariana_player::Moment;

/// A fade that was joined so late, as a share of it, begins with the picture that was on.
const LATE_SHARE: f32 = 0.35;
/// A scene whose picture takes longer than this stands still while it goes.
const LIVE_MAX: Duration = Duration::from_millis(100);

/// What the stage knows of a show's fade.
#[derive(Default)]
pub(super) struct Mixing {
    /// The scene that goes, once it is neither on the stage nor the one before.
    leaving: Option<Cast>,
    /// The picture of which the scene that goes was begun.
    begun: Option<Begun>,
    /// How the scene was left that the user left.
    left: Option<Left>,
    /// How the camera was moved by hand in the scene that goes.
    hand: OrbitControls,
}

/// How a scene was left.
struct Left {
    source: SceneSource,
    /// As a show had it on.
    stay: Option<Stay>,
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

/// Where the scene that goes is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    /// It is the one that comes, seen in another way.
    OnStage,
    /// It has just gone.
    Before,
    /// It was kept for the fade.
    Leaving,
}

impl Place {
    /// The scene there, of the one on the stage, the one before it and those of fades.
    pub(super) fn find<'a>(
        self,
        on_stage: Option<&'a Cast>,
        before: Option<&'a Cast>,
        mixing: &'a Mixing,
    ) -> Option<&'a Cast> {
        match self {
            Self::OnStage => on_stage,
            Self::Before => before,
            Self::Leaving => mixing.leaving.as_ref(),
        }
    }
}

/// What lies under the scene on the stage.
#[derive(Debug, Clone)]
pub(super) struct Under {
    pub(super) place: Place,
    /// How a show stages it; none if the user left it.
    pub(super) stay: Option<Stay>,
    /// Its share of the picture, above 0; below 1 in a show's fade.
    pub(super) share: f32,
}

impl Mixing {
    pub(super) fn cast(&self) -> Option<&Cast> {
        self.leaving.as_ref()
    }

    pub(super) fn cast_mut(&mut self) -> Option<&mut Cast> {
        self.leaving.as_mut()
    }

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
}

impl SceneStage {
    /// What fades away under the scene on the stage at a moment of the song, if both are there.
    pub(super) fn under(&self, moment: &Moment) -> Option<Under> {
        if self.view().is_some() {
            return None;
        }
        if self.fading.goes_on() {
            let (left, share) = self.mixing.left.as_ref().zip(self.fading.share_of_scene(moment))?;
            return Some(Under { place: self.place_of(&left.source)?, stay: None, share });
        }
        self.under_of_show(moment.song_time)
    }

    /// The same in a show's fade, at `time` seconds of the song.
    pub(super) fn under_of_show(&self, time: f64) -> Option<Under> {
        let programme = self.directed.programme()?;
        let moment = programme.at(time)?;
        let (stay, share) = moment.leaving?;
        let on_stage = self.on_stage.as_ref()?;
        if self.directed.is_overruled(moment.index)
            || programme.source(&moment.stay.scene) != Some(&on_stage.source)
        {
            return None;
        }
        let place = self.place_of(programme.source(&stay.scene)?)?;
        Some(Under { place, stay: Some(stay.clone()), share: 1.0 - share })
    }

    /// Where a scene is found that can be drawn.
    fn place_of(&self, source: &SceneSource) -> Option<Place> {
        let places = [Place::OnStage, Place::Before, Place::Leaving];
        places.into_iter().find(|place| {
            let cast = self.cast_at(*place).filter(|cast| cast.source == *source);
            cast.is_some_and(|cast| self.mode_of(cast).is_some())
        })
    }

    /// Notes how the scene that goes was left, of which the last picture took so long.
    pub(super) fn note_left(&mut self, cast: &Cast, took: Duration) {
        self.mixing.hand = self.hand;
        let time = self.hands.song_time();
        let (stays, share) = self.stays(cast, time);
        if share.is_some() || took > LIVE_MAX {
            self.mixing.left = None;
            return;
        }
        let mut numbers = self.numbers(cast, &stays, time);
        let mut moved = Vec::new();
        for (slider, knob) in cast.sliders.iter().zip(&cast.knobs) {
            if let Some(number) = numbers.get_mut(knob.place) {
                // As they were in its last picture.
                *number = slider.value;
            }
            if slider.hand == Hand::Show {
                moved.push((knob.place, slider.name.clone()));
            }
        }
        let stay = stays.first.cloned();
        self.mixing.left = Some(Left { source: cast.source.clone(), stay, numbers, moved });
    }

    /// The parameters and the camera's number of what fades away, at `time` seconds of the song.
    pub(super) fn staged_under(&self, cast: &Cast, under: &Under, time: f64) -> (Vec<f32>, Option<usize>) {
        let world = cast.resources.world();
        let camera = |stay: &Stay| camera_number(world, stay.camera.as_deref());
        if let Some(stay) = &under.stay {
            return self.staged_in(cast, stay, time);
        }
        let Some(left) = &self.mixing.left else { return Default::default() };
        let mut numbers = left.numbers.clone();
        let params = left.stay.as_ref().map(|stay| stay.params_at(time)).unwrap_or_default();
        for (place, name) in &left.moved {
            let value = params.iter().find(|(moved, _)| moved == name).map(|(_, value)| *value);
            if let Some((number, value)) = numbers.get_mut(*place).zip(value) {
                *number = value;
            }
        }
        (numbers, left.stay.as_ref().and_then(camera))
    }

    /// How the camera is moved of what fades away, at `time` seconds of the song: as it was left, or as the show turns it.
    pub(super) fn hand_under(&self, under: &Under, time: f64) -> OrbitControls {
        let by_hand = if under.place == Place::OnStage { self.hand } else { self.mixing.hand };
        let left = self.mixing.left.as_ref().and_then(|left| left.stay.as_ref());
        match under.stay.as_ref().or(left) {
            Some(stay) if by_hand == OrbitControls::OFF => OrbitControls::of_turns(stay.turns_at(time)),
            _ => by_hand,
        }
    }

    /// Whether a fade that is entered now shows both scenes.
    pub(super) fn fades_with_both(&self) -> bool {
        if self.view().is_some() || self.fading.goes_on() {
            return false;
        }
        let under = self.directed.last_time().and_then(|time| self.under_of_show(time));
        under.is_some_and(|under| under.share > 1.0 - LATE_SHARE || self.directed.stands_still())
    }

    /// The scene at that place.
    pub(super) fn cast_at(&self, place: Place) -> Option<&Cast> {
        place.find(self.on_stage.as_ref(), self.before.as_ref(), &self.mixing)
    }

    /// A picture of the scene on the stage is finished: the one before it is kept for its fade, or as a neighbour.
    pub(super) fn let_go_of_the_one_before(&mut self, moment: &Moment) {
        if self.before.is_none() {
            return;
        }
        let fades = self.under(moment).is_some_and(|under| under.place == Place::Before);
        let Some(before) = self.before.take() else { return };
        if fades {
            self.let_go_of_the_leaving();
            self.mixing.leaving = Some(before);
        } else {
            self.ahead.keep(before);
            self.forget_obsolete();
        }
    }

    /// The scene that was kept for a fade is needed no longer, unless it still fades at a moment.
    pub(super) fn end_fade(&mut self, moment: &Moment) {
        let fades = || self.under(moment).is_some_and(|under| under.place == Place::Leaving);
        if self.mixing.leaving.is_some() && !fades() {
            self.let_go_of_the_leaving();
        }
    }

    /// Takes the scene that goes from those that are prepared, for a song that stands still in the middle of a fade.
    pub(super) fn take_leaving(&mut self, leaving: Cast) {
        self.let_go_of_the_leaving();
        self.mixing.leaving = Some(leaving);
        self.revision += 1;
    }

    fn let_go_of_the_leaving(&mut self) {
        if let Some(leaving) = self.mixing.leaving.take() {
            self.ahead.keep(leaving);
            self.forget_obsolete();
        }
    }
}
