//! Follows a show: selects the requested scene, the scenes to prepare, and the clips that move the parameters.
//!
//! A transition that mixes worlds is drawn as a scene ([`SceneSource::Blend`]), which is prepared ahead. If this
//! scene is not ready in time, or the machine cannot draw it, the transition becomes a fade.

use std::sync::Arc;

use super::active_clips::ActiveClips;
use super::ahead::WantedAhead;
use super::prepared_scenes::{Place, PreparedScenes};
use crate::config::SdfChoice;
use crate::scenes::SceneSource;
use crate::show::{Clip, Layer, Moment, PreparedShow, ShownPicture};

/// Up to this many seconds after a cut of the show, the scene is still cut; later, it fades in as the user chose.
const LATE: f64 = 0.5;

#[derive(Default)]
pub(crate) struct ShowFollower {
    pub(super) course: Course,
    /// The course of the song's show while decks choose the scenes; `None` without decks.
    aside: Option<Course>,
    pub(crate) is_locked: bool,
    pub(super) refused: Vec<SceneSource>,
    pub(super) revision: u64,
}

#[derive(Default)]
pub(super) struct Course {
    prepared_show: Option<Arc<PreparedShow>>,
    /// Index of the clip in which the user chose another scene.
    overruled: Option<usize>,
    /// True if the scene stayed because its text was being edited.
    was_written: bool,
    /// Index of the clip entered last; `true` if its transition mixes worlds.
    entered: Option<(usize, bool)>,
    asked: Option<SceneSource>,
    /// Time of the last `follow`, in seconds of the song.
    pub(super) last_time: Option<f64>,
    /// True if the last two calls of `follow` had the same moment.
    pub(super) stands_still: bool,
    /// The scene of the next cue key press.
    cue: Option<SceneSource>,
    upcoming: [Option<SceneSource>; 2],
    /// Position of the fader between two decks, in 0..1; `None` in the show of a song.
    pub(super) fader: Option<f32>,
    /// True if the last call of `follow` was in the middle of a transition.
    was_between: bool,
}

pub(super) struct Circumstances<'a> {
    /// The scene that the user or the show has requested last.
    pub wanted: &'a SceneSource,
    /// True while the text of `wanted` is being edited.
    pub is_written: bool,
    pub is_awaited: bool,
    pub sdf: SdfChoice,
}

pub(super) struct Step {
    pub source: SceneSource,
    /// Duration of the change in seconds; `None` for the user's usual duration.
    pub seconds: Option<f64>,
}

/// The scene that fades out below the shown scene.
#[derive(Debug, Clone)]
pub(super) struct Outgoing {
    pub place: Place,
    /// The show's clip; `None` if the user left the scene.
    pub clip: Option<Clip>,
    /// The fraction of the scene in the frame, above 0; below 1 in a show's fade.
    pub fraction: f32,
}

impl ShowFollower {
    /// Sets the show to follow, or `None`. `cue` is a scene that may be requested at any moment.
    pub(crate) fn set_prepared_show(
        &mut self,
        prepared_show: Option<Arc<PreparedShow>>,
        cue: Option<SceneSource>,
    ) {
        self.is_locked &= prepared_show.is_some();
        let prepared_show = prepared_show.map(|prepared_show| self.without_refused(prepared_show));
        *self.song_course_mut() = Course { prepared_show, cue, ..Course::default() };
        self.revision += 1;
    }

    /// Lets a fader choose between the scenes of `decks` ([`PreparedShow::of_decks`]), instead of the song's show.
    pub(super) fn set_decks(&mut self, decks: PreparedShow, fader: f32) {
        let decks = Course { prepared_show: Some(Arc::new(decks)), fader: Some(fader), ..Course::default() };
        let course = std::mem::replace(&mut self.course, decks);
        self.aside.get_or_insert(course);
        self.revision += 1;
    }

