//! Records a performance frame by frame, and converts the recording to a cue list that repeats the performance.
//!
//! At the recorded moments, the cue list reproduces all values bit for bit. Between two moments that are close
//! together, the cue list interpolates the values. When the song jumps back, new frames replace the frames recorded
//! after that moment.

use std::collections::BTreeMap;

use super::cue_list::{
    Anchor, CAMERA_TURNS, CueList, Entry, FADER, Length, PICTURE_NUMBERS, PLAIN_PICTURE, Setting, Step,
    Transition, TransitionKind, UNTURNED, When,
};
use super::timeline::{Move, TimedTransition};
use crate::limits;

/// Values are interpolated between moments that are at most this many seconds apart. After a longer gap, they jump.
const REST: f64 = 0.1;
/// Tolerance in seconds for the end of a transition.
const EXACT: f64 = 1e-6;
/// Durations of steps are rounded to 1 / `TICKS` seconds (nanoseconds), which a text represents exactly.
const TICKS: f64 = 1e9;

/// The state of the show in one frame.
#[derive(Debug, Clone)]
pub struct OnStage<'a> {
    /// Name of the scene in shows. During a transition, this is the incoming scene.
    pub scene: &'a str,
    /// Name of a camera; `None` for the scene's default camera.
    pub camera: Option<&'a str>,
    /// The transition to the scene.
    pub transition: TimedTransition,
    /// Start of the transition, in seconds of the song.
    pub start: f64,
    /// The scene's parameters.
    pub params: Vec<Turned<'a>>,
    /// The clip's animations.
    pub moves: &'a [Move],
    /// Camera changes by the user: the values of [`CAMERA_TURNS`].
    pub turns: [f32; 3],
    /// The image settings.
    pub picture: Finish,
    /// The other deck, from which the fader leads to `scene`; `None` without decks. With decks, `transition` is one by
    /// fader.
    pub other: Option<OtherDeck<'a>>,
}

/// The scene at the beginning of the fader, in one frame.
#[derive(Debug, Clone)]
pub struct OtherDeck<'a> {
    /// Name of the scene in shows.
    pub scene: String,
    /// The scene's parameters; empty while the scene is not shown.
    pub params: Vec<Turned<'a>>,
    /// Camera changes by the user: the values of [`CAMERA_TURNS`].
    pub turns: [f32; 3],
    /// Position of the fader, in 0..1: 0 shows this scene.
    pub fader: f32,
}

/// Image settings, applied to the whole frame of any scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Finish {
    /// The values of [`PICTURE_NUMBERS`].
    pub numbers: [f32; 2],
    /// True if the show made the settings and no user changed them.
    pub is_shown: bool,
}

impl Finish {
    /// An unchanged image.
    pub const NOTHING: Self = Self { numbers: PLAIN_PICTURE, is_shown: true };
}

/// A parameter in one frame.
#[derive(Debug, Clone, Copy)]
pub struct Turned<'a> {
    /// The parameter's name.
    pub name: &'a str,
    /// The current value.
    pub value: f32,
    /// The default value in the scene's text.
    pub own: f32,
    /// True if the show set the value and no user changed it.
    pub is_shown: bool,
}

/// A recording of a performance.
#[derive(Debug, Clone)]
pub struct Performance {
    scenes: Vec<Played>,
    last: Option<f64>,
    /// True if a limit was reached, so that the end of the performance is missing.
    pub is_full: bool,
    /// The image settings in the last recorded frame.
    finish: [f32; 2],
}

#[derive(Debug, Clone)]
struct Played {
    scene: String,
    camera: Option<String>,
    transition: TimedTransition,
    /// Start of the transition, as reported in [`OnStage::start`].
    begun: f64,
    start: f64,
    /// True if the frame before the entry may be less than a millisecond earlier, so that the entry's start is written
    /// with more digits. This is so where the entry replaces later frames because the song jumped back.
    is_close: bool,
    moves: Vec<Move>,
    lines: BTreeMap<String, Line>,
}

#[derive(Debug, Clone)]
struct Line {
    /// The default value in the scene's text.
    own: f32,
    /// Times and values; the first is the initial value.
    points: Vec<(f64, f32)>,
}

impl Default for Performance {
    fn default() -> Self {
        Self { scenes: Vec::new(), last: None, is_full: false, finish: PLAIN_PICTURE }
    }
}

