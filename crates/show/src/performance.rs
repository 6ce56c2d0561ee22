//! A performance: what was on in each picture of a song, whoever turned it, as a show that does the same again.
//!
//! **Exact where it was seen.** At the moments that were noted the show has the same numbers, bit for bit; between two of
//! them that follow each other closely it moves evenly. Whoever goes back in the song plays over what came later.

use std::collections::BTreeMap;

use super::cue_list::{
    Anchor, CAMERA_TURNS, CueList, Entry, Length, PICTURE_NUMBERS, PLAIN_PICTURE, Setting, Step, Transition,
    TransitionKind, UNTURNED, When,
};
use super::timeline::{Move, TimedTransition};
use crate::limits::LIMITS;
use mariana_field::lang::Span;

/// A value that stays for longer than this, in seconds, stays until it changes; else it is on its way.
const REST: f64 = 0.1;
/// A transition that ends so many seconds late ends in time.
const EXACT: f64 = 1e-6;
/// Steps from moment to moment are whole billionths of a second, which a text holds exactly.
const TICKS: f64 = 1e9;

/// What is on in a picture.
#[derive(Debug, Clone)]
pub struct OnStage<'a> {
    /// The scene that is on or is coming, as shows call it.
    pub scene: &'a str,
    /// One of its cameras; none is its own.
    pub camera: Option<&'a str>,
    /// How it came.
    pub transition: TimedTransition,
    /// When it began to come, in seconds of the song.
    pub start: f64,
    /// Its parameters.
    pub params: Vec<Turned<'a>>,
    /// What a show does with its parameters.
    pub moves: &'a [Move],
    /// How the camera is moved by hand: the values of [`CAMERA_TURNS`].
    pub turns: [f32; 3],
    /// What is done to the whole picture.
    pub picture: Finish,
}

/// What is done to a whole picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Finish {
    /// The values of [`PICTURE_NUMBERS`].
    pub numbers: [f32; 2],
    /// Whether only the show does it, and no hand.
    pub is_shown: bool,
}

impl Finish {
    /// Nothing.
    pub const NOTHING: Self = Self { numbers: PLAIN_PICTURE, is_shown: true };
}

/// A parameter in a picture.
#[derive(Debug, Clone, Copy)]
pub struct Turned<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its value.
    pub value: f32,
    /// The value that the scene's text gives it.
    pub own: f32,
    /// Whether a show moves it, and no other hand.
    pub is_shown: bool,
}

/// See the module.
#[derive(Debug, Clone)]
pub struct Performance {
    scenes: Vec<Played>,
    /// The last moment that was noted.
    last: Option<f64>,
    /// Whether there was more than a show may have.
    is_full: bool,
    /// What was done to the whole picture then.
    finish: [f32; 2],
}

/// A scene while it was on.
#[derive(Debug, Clone)]
struct Played {
    scene: String,
    camera: Option<String>,
    transition: TimedTransition,
    /// When the scene began to come.
    begun: f64,
    /// When this part of it begins.
    start: f64,
    /// Whether it plays over later pictures, since the song went back. An earlier picture may then be less than a
    /// millisecond before it.
    plays_over: bool,
    /// What a show did with parameters.
    moves: Vec<Move>,
    lines: BTreeMap<String, Line>,
}

/// The values of a parameter, each from its moment on.
#[derive(Debug, Clone)]
struct Line {
    /// What the scene's text says.
    own: f32,
    /// Moments and values; at the first one it is set.
    points: Vec<(f64, f32)>,
}

impl Default for Performance {
    fn default() -> Self {
        Self { scenes: Vec::new(), last: None, is_full: false, finish: PLAIN_PICTURE }
    }
}

