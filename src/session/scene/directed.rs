//! Follows a show: which scene is asked for at a moment, what is prepared for the next one, and how parameters move.
//!
//! A transition that mixes worlds is a scene of its own ([`SceneSource::Blend`]), prepared ahead like any other. Where
//! it was not ready in time, or the machine cannot draw it, the scenes fade instead.

use std::sync::Arc;

use super::ahead::WantedAhead;
use super::hands::Stays;
use super::performed::Performed;
use super::{Cast, SceneStage};
use crate::frame::orbit_controls::OrbitControls;
use crate::scenes::{SceneSource, camera_number};
use crate::show::{Finish, Picture, Programme, Stay, Turned, blend_kind};
use mariana_control::Hand;

/// A scene that comes so much later than the show has it, in seconds, still comes as the show says.
const LATE: f64 = 0.5;

/// What the stage knows of the show.
#[derive(Default)]
pub(super) struct Directed {
    programme: Option<Arc<Programme>>,
    /// The stay in which the user went somewhere else.
    overruled: Option<usize>,
    /// Whether the scene stays until the user says otherwise.
    is_locked: bool,
    /// Whether it stayed because its text was being written.
    was_written: bool,
    /// The stay that was entered last, and whether its transition mixes worlds.
    entered: Option<(usize, bool)>,
    /// What the show asked for last.
    pub(super) asked: Option<SceneSource>,
    /// When the show was last followed, in seconds of the song.
    last_time: Option<f64>,
    /// Whether that was the same moment as the time before.
    stands_still: bool,
    /// What the next press of the key for cues brings.
    cue: Option<SceneSource>,
    /// What comes next.
    upcoming: [Option<SceneSource>; 2],
}

impl Directed {
    pub(super) fn programme(&self) -> Option<&Programme> {
        self.programme.as_deref()
    }

    /// Whether the user went somewhere else in that stay.
    pub(super) fn is_overruled(&self, index: usize) -> bool {
        self.overruled == Some(index)
    }

    /// When the show was last followed, in seconds of the song.
    pub(super) fn last_time(&self) -> Option<f64> {
        self.last_time
    }

    /// Whether the song stands still.
    pub(super) fn stands_still(&self) -> bool {
        self.stands_still
    }
}

impl SceneStage {
    /// Follows a show from now on, or none. `cue` is what may come at any moment.
    pub(crate) fn set_programme(&mut self, programme: Option<Arc<Programme>>, cue: Option<SceneSource>) {
        let is_locked = self.directed.is_locked && programme.is_some();
        let programme = programme.map(|programme| self.without_refused(programme));
        self.directed = Directed { programme, cue, is_locked, ..Directed::default() };
        self.revision += 1;
    }

    /// Follows a show that is the same as before up to this moment.
    pub(crate) fn extend_programme(&mut self, programme: Arc<Programme>, cue: Option<SceneSource>) {
        let programme = self.without_refused(programme);
        (self.directed.programme, self.directed.cue) = (Some(programme), cue);
        (self.directed.entered, self.directed.last_time, self.directed.overruled) = (None, None, None);
    }

    /// Whether there is a show.
    pub(crate) fn is_directed(&self) -> bool {
        self.directed.programme.is_some()
    }

    /// Lets the scene stay until this is called again; tells whether it does.
    pub(crate) fn toggle_lock(&mut self) -> bool {
        self.directed.is_locked = !self.directed.is_locked;
        self.directed.overruled = None;
        self.directed.is_locked
    }

    /// Whether the scene stays although there is a show.
    pub(crate) fn is_kept(&self) -> bool {
        self.directed.is_locked
    }

    /// The show with a substitute for each refused scene.
    fn without_refused(&self, programme: Arc<Programme>) -> Arc<Programme> {
        match self.quiet.refused() {
            [] => programme,
            refused => programme.without(refused).map_or(programme, Arc::new),
        }
    }