    /// Moves the fader of the decks to this position, in 0..1.
    pub(super) fn set_fader(&mut self, position: f32) {
        if let Some(fader) = self.course.fader.as_mut().filter(|fader| **fader != position) {
            *fader = position;
            self.revision += 1;
        }
    }

    /// Returns to the song's show, which continues with its next scene.
    pub(super) fn end_decks(&mut self) {
        if let Some(course) = self.aside.take() {
            let Course { prepared_show, cue, .. } = course;
            self.course = Course { prepared_show, cue, was_written: true, ..Course::default() };
            self.revision += 1;
        }
    }

    fn song_course(&self) -> &Course {
        self.aside.as_ref().unwrap_or(&self.course)
    }

    fn song_course_mut(&mut self) -> &mut Course {
        self.aside.as_mut().unwrap_or(&mut self.course)
    }

    /// Replaces the show with `prepared_show`, which is identical up to this moment.
    pub(crate) fn extend_prepared_show(
        &mut self,
        prepared_show: Arc<PreparedShow>,
        cue: Option<SceneSource>,
    ) {
        let prepared_show = self.without_refused(prepared_show);
        let course = self.song_course_mut();
        (course.prepared_show, course.cue) = (Some(prepared_show), cue);
        (course.entered, course.last_time, course.overruled) = (None, None, None);
    }

    /// True if the song has a show, even if decks choose the scenes at the moment.
    pub(crate) fn has_prepared_show(&self) -> bool {
        self.song_course().prepared_show.is_some()
    }

    /// Locks or unlocks the scene. Returns `true` if it is locked now.
    pub(crate) fn toggle_lock(&mut self) -> bool {
        self.is_locked = !self.is_locked;
        self.course.overruled = None;
        self.is_locked
    }

    pub(crate) fn picture_at(&self, time: f64) -> ShownPicture {
        let show = self.song_course().prepared_show.as_deref();
        show.and_then(|show| show.timeline())
            .map_or(ShownPicture::PLAIN, |timeline| timeline.picture_at(time))
    }