impl Performance {
    /// Notes what is on at `time` seconds of the song.
    pub fn note(&mut self, time: f64, seen: &OnStage<'_>) {
        if !time.is_finite() || time < 0.0 {
            return;
        }
        let plays_over = self.last.is_some_and(|last| time < last);
        if plays_over {
            self.forget_from(time);
        }
        let before = self.last.replace(time).unwrap_or(time);
        let last = self.scenes.last().filter(|played| played.is_of(seen));
        if last.is_none_or(Played::is_long) {
            if self.scenes.len() >= LIMITS.entries_max {
                self.is_full = true;
                return;
            }
            // What comes stands behind what was there.
            let earliest = self.scenes.last().map_or(0.0, |before| before.start);
            let (start, transition) = match last {
                // The same once more, because there is no room for more steps.
                Some(_) => (time, TimedTransition::CUT),
                None => (seen.start.min(time).max(earliest), seen.transition),
            };
            let is_first = self.scenes.is_empty();
            let (scene, camera) = (seen.scene.to_owned(), seen.camera.map(str::to_owned));
            let (begun, lines) = (seen.start, BTreeMap::new());
            self.scenes.push(Played {
                scene,
                camera,
                transition,
                begun,
                start,
                plays_over,
                moves: seen.moves.to_vec(),
                lines,
            });
            if is_first {
                self.begin_finish(&seen.picture);
            }
        }
        self.note_finish(time, before, &seen.picture);
        let Some(played) = self.scenes.last_mut() else { return };
        let turns = CAMERA_TURNS.into_iter().zip(seen.turns.into_iter().zip(UNTURNED));
        let is_moved = |name: &str| seen.moves.iter().any(|one| one.param == name);
        let turns = turns.map(|(name, (value, own))| Turned {
            name,
            value,
            own,
            is_shown: is_moved(name) && value.to_bits() == own.to_bits(),
        });
        for Turned { name, value, own, is_shown } in seen.params.iter().copied().chain(turns) {
            if !played.lines.contains_key(name) {
                if is_shown {
                    // The show moves it more evenly than pictures tell.
                    continue;
                }
                if played.lines.len() >= LIMITS.settings_max {
                    self.is_full = true;
                    continue;
                }
                let is_moved = played.moves.iter().any(|one| one.param == name);
                let points = vec![(if is_moved { time } else { played.start }, value)];
                played.lines.insert(name.to_owned(), Line { own, points });
            }
            let Some(line) = played.lines.get_mut(name) else { continue };
            line.note(time, before, value);
        }
    }

    /// Notes what is done at `time` seconds to the picture that was noted last and still shows.
    pub fn note_picture(&mut self, time: f64, picture: &Finish) {
        if !time.is_finite() || time < 0.0 {
            return;
        }
        if self.last.is_some_and(|last| time < last) {
            self.forget_from(time);
        }
        let before = self.last.replace(time).unwrap_or(time);
        self.note_finish(time, before, picture);
    }

    /// Notes that the picture which was noted last is held from its own moment on.
    pub fn hold(&mut self, picture: &Finish) {
        let [_, name] = PICTURE_NUMBERS;
        let [brightness, given_way] = self.finish;
        let [_, fraction] = picture.numbers;
        let Some(last) = self.last else { return };
        self.note_picture(last, &Finish { numbers: [brightness, fraction], ..*picture });
        if given_way > 0.0
            && let Some(line) = self.scenes.last_mut().and_then(|played| played.lines.get_mut(name))
        {
            line.leap_from(given_way);
        }
    }

    /// The moment that was noted last, in seconds of the song.
    pub fn last(&self) -> Option<f64> {
        self.last
    }

    /// The first scene begins with a picture to which something is done.
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

    /// Notes what is done to the whole picture. It stays from scene to scene, so only what changes is written.
    fn note_finish(&mut self, time: f64, before: f64, picture: &Finish) {
        let Some(played) = self.scenes.last_mut() else { return };
        let known = PICTURE_NUMBERS.into_iter().zip(picture.numbers).zip(&mut self.finish);
        for ((name, value), known) in known {
            let last = std::mem::replace(known, value);
            if !played.lines.contains_key(name) {
                let is_moved = played.moves.iter().any(|one| one.param == name);
                if (is_moved && picture.is_shown) || last.to_bits() == value.to_bits() {
                    continue;
                }
                if played.lines.len() >= LIMITS.settings_max {
                    self.is_full = true;
                    continue;
                }
                let points = vec![if is_moved { (time, value) } else { (played.start, last) }];
                played.lines.insert(name.to_owned(), Line { own: last, points });
            }
            if let Some(line) = played.lines.get_mut(name) {
                line.note(time, before, value);
            }
        }
    }

    /// Whether more happened than a show may have, so that what came last is missing.
    pub fn is_full(&self) -> bool {
        self.is_full
    }