impl Performance {
    /// Records the state of the show at `time` seconds of the song.
    pub fn record(&mut self, time: f64, seen: &OnStage<'_>) {
        if !time.is_finite() || time < 0.0 {
            return;
        }
        let plays_over = self.last.is_some_and(|last| time < last);
        if plays_over {
            self.forget_from(time);
        }
        let known = self.last.replace(time);
        let before = known.unwrap_or(time);
        let is_close = |start: f64| plays_over || known.is_some_and(|known| start - known < 1e-3);
        if let Some(other) = &seen.other {
            self.record_other_deck(time, before, is_close(time), seen, other);
        }
        let last = self.scenes.last().filter(|played| played.is_of(seen));
        if last.is_none_or(Played::is_long) {
            // An entry starts after the previous entry.
            let earliest = self.scenes.last().map_or(0.0, |before| before.start);
            let (start, transition) = match last {
                // The scene continues in a new entry, because the old entry has the maximum number of steps.
                Some(_) => (time, TimedTransition::CUT),
                None => (seen.start.min(time).max(earliest), seen.transition),
            };
            let is_first = self.scenes.is_empty();
            if !self.begin(seen, start, transition, is_close(start)) {
                return;
            }
            if is_first {
                self.begin_finish(&seen.picture);
            }
        }
        self.record_finish(time, before, &seen.picture);
        let Some(played) = self.scenes.last_mut() else { return };
        let turns = turned_camera(seen.turns, seen.moves);
        let fader = seen.other.as_ref().map(|other| Turned {
            name: FADER,
            value: other.fader,
            own: 0.0,
            is_shown: false,
        });
        let params = seen.params.iter().copied();
        self.is_full |= played.record(time, before, params.chain(turns).chain(fader));
    }

    /// Begins an entry at `start` seconds. Returns false if the recording has the maximum number of entries.
    fn begin(&mut self, seen: &OnStage<'_>, start: f64, transition: TimedTransition, is_close: bool) -> bool {
        if self.scenes.len() >= limits::ENTRIES_MAX {
            self.is_full = true;
            return false;
        }
        let (scene, camera) = (seen.scene.to_owned(), seen.camera.map(str::to_owned));
        let (begun, moves, lines) = (seen.start, seen.moves.to_vec(), BTreeMap::new());
        self.scenes.push(Played { scene, camera, transition, begun, start, is_close, moves, lines });
        true
    }

    /// Records the scene of the other deck, in an entry before the entry of the scene to which the fader leads.
    fn record_other_deck(
        &mut self,
        time: f64,
        before: f64,
        is_close: bool,
        seen: &OnStage<'_>,
        other: &OtherDeck<'_>,
    ) {
        let is_in_pair = match self.scenes.as_slice() {
            [.., from, to] => to.is_of(seen) && from.scene == other.scene && !to.is_long() && !from.is_long(),
            _ => false,
        };
        if !is_in_pair {
            let is_shown =
                |last: &Played| last.scene == other.scene && last.camera.is_none() && !last.is_long();
            let from = OnStage { scene: &other.scene, camera: None, start: time, moves: &[], ..seen.clone() };
            let is_there = self.scenes.last().is_some_and(is_shown);
            if !is_there && !self.begin(&from, time, TimedTransition::CUT, is_close) {
                return;
            }
        }
        let from = if is_in_pair { self.scenes.iter_mut().nth_back(1) } else { self.scenes.last_mut() };
        if let Some(from) = from {
            let turns = turned_camera(other.turns, &[]);
            self.is_full |= from.record(time, before, other.params.iter().copied().chain(turns));
        }
    }

    /// Records a change of the image settings at `time` seconds, while the last recorded frame is still
    /// displayed.
    pub fn record_picture(&mut self, time: f64, picture: &Finish) {
        if !time.is_finite() || time < 0.0 {
            return;
        }
        if self.last.is_some_and(|last| time < last) {
            self.forget_from(time);
        }
        let before = self.last.replace(time).unwrap_or(time);
        self.record_finish(time, before, picture);
    }

    /// Records a freeze that starts at the moment of the last recorded frame and shows that frame.
    pub fn hold(&mut self, picture: &Finish) {
        let [_, name] = PICTURE_NUMBERS;
        let [brightness, given_way] = self.finish;
        let [_, fraction] = picture.numbers;
        let Some(last) = self.last else { return };
        self.record_picture(last, &Finish { numbers: [brightness, fraction], ..*picture });
        if given_way > 0.0
            && let Some(line) = self.scenes.last_mut().and_then(|played| played.lines.get_mut(name))
        {
            line.leap_from(given_way);
        }
    }