    /// The state of the show at `time` seconds, or of the decks.
    fn moment(&self, time: f64) -> Option<Moment<'_>> {
        moment_of(self.course.prepared_show.as_deref()?, self.course.fader, time)
    }

    /// The show with a substitute for each refused scene.
    fn without_refused(&self, prepared_show: Arc<PreparedShow>) -> Arc<PreparedShow> {
        match &self.refused[..] {
            [] => prepared_show,
            refused => prepared_show.without(refused).map_or(prepared_show, Arc::new),
        }
    }

    /// Removes a scene from the show, because this machine cannot draw the scene.
    pub(super) fn refuse(&mut self, source: SceneSource) {
        if !self.refused.contains(&source) {
            self.refused.push(source);
        }
        if let Some(prepared_show) = self.course.prepared_show.take() {
            self.course.prepared_show = Some(self.without_refused(prepared_show));
        }
    }

    /// True if the director chose the requested scene, not the user or the user's own show.
    pub(super) fn is_own_choice(&self) -> bool {
        let is_by_program =
            self.course.prepared_show.as_deref().is_some_and(|prepared_show| !prepared_show.is_by_user());
        is_by_program && self.course.asked.is_some()
    }

    /// Notes that the user chose another scene. The show continues with its next scene.
    pub(super) fn overrule(&mut self) {
        self.course.overruled = self.course.entered.map(|(index, _)| index);
        (self.course.asked, self.course.upcoming) = (None, [None, None]);
    }

    pub(super) fn is_overruled(&self) -> bool {
        self.course.entered.is_some_and(|(index, _)| self.course.overruled == Some(index))
    }

    pub(super) fn asks_for(&self, source: &SceneSource) -> bool {
        self.course.asked.as_ref() == Some(source)
    }

    /// The scenes to prepare ahead: the next scenes of the show, or otherwise the neighbours of `wanted` in the list.
    pub(super) fn wanted_ahead(&self, wanted: &SceneSource) -> WantedAhead {
        if self.course.asked.is_some() {
            WantedAhead::Upcoming(self.course.upcoming.clone())
        } else {
            WantedAhead::Neighbours(wanted.clone())
        }
    }

    /// The show's request at `time` seconds, if it is new. Takes scenes for a fade from the prepared ones.
    pub(super) fn follow(
        &mut self,
        time: f64,
        scenes: &mut PreparedScenes,
        now: &Circumstances<'_>,
    ) -> Option<Step> {
        let Some(prepared_show) = self.course.prepared_show.clone() else {
            // A transition whose show has ended, as its song was removed from the list, ends as well.
            let SceneSource::Blend(blend) = now.wanted else { return None };
            return Some(Step { source: blend.to.source.clone(), seconds: Some(0.0) });
        };
        let fader = self.course.fader;
        let moment = moment_of(&prepared_show, fader, time)?;
        let is_between = moment.leaving.is_some();
        let is_back = !std::mem::replace(&mut self.course.was_between, is_between) && is_between;
        let is_new = self.course.entered.is_none_or(|(index, _)| index != moment.index)
            || (is_back && fader.is_some());
        if (self.is_locked || now.is_written) && fader.is_none() {
            return self.keep_scene(moment.leaving.is_some() && !is_new, now);
        }
        if std::mem::take(&mut self.course.was_written) {
            // The user is looking at the edited scene, so it stays until the next scene of the show.
            self.course.overruled = Some(moment.index);
        }
        let clips = prepared_show.clips();
        let is_same_visit =
            self.course.overruled.is_some_and(|since| is_one_visit(clips, since, moment.index));
        if fader.is_none() && (is_same_visit || (is_new && now.is_awaited)) {
            // A new camera does not end the user's choice. A scene that is being prepared for the user is not dropped.
            self.course.overruled = Some(moment.index);
        }
        if self.course.overruled == Some(moment.index) {
            return None;
        }
        self.course.overruled = None;
        let scene = prepared_show.source(&moment.clip.scene).cloned()?;
        let blended = moment.leaving.and_then(|(from, _)| prepared_show.blend(from, moment.clip));
        let blended = blended.filter(|blend| !self.refused.contains(blend));
        // While the song is paused, there is time to prepare missing scenes.
        let stands_still = self.course.last_time.replace(time) == Some(time);
        self.course.stands_still = stands_still;
        if is_new || (stands_still && blended.is_some()) {
            let mixes =
                blended.as_ref().is_some_and(|blend| stands_still || scenes.ahead.has_rehearsed(blend));
            self.course.entered = Some((moment.index, mixes));
        }
        let mixes = self.course.entered.is_some_and(|(_, mixes)| mixes);
        let wanted = blended.filter(|_| mixes).unwrap_or_else(|| scene.clone());
        let cue = self.course.cue.as_ref();
        self.course.upcoming = upcoming(&prepared_show, moment.index, &wanted, cue);
        let is_shown = scenes.shown_source() == Some(&scene);
        let may_wait = if fader.is_some() { is_shown } else { stands_still };
        if let Some((leaving, _)) = moment.leaving.filter(|_| may_wait && !mixes) {
            self.need_leaving(&prepared_show, leaving, time, scenes, now.sdf);
        }
        if wanted == *now.wanted {
            self.course.asked = Some(wanted);
            return None;
        }
        if self.asks_for(&wanted) && !is_new {
            // The scene was requested before: it could not be shown, or is still being loaded.
            return None;
        }
        let since = time - moment.clip.start;
        let seconds = if mixes || fader.is_some() || (moment.leaving.is_none() && since < LATE) {
            Some(0.0)
        } else {
            // Without a fade, the show starts or continues in the middle of a clip, as after a seek.
            moment.leaving.map(|_| moment.clip.transition.seconds - since)
        };
        self.course.asked = Some(wanted.clone());
        Some(Step { source: wanted, seconds })
    }

    /// Keeps the scene regardless of the show. A transition in progress is completed.
    fn keep_scene(&mut self, is_under_way: bool, now: &Circumstances<'_>) -> Option<Step> {
        self.course.was_written = now.is_written;
        match now.wanted {
            SceneSource::Blend(blend) if !is_under_way => {
                let source = blend.to.source.clone();
                self.course.asked = Some(source.clone());
                Some(Step { source, seconds: Some(0.0) })
            }
            _ => None,
        }
    }

    /// Prepares the outgoing scene of a fade in which the song is paused, if the scene is missing.
    fn need_leaving(
        &mut self,
        prepared_show: &PreparedShow,
        leaving: &Clip,
        time: f64,
        scenes: &mut PreparedScenes,
        sdf: SdfChoice,
    ) {
        let is_there = self.outgoing(time, scenes, sdf).is_some();
        let Some(source) = prepared_show.source(&leaving.scene).filter(|_| !is_there) else { return };
        match scenes.ahead.give(source) {
            Some(scene) => {
                scenes.fade_out(scene);
                self.revision += 1;
            }
            None => {
                let [first, _] = std::mem::take(&mut self.course.upcoming);
                self.course.upcoming = [Some(source.clone()), first];
            }
        }
    }

    /// The outgoing scene at `time` seconds of the song, if the show has a fade then and both scenes are available.
    pub(super) fn outgoing(&self, time: f64, scenes: &PreparedScenes, sdf: SdfChoice) -> Option<Outgoing> {
        if self.course.overruled == Some(self.moment(time)?.index) {
            return None;
        }
        let layers = self.course.prepared_show.as_deref()?.layers(self.moment(time)?, time, |_| false)?;
        let [leaving, entering]: [Layer<'_>; 2] = layers.try_into().ok()?;
        let fraction = entering.below.filter(|_| scenes.shown_source() == Some(&entering.source))?;
        let place = scenes.place_of(&leaving.source, sdf)?;
        Some(Outgoing { place, clip: Some(leaving.clip.clone()), fraction })
    }

    /// The clips of a scene at `time` seconds of the song.
    pub(super) fn clips(&self, scene: &SceneSource, time: f64) -> ActiveClips<'_> {
        let Some((show, moment)) = self.course.prepared_show.as_deref().zip(self.moment(time)) else {
            return ActiveClips::default();
        };
        let clip_of =
            |clip, source| Some(clip).filter(|clip: &&Clip| show.source(&clip.scene) == Some(source));
        let SceneSource::Blend(blend) = scene else {
            return ActiveClips { first: clip_of(moment.clip, scene), ..ActiveClips::default() };
        };
        let blended = |first, second, fraction| ActiveClips { first, second, fraction: Some(fraction) };
        let (from, to) = (&blend.from.source, &blend.to.source);
        let Some((leaving, fraction)) = moment.leaving else {
            return blended(None, None, if clip_of(moment.clip, from).is_some() { 0.0 } else { 1.0 });
        };
        // The blend of this transition may still be prepared, as after a scene is loaded into one of two decks.
        match (clip_of(leaving, from), clip_of(leaving, to)) {
            (first @ Some(_), _) => blended(first, clip_of(moment.clip, to), fraction),
            (None, second @ Some(_)) if moment.clip.transition.by_fader => {
                blended(None, second, 1.0 - fraction)
            }
            _ => blended(None, None, 1.0),
        }
    }
}