    /// Whether nothing was noted.
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

    /// The show that does the same.
    pub fn cue_list(&self) -> CueList {
        let mut entries: Vec<Entry> = self.scenes.iter().map(Played::entry).collect();
        for ((played, next), entry) in self.scenes.iter().zip(self.scenes.iter().skip(1)).zip(&mut entries) {
            // What a show made quick enough to be complete ends where the next one begins.
            let breaks_off = next.start < played.start + played.transition.seconds - EXACT;
            if let Some(transition) = entry.transition.as_mut().filter(|one| one.kind != TransitionKind::Cut)
            {
                transition.unfinished = breaks_off;
            }
        }
        CueList { entries }
    }
}

impl Line {
    /// The value at a moment; `before` is the one that was noted last.
    fn note(&mut self, time: f64, before: f64, value: f32) {
        let Some(&(at, last)) = self.points.last() else { return };
        if last.to_bits() == value.to_bits() {
            return;
        }
        if let [.., (earlier, _), (latest, last)] = self.points.as_mut_slice()
            && *earlier == time
            && *latest == time
        {
            // The song stands still: the last word counts.
            *last = value;
            return;
        }
        if before > at {
            // It stayed until the picture before.
            self.points.push((before.max(at).min(time), last));
        }
        if time - before > REST {
            // Nobody knows how it got there.
            self.points.push((time, last));
        }
        self.points.push((time, value));
    }

    /// Before it came to where it is now, it was here at the same moment.
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

    /// What it does, from `start` on; nothing if it never leaves what the text says.
    fn setting(&self, param: &str, start: f64) -> Option<Setting> {
        let (&(first, from), rest) = self.points.split_first()?;
        if rest.is_empty() && from.to_bits() == self.own.to_bits() {
            return None;
        }
        let seconds = |seconds: f64| Length::Seconds((seconds * TICKS).round() / TICKS);
        let after = seconds((first - start).max(0.0));
        let mut at = start + after.number();
        let steps = rest.iter().map(|&(moment, to)| {
            // From where the steps before really end, so that errors do not add up.
            let over = seconds((moment - at).max(0.0));
            at += over.number();
            Step { to, over }
        });
        Some(Setting { param: param.to_owned(), from, steps: steps.collect(), after, span: Span::default() })
    }
}

/// What a show did, counted from `start` on.
fn setting_of(one: &Move, start: f64) -> Setting {
    let step = Step { to: one.to, over: Length::Seconds(one.seconds) };
    let is_step = one.seconds > 0.0 || one.from.to_bits() != one.to.to_bits();
    Setting {
        param: one.param.clone(),
        from: one.from,
        steps: is_step.then_some(step).into_iter().collect(),
        after: Length::Seconds(((one.start - start).max(0.0) * TICKS).round() / TICKS),
        span: Span::default(),
    }
}

impl Played {
    /// Whether it is what is seen.
    fn is_of(&self, seen: &OnStage<'_>) -> bool {
        (self.scene.as_str(), self.camera.as_deref(), self.begun) == (seen.scene, seen.camera, seen.start)
    }

    /// Whether there is no room for more steps.
    fn is_long(&self) -> bool {
        self.lines.values().any(|line| line.points.len() + 3 > LIMITS.steps_max)
    }

    fn entry(&self) -> Entry {
        let TimedTransition { kind, seconds, .. } = self.transition;
        let length = if kind == TransitionKind::Cut { Length::ZERO } else { Length::Seconds(seconds) };
        // A whole millisecond is kept, not made the one before by rounding.
        let ticks = if self.plays_over { 1e6 } else { 1e3 };
        let whole = (self.start * ticks).round() / ticks;
        let start = if whole <= self.start { whole } else { (self.start * ticks).floor() / ticks };
        let moves = self.moves.iter().map(|one| setting_of(one, start));
        let settings = moves.chain(self.lines.iter().filter_map(|(param, line)| line.setting(param, start)));
        let when = When { anchor: Anchor::Time(start), offset: Length::ZERO };
        let transition = Transition { kind, length, unfinished: false };
        let entry = Entry::new(when, &self.scene, self.camera.clone(), Some(transition));
        Entry { settings: settings.collect(), ..entry }
    }
}

#[cfg(test)]
mod tests;