    /// Records the initial image settings in the first entry.
    fn begin_finish(&mut self, picture: &Finish) {
        let Some(played) = self.scenes.last_mut().filter(|_| !picture.is_shown) else { return };
        for ((name, plain), value) in PICTURE_NUMBERS.into_iter().zip(PLAIN_PICTURE).zip(picture.numbers) {
            if value.to_bits() != plain.to_bits() {
                played
                    .lines
                    .insert(name.to_owned(), Line { own: plain, points: vec![(played.start, value)] });
            }
        }
        self.finish = picture.numbers;
    }

    /// Records changes of the image settings. Image settings persist across scenes, so only changes are stored.
    fn record_finish(&mut self, time: f64, before: f64, picture: &Finish) {
        let Some(played) = self.scenes.last_mut() else { return };
        let known = PICTURE_NUMBERS.into_iter().zip(picture.numbers).zip(&mut self.finish);
        for ((name, value), known) in known {
            let own = std::mem::replace(known, value);
            let is_shown = (played.is_moved(name) && picture.is_shown) || own.to_bits() == value.to_bits();
            let turned = Turned { name, value, own, is_shown };
            self.is_full |= played.record_one(time, before, turned, own);
        }
    }

    /// True if no frame was recorded.
    pub fn is_empty(&self) -> bool {
        self.scenes.is_empty()
    }

    fn forget_from(&mut self, time: f64) {
        self.scenes.retain(|played| played.start < time);
        for line in self.scenes.iter_mut().flat_map(|played| played.lines.values_mut()) {
            let kept = line.points.partition_point(|(moment, _)| *moment < time).max(1);
            line.points.truncate(kept);
        }
        for ((known, name), plain) in self.finish.iter_mut().zip(PICTURE_NUMBERS).zip(PLAIN_PICTURE) {
            let lines = self.scenes.iter().rev().filter_map(|played| played.lines.get(name)?.points.last());
            *known = lines.map(|(_, value)| *value).next().unwrap_or(plain);
        }
    }

    /// Returns the cue list that repeats the performance.
    pub fn cue_list(&self) -> CueList {
        let mut entries: Vec<Entry> = self.scenes.iter().map(Played::entry).collect();
        for ((played, next), entry) in self.scenes.iter().zip(self.scenes.iter().skip(1)).zip(&mut entries) {
            // A transition that the show shortened ends where the next entry starts.
            let breaks_off = next.start < played.start + played.transition.seconds - EXACT;
            if let Some(transition) = entry.transition.as_mut().filter(|one| one.kind != TransitionKind::Cut)
            {
                transition.unfinished = breaks_off && !transition.by_fader;
            }
        }
        CueList { entries }
    }
}

/// The settings of the camera in a clip with these animations.
fn turned_camera<'a>(turns: [f32; 3], moves: &[Move]) -> impl Iterator<Item = Turned<'a>> {
    let is_moved = |name: &str| moves.iter().any(|one| one.param == name);
    let settings = CAMERA_TURNS.into_iter().zip(turns.into_iter().zip(UNTURNED));
    settings.map(move |(name, (value, own))| Turned {
        name,
        value,
        own,
        is_shown: is_moved(name) && value.to_bits() == own.to_bits(),
    })
}

impl Line {
    /// Records `value` at `time`; `before` is the previous recorded moment.
    fn record(&mut self, time: f64, before: f64, value: f32) {
        let Some(&(at, last)) = self.points.last() else { return };
        if last.to_bits() == value.to_bits() {
            return;
        }
        if let [.., (earlier, _), (latest, last)] = self.points.as_mut_slice()
            && *earlier == time
            && *latest == time
        {
            // The song is paused: replace the last value that was recorded at this time.
            *last = value;
            return;
        }
        if before > at {
            // The value was constant until the previous frame.
            self.points.push((before.max(at).min(time), last));
        }
        if time - before > REST {
            // The values in the gap are unknown, so the value jumps.
            self.points.push((time, last));
        }
        self.points.push((time, value));
    }