/// The state of a show at `time` seconds, or of decks whose fader is at this position.
fn moment_of(show: &PreparedShow, fader: Option<f32>, time: f64) -> Option<Moment<'_>> {
    let timeline = show.timeline()?;
    Some(fader.map_or_else(|| timeline.at(time), |fader| timeline.at_end_with(fader)))
}

fn is_one_visit(clips: &[Clip], since: usize, until: usize) -> bool {
    let visit = clips.get(since..=until).unwrap_or_default();
    visit.first().is_some_and(|first| visit.iter().all(|clip| clip.scene == first.scene))
}

/// The next two sources after `wanted` in the clip at `index`. The source of the next cue comes first.
fn upcoming(
    prepared_show: &PreparedShow,
    index: usize,
    wanted: &SceneSource,
    cue: Option<&SceneSource>,
) -> [Option<SceneSource>; 2] {
    let clips = prepared_show.clips();
    let pairs = || clips.iter().zip(clips.iter().skip(1));
    let source_of = |clip: &Clip| prepared_show.source(&clip.scene).cloned();
    let present = clips.get(index).and_then(source_of);
    // The fader may move back.
    let before = index.checked_sub(1).and_then(|before| pairs().nth(before));
    let before = before.into_iter().filter(|(_, to)| to.transition.by_fader);
    let back = before.flat_map(|(from, to)| [prepared_show.blend(from, to), source_of(from)]);
    let later = pairs().skip(index).flat_map(|(from, to)| {
        let is_mixed = to.transition.seconds > 0.0 || to.transition.by_fader;
        [prepared_show.blend(from, to).filter(|_| is_mixed), source_of(to)]
    });
    let mut found: Vec<SceneSource> = Vec::new();
    for source in std::iter::once(present).chain(back).chain(later).flatten() {
        if found.len() == 2 {
            break;
        }
        if source != *wanted && !found.contains(&source) {
            found.push(source);
        }
    }
    if let Some(cue) = cue.filter(|cue| *cue != wanted && !found.contains(cue)) {
        // The key for the cue may be pressed before any other scene is due.
        found.insert(0, cue.clone());
    }
    let mut found = found.into_iter();
    [found.next(), found.next()]
}