    /// Replaces refused scenes in the show.
    pub(super) fn avoid_refused(&mut self) {
        if let Some(programme) = self.directed.programme.take() {
            self.directed.programme = Some(self.without_refused(programme));
        }
    }

    /// True if the director chose the requested scene, not the user.
    pub(super) fn is_own_choice(&self) -> bool {
        let is_by_program = self.directed.programme().is_some_and(|programme| !programme.is_by_user());
        is_by_program && self.directed.asked.is_some() && !self.is_written
    }

    /// The user goes somewhere else: the show comes back with its next scene.
    pub(super) fn overrule(&mut self) {
        self.directed.overruled = self.directed.entered.map(|(index, _)| index);
        (self.directed.asked, self.directed.upcoming) = (None, [None, None]);
        self.fading.next_takes_the_usual();
    }

    /// Asks for what the show has on at `time` seconds of the song.
    pub(crate) fn follow(&mut self, time: f64) {
        let Some(programme) = self.directed.programme.clone() else { return };
        let Some(moment) = programme.at(time) else { return };
        let is_new = self.directed.entered.is_none_or(|(index, _)| index != moment.index);
        if self.directed.is_locked || self.is_written {
            return self.stay(moment.leaving.is_some() && !is_new);
        }
        if std::mem::take(&mut self.directed.was_written) {
            // What was written is looked at: the show comes back with its next scene.
            self.directed.overruled = Some(moment.index);
        }
        let stays = programme.stays();
        let is_same_visit =
            self.directed.overruled.is_some_and(|since| is_one_visit(stays, since, moment.index));
        if is_same_visit || (is_new && self.awaited.is_some()) {
            // Another camera is the same scene. A scene that is still being prepared for the user is not dropped.
            self.directed.overruled = Some(moment.index);
        }
        if self.directed.is_overruled(moment.index) {
            return;
        }
        self.directed.overruled = None;
        let Some(scene) = programme.source(&moment.stay.scene).cloned() else { return };
        let blended = moment.leaving.and_then(|(from, _)| blend_of(&programme, from, moment.stay));
        let blended = blended.filter(|blend| !self.quiet.refused().contains(blend));
        // While the song stands still there is time for what was not prepared.
        let stands_still = self.directed.last_time.replace(time) == Some(time);
        self.directed.stands_still = stands_still;
        if is_new || (stands_still && blended.is_some()) {
            let mixes = blended.as_ref().is_some_and(|blend| stands_still || self.has_ready(blend));
            self.directed.entered = Some((moment.index, mixes));
        }
        let mixes = self.directed.entered.is_some_and(|(_, mixes)| mixes);
        let wanted = blended.filter(|_| mixes).unwrap_or_else(|| scene.clone());
        let cue = self.directed.cue.as_ref();
        self.directed.upcoming = upcoming(&programme, moment.index, &wanted, cue);
        if let Some((leaving, _)) = moment.leaving.filter(|_| stands_still && !mixes) {
            self.need_leaving(&programme, leaving, time);
        }
        if wanted == self.source {
            self.directed.asked = Some(wanted);
            return;
        }
        if self.directed.asked.as_ref() == Some(&wanted) && !is_new {
            // It was asked for and could not be shown, or is on its way.
            return;
        }
        let since = time - moment.stay.start;
        if mixes || (moment.leaving.is_none() && since < LATE) {
            self.fading.next_takes(0.0);
        } else if moment.leaving.is_some() {
            self.fading.next_takes(moment.stay.entrance.seconds - since);
        } else {
            // The show was joined in the middle of a stay, or this is a seek.
            self.fading.next_takes_the_usual();
        }
        self.directed.asked = Some(wanted.clone());
        self.ask_for_source(wanted);
    }

    /// Lets the scene stay, whatever the show has on. A transition that is under way comes to its end.
    fn stay(&mut self, is_under_way: bool) {
        self.directed.was_written = self.is_written;
        if let SceneSource::Blend(blend) = &self.source
            && !is_under_way
        {
            let scene = blend.to.source.clone();
            self.fading.next_takes(0.0);
            self.directed.asked = Some(scene.clone());
            self.ask_for_source(scene);
        }
    }