    /// Inserts `value` before the last point and at the same time, so that the parameter jumps to the last value.
    fn leap_from(&mut self, value: f32) {
        let at = |time| (time, value);
        if let Some(&(time, now)) = self.points.last()
            && now.to_bits() != value.to_bits()
            && self.points.iter().nth_back(1) != Some(&at(time))
        {
            self.points.pop();
            self.points.extend([at(time), (time, now)]);
        }
    }

    /// Converts the values to a setting of the entry at `start`; `None` if the value was always the default.
    fn setting(&self, param: &str, start: f64) -> Option<Setting> {
        let (&(first, from), rest) = self.points.split_first()?;
        if rest.is_empty() && from.to_bits() == self.own.to_bits() {
            return None;
        }
        let seconds = |seconds: f64| Length::Seconds((seconds * TICKS).round() / TICKS);
        let after = seconds((first - start).max(0.0));
        let mut at = start + after.number();
        let steps = rest.iter().map(|&(moment, to)| {
            // Measure from the rounded end of the previous step, so that errors do not add up.
            let over = seconds((moment - at).max(0.0));
            at += over.number();
            Step { to, over }
        });
        Some(Setting { steps: steps.collect(), after, ..Setting::new(param, from) })
    }
}

/// Converts an animation of the show to a setting of the entry at `start`.
fn setting_of(one: &Move, start: f64) -> Setting {
    let step = Step { to: one.to, over: Length::Seconds(one.seconds) };
    let is_step = one.seconds > 0.0 || one.from.to_bits() != one.to.to_bits();
    Setting {
        steps: is_step.then_some(step).into_iter().collect(),
        after: Length::Seconds(((one.start - start).max(0.0) * TICKS).round() / TICKS),
        ..Setting::new(&one.param, one.from)
    }
}

impl Played {
    /// Records values of this entry's scene at `time`; `before` is the previous recorded moment. Returns true if a
    /// limit was reached.
    fn record<'a>(&mut self, time: f64, before: f64, values: impl Iterator<Item = Turned<'a>>) -> bool {
        values.fold(false, |is_full, turned| is_full | self.record_one(time, before, turned, turned.value))
    }

    /// Records a value, which was `first` when the entry started. Returns true if a limit was reached.
    fn record_one(&mut self, time: f64, before: f64, turned: Turned<'_>, first: f32) -> bool {
        let Turned { name, value, own, is_shown } = turned;
        if !self.lines.contains_key(name) {
            if is_shown {
                // Keep the show's animation, which is smoother than recorded frames.
                return false;
            }
            if self.lines.len() >= limits::SETTINGS_MAX {
                return true;
            }
            let point = if self.is_moved(name) { (time, value) } else { (self.start, first) };
            self.lines.insert(name.to_owned(), Line { own, points: vec![point] });
        }
        if let Some(line) = self.lines.get_mut(name) {
            line.record(time, before, value);
        }
        false
    }

    /// True if the show moves the parameter during this entry.
    fn is_moved(&self, param: &str) -> bool {
        self.moves.iter().any(|one| one.param == param)
    }

    fn is_of(&self, seen: &OnStage<'_>) -> bool {
        if seen.other.is_some() && self.transition != seen.transition {
            return false;
        }
        (self.scene.as_str(), self.camera.as_deref(), self.begun) == (seen.scene, seen.camera, seen.start)
    }

    /// True if a parameter has the maximum number of steps.
    fn is_long(&self) -> bool {
        self.lines.values().any(|line| line.points.len() + 3 > limits::STEPS_MAX)
    }

    fn entry(&self) -> Entry {
        let TimedTransition { kind, seconds, by_fader, .. } = self.transition;
        let length = if kind == TransitionKind::Cut { Length::ZERO } else { Length::Seconds(seconds) };
        // Rounding errors must not turn a whole millisecond into the previous millisecond.
        let ticks = if self.is_close { 1e6 } else { 1e3 };
        let whole = (self.start * ticks).round() / ticks;
        let start = if whole <= self.start { whole } else { (self.start * ticks).floor() / ticks };
        let moves = self.moves.iter().map(|one| setting_of(one, start));
        let settings = moves.chain(self.lines.iter().filter_map(|(param, line)| line.setting(param, start)));
        let when = When { anchor: Anchor::Time(start), offset: Length::ZERO };
        let transition = Transition { kind, length, unfinished: false, by_fader };
        let entry = Entry::new(when, &self.scene, self.camera.clone(), Some(transition));
        Entry { settings: settings.collect(), ..entry }
    }
}

#[cfg(test)]
mod tests;