#[cfg(test)]
mod tests {
    use super::super::ahead::PreparedAhead;
    use super::*;
    use crate::show::{ShowSource, TimedTransition, TransitionKind};
    use mariana_field::world::{BlendKind, PortalShape};
    use mariana_music::{Section, SongStructure};

    const SCENES: [&str; 3] = ["gyroid", "orb", "terrain"];

    fn shipped(name: &str) -> SceneSource {
        SceneSource::Shipped(name.to_owned())
    }

    fn follower() -> (ShowFollower, [(f64, SceneSource); 2]) {
        let section =
            |start: f64, energy| Section { start, end: start + 30.0, letter: format!("{start}"), energy };
        let sections = vec![section(0.0, 0.1), section(30.0, 0.9), section(60.0, 0.2)];
        let song = SongStructure { seconds: 90.0, sections, ..SongStructure::default() };
        let (show, _) = PreparedShow::of_song(&ShowSource::Auto, &song, &SCENES.map(shipped)).unwrap();
        let [first, second, ..] = show.clips() else { panic!("{:?}", show.clips()) };
        let moments = [first, second].map(|clip| clip.start + clip.transition.seconds + 1.0);
        let moments = moments.map(|at| (at, show.source(&show.at(at).unwrap().clip.scene).unwrap().clone()));
        let mut follower = ShowFollower::default();
        follower.set_prepared_show(Some(Arc::new(show)), None);
        (follower, moments)
    }