    /// Prepares the scene that goes, if it is not there although the song stands still in its fade.
    fn need_leaving(&mut self, programme: &Programme, leaving: &Stay, time: f64) {
        let Some(source) = programme.source(&leaving.scene).filter(|_| self.under_of_show(time).is_none())
        else {
            return;
        };
        match self.ahead.give(source) {
            Some(cast) => self.take_leaving(cast),
            None => {
                let [first, _] = std::mem::take(&mut self.directed.upcoming);
                self.directed.upcoming = [Some(source.clone()), first];
            }
        }
    }

    /// What is prepared ahead: what the show has next, or else the neighbours in the list.
    pub(super) fn wanted_ahead(&self) -> WantedAhead {
        if self.directed.asked.is_some() {
            WantedAhead::Upcoming(self.directed.upcoming.clone())
        } else {
            WantedAhead::Neighbours(self.source.clone())
        }
    }

    /// Whether what is on the stage was asked for by the show.
    pub(super) fn is_as_directed(&self) -> bool {
        self.directed.asked.is_some() && self.directed.asked.as_ref() == Some(&self.source)
    }

    /// The parameters of a scene at `time` seconds of the song, and its camera's number: as the show moves them, and
    /// else, or where another hand turned one, as that left it.
    pub(super) fn staged(&self, cast: &Cast, time: f64) -> (Vec<f32>, Option<usize>) {
        let (stays, share) = self.stays(cast, time);
        let mut numbers = self.numbers(cast, &stays, time);
        if let Some((share, number)) = share.zip(numbers.last_mut()) {
            *number = share;
        }
        let world = cast.resources.world();
        let camera = stays.first.filter(|_| share.is_none());
        (numbers, camera.and_then(|stay| camera_number(world, stay.camera.as_deref())))
    }

    /// How the camera of the scene on the stage is moved at `time` seconds of the song: by the user's hand, or else as the
    /// show turns it.
    pub(super) fn hand_at(&self, time: f64) -> OrbitControls {
        let Some(cast) = self.on_stage.as_ref().filter(|_| self.hand == OrbitControls::OFF) else {
            return self.hand;
        };
        let (stays, _) = self.stays(cast, time);
        stays
            .second
            .or(stays.first)
            .map_or(OrbitControls::OFF, |stay| OrbitControls::of_turns(stay.turns_at(time)))
    }

