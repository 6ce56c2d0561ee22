//! A show's fades: both scenes go on while one fades into the other, as in a video of the show.
//!
//! ```text
//! the scene that goes, its light alone → kept → the scene that comes, with a share of that light
//! ```
//!
//! Both are drawn at the same moment of the song, one after the other. Where the scene that goes is no longer there, its
//! last picture fades instead ([`super::fading`]).

use std::time::Duration;

use super::{Cast, SceneStage};
use crate::app::scene_regions::Shown;
use crate::show::Stay;
use mariana_music::Sound;

/// A fade that was joined so late, as a share of it, begins with the picture that was on.
const LATE_SHARE: f32 = 0.35;

/// What the stage knows of a show's fade.
#[derive(Default)]
pub(super) struct Mixing {
    /// The scene that goes, once it is neither on the stage nor the one before.
    leaving: Option<Cast>,
    /// The picture of which the scene that goes was begun.
    begun: Option<Begun>,
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
    /// How it is staged.
    pub(super) stay: Stay,
    /// Its share of the picture, above 0 and below 1.
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
    /// What fades away under the scene on the stage at `time` seconds of the song, if both are there.
    pub(super) fn under(&self, time: f64) -> Option<Under> {
        if self.view().is_some() || self.fading.goes_on() {
            return None;
        }
        let programme = self.directed.programme()?;
        let moment = programme.plan().at(time)?;
        let (stay, share) = moment.leaving?;
        let on_stage = self.on_stage.as_ref()?;
        if self.directed.is_overruled(moment.index)
            || programme.source(&moment.stay.scene) != Some(&on_stage.source)
        {
            return None;
        }
        let source = programme.source(&stay.scene)?;
        let places = [Place::OnStage, Place::Before, Place::Leaving];
        let is_there = |place: &Place| {
            let cast = self.cast_at(*place).filter(|cast| cast.source == *source);
            cast.is_some_and(|cast| self.mode_of(cast).is_some())
        };
        let place = places.into_iter().find(is_there)?;
        Some(Under { place, stay: stay.clone(), share: 1.0 - share })
    }

    /// Whether a fade that is entered now shows both scenes.
    pub(super) fn fades_with_both(&self) -> bool {
        let under = self.directed.last_time().and_then(|time| self.under(time));
        under.is_some_and(|under| under.share > 1.0 - LATE_SHARE || self.directed.stands_still())
    }

    /// The scene at that place.
    pub(super) fn cast_at(&self, place: Place) -> Option<&Cast> {
        place.find(self.on_stage.as_ref(), self.before.as_ref(), &self.mixing)
    }

    /// A picture of the scene on the stage is finished: the one before it is kept for its fade, or as a neighbour.
    pub(super) fn let_go_of_the_one_before(&mut self, time: f64) {
        if self.before.is_none() {
            return;
        }
        let fades = self.under(time).is_some_and(|under| under.place == Place::Before);
        let Some(before) = self.before.take() else { return };
        if fades {
            self.let_go_of_the_leaving();
            self.mixing.leaving = Some(before);
        } else {
            self.ahead.keep(before);
            self.forget_obsolete();
        }
    }

    /// The scene that was kept for a fade is needed no longer, unless it still fades at `time`.
    pub(super) fn end_fade(&mut self, time: f64) {
        let fades = || self.under(time).is_some_and(|under| under.place == Place::Leaving);
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