    fn now(wanted: &SceneSource) -> Circumstances<'_> {
        Circumstances { wanted, is_written: false, is_awaited: false, sdf: SdfChoice::Auto }
    }

    #[test]
    fn a_show_requests_each_scene_once_and_respects_the_users_choice() {
        let (mut show, [(first, one), (second, other)]) = follower();
        let mut scenes = PreparedScenes::with(PreparedAhead::with(None));
        let elsewhere = shipped("elsewhere");
        assert_eq!(show.follow(first, &mut scenes, &now(&elsewhere)).unwrap().source, one);
        assert!(show.asks_for(&one) && show.is_own_choice());
        assert!(show.follow(first + 0.1, &mut scenes, &now(&elsewhere)).is_none(), "already requested");
        assert!(matches!(show.wanted_ahead(&one), WantedAhead::Upcoming([Some(_), _])));
        // After the user's choice, the show continues with its next scene.
        show.overrule();
        assert!(show.is_overruled() && !show.is_own_choice());
        assert_eq!(show.wanted_ahead(&elsewhere), WantedAhead::Neighbours(elsewhere.clone()));
        assert!(show.follow(first + 0.2, &mut scenes, &now(&elsewhere)).is_none());
        assert_eq!(show.follow(second, &mut scenes, &now(&elsewhere)).unwrap().source, other);
        assert!(show.toggle_lock());
        assert!(show.follow(first, &mut scenes, &now(&other)).is_none());
        assert!(!show.toggle_lock());
        assert_eq!(show.follow(first, &mut scenes, &now(&other)).unwrap().source, one);
    }

    #[test]
    fn a_blend_stays_where_it_is_while_another_is_prepared() {
        let [orb, city, terrain] = ["orb", "city", "terrain"].map(shipped);
        let decks = |from: &SceneSource, to: &SceneSource, kind: BlendKind| {
            PreparedShow::of_decks([from.clone(), to.clone()], TransitionKind::Blend(kind), 0.0)
        };
        let melt = decks(&orb, &city, BlendKind::Melt);
        let [from, to] = melt.clips() else { panic!("{:?}", melt.clips()) };
        let blend = melt.blend(from, to).unwrap();
        let ball = BlendKind::Portal(PortalShape::Ball);
        for (now, fader, wanted) in [
            (decks(&orb, &city, ball), 0.25, 0.25),
            (decks(&orb, &terrain, BlendKind::Melt), 0.25, 0.25),
            (decks(&city, &terrain, BlendKind::Melt), 0.25, 0.75),
            (decks(&city, &terrain, BlendKind::Melt), 0.0, 1.0),
            (decks(&orb, &terrain, BlendKind::Melt), 0.0, 0.0),
        ] {
            let mut show = ShowFollower::default();
            show.set_decks(now, fader);
            assert_eq!(show.clips(&blend, 1.0).fraction, Some(wanted), "{fader}");
        }
        // In the show of a song, the transition to the next scene does not lead back.
        let (mut show, [(first, _), _]) = follower();
        show.course.prepared_show = Some(Arc::new(melt));
        assert_eq!(show.clips(&blend, first).fraction, Some(0.0));
    }

    #[test]
    fn a_transition_ends_with_its_show() {
        let (mut show, [(_, one), (second, other)]) = follower();
        let prepared_show = show.course.prepared_show.clone().unwrap();
        let [from, to, ..] = prepared_show.clips() else { panic!("{:?}", prepared_show.clips()) };
        let melt = Clip {
            transition: TimedTransition::new(TransitionKind::Blend(BlendKind::Melt), 1.0),
            ..to.clone()
        };
        let blend = prepared_show.blend(from, &melt).unwrap();
        assert!(one != other);
        let mut scenes = PreparedScenes::with(PreparedAhead::with(None));
        show.set_prepared_show(None, None);
        let step = show.follow(second, &mut scenes, &now(&blend)).unwrap();
        assert_eq!((&step.source, step.seconds), (&other, Some(0.0)));
        assert!(show.follow(second, &mut scenes, &now(&other)).is_none());
    }

    #[test]
    fn a_show_skips_refused_scenes_and_keeps_an_edited_scene() {
        let (mut show, [(first, one), (second, other)]) = follower();
        let mut scenes = PreparedScenes::with(PreparedAhead::with(None));
        let written = Circumstances { is_written: true, ..now(&one) };
        assert!(show.follow(second, &mut scenes, &written).is_none(), "its text is being edited");
        // The edited scene stays until the show has another scene.
        assert!(show.follow(second, &mut scenes, &now(&one)).is_none());
        show.refuse(other.clone());
        assert_eq!(&show.refused, std::slice::from_ref(&other));
        assert_eq!(show.follow(first, &mut scenes, &now(&other)).unwrap().source, one);
        let step = show.follow(second, &mut scenes, &now(&one));
        assert!(step.is_none_or(|step| step.source != other), "the show skips it");
    }
}