    /// What is on the stage at `time` seconds of the song, to be recorded.
    pub(crate) fn performed(&self, time: f64) -> Option<Performed<'_>> {
        let cast = self.on_stage.as_ref()?;
        let (stays, _) = self.stays(cast, time);
        let split = cast.resources.world().blended.unwrap_or(0);
        let overruled = self.directed.entered.is_some_and(|(index, _)| self.directed.is_overruled(index));
        let staged = stays.second.or(stays.first);
        // The show goes on to turn a scene to which somebody came back, or which somebody keeps.
        let stay = staged.filter(|_| !overruled && !self.directed.is_locked);
        let params = cast.sliders.iter().zip(&cast.knobs).filter(|(_, knob)| knob.place >= split);
        let params = params.map(|(slider, _)| Turned {
            name: &slider.name,
            value: slider.value,
            own: slider.default,
            is_shown: slider.hand == Hand::Show && stay.is_some(),
        });
        let source = match &cast.source {
            SceneSource::Blend(blend) => &blend.to.source,
            source => source,
        };
        let faded = self.fading.of_scene_with_song();
        Some(Performed {
            source,
            camera: staged.and_then(|stay| stay.camera.as_deref()),
            directed: stay.map(|stay| (stay.entrance, stay.start)),
            faded,
            fades: faded.is_some() || (!self.fading.goes_on() && self.under_of_show(time).is_some()),
            params: params.collect(),
            moves: stay.map_or(&[], |stay| &stay.moves),
            hand: self.hand_at(time),
            picture: Finish::NOTHING,
        })
    }

    /// The effects of the show on the whole picture at `time` seconds of the song.
    pub(crate) fn picture_of_show(&self, time: f64) -> Picture {
        self.directed
            .programme()
            .and_then(Programme::plan)
            .map_or(Picture::PLAIN, |plan| plan.picture_at(time))
    }

    /// The same in a certain stay.
    pub(super) fn staged_in(&self, cast: &Cast, stay: &Stay, time: f64) -> (Vec<f32>, Option<usize>) {
        let numbers = self.numbers(cast, &Stays { first: Some(stay), second: None }, time);
        (numbers, camera_number(cast.resources.world(), stay.camera.as_deref()))
    }

    /// The stays that a scene is on in at `time` seconds of the song, and of a blend its share.
    pub(super) fn stays(&self, cast: &Cast, time: f64) -> (Stays<'_>, Option<f32>) {
        let programme = self.directed.programme();
        let moment = programme.and_then(|programme| Some((programme, programme.at(time)?)));
        let Some((programme, moment)) = moment else { return Default::default() };
        if !matches!(cast.source, SceneSource::Blend(_)) || cast.resources.world().blended.is_none() {
            let is_on = programme.source(&moment.stay.scene) == Some(&cast.source);
            return (Stays { first: is_on.then_some(moment.stay), second: None }, None);
        }
        match moment.leaving {
            Some((from, share)) => (Stays { first: Some(from), second: Some(moment.stay) }, Some(share)),
            None => (Stays::default(), Some(1.0)),
        }
    }

    /// Whether the same scene looks different from moment to moment, whatever is heard.
    pub(super) fn is_moved_by_the_show(&self) -> bool {
        let of_blend =
            self.on_stage.as_ref().is_some_and(|cast| matches!(cast.source, SceneSource::Blend(_)));
        of_blend || self.directed.programme.is_some()
    }
}

/// True if all stays from `since` to `until` show one scene.
fn is_one_visit(stays: &[Stay], since: usize, until: usize) -> bool {
    let visit = stays.get(since..=until).unwrap_or_default();
    visit.first().is_some_and(|first| visit.iter().all(|stay| stay.scene == first.scene))
}

/// The source of a transition that mixes the worlds of two stays.
fn blend_of(programme: &Programme, from: &Stay, to: &Stay) -> Option<SceneSource> {
    if from.scene == to.scene {
        return None;
    }
    programme.blend(from, to, blend_kind(to.entrance)?).map(|blend| SceneSource::Blend(Arc::new(blend)))
}

/// The next two sources behind the one that is wanted now, in a stay, of which the first may be that of a cue.
fn upcoming(
    programme: &Programme,
    index: usize,
    wanted: &SceneSource,
    cue: Option<&SceneSource>,
) -> [Option<SceneSource>; 2] {
    let stays = programme.stays();
    let mut found: Vec<SceneSource> = Vec::new();
    let add = |found: &mut Vec<SceneSource>, source: Option<SceneSource>| {
        let is_new = |source: &SceneSource| source != wanted && !found.contains(source);
        found.extend(source.filter(is_new));
    };
    add(&mut found, stays.get(index).and_then(|stay| programme.source(&stay.scene).cloned()));
    for pair in stays.get(index..).unwrap_or_default().windows(2) {
        let [from, to] = pair else { break };
        if found.len() >= 2 {
            break;
        }
        add(&mut found, blend_of(programme, from, to).filter(|_| to.entrance.seconds > 0.0));
        add(&mut found, programme.source(&to.scene).cloned());
    }
    found.truncate(2);
    if let Some(cue) = cue.filter(|cue| *cue != wanted && !found.contains(cue)) {
        // It may come sooner than anything else.
        found.insert(0, cue.clone());
    }
    let mut found = found.into_iter();
    [found.next(), found.next()]
}
