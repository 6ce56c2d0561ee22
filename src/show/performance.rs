//! A performance: what was on in each picture of a song, whoever turned it, as a show that does the same again.
//!
//! **Exact where it was seen.** At the moments that were noted the show has the same numbers, bit for bit; between two of
//! them that follow each other closely it moves evenly. Whoever goes back in the song plays over what came later.

use std::collections::BTreeMap;

use super::plan::{Entrance, Move};
use super::script::{Anchor, CAMERA_TURNS, Entry, Length, Script, Setting, Step, Transition, UNTURNED, When};
use crate::limits::LIMITS;
use mariana_field::lang::{Span, Way};

/// A value that stays for longer than this, in seconds, stays until it changes; else it is on its way.
const REST: f64 = 0.1;
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
    pub entrance: Entrance,
    /// When it began to come, in seconds of the song.
    pub start: f64,
    /// Its parameters.
    pub params: Vec<Turned<'a>>,
    /// What a show does with its parameters.
    pub moves: &'a [Move],
    /// How the camera is moved by hand: the values of [`CAMERA_TURNS`].
    pub turns: [f32; 3],
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
#[derive(Debug, Clone, Default)]
pub struct Performance {
    scenes: Vec<Played>,
    /// The last moment that was noted.
    last: Option<f64>,
    /// Whether there was more than a show may have.
    is_full: bool,
}

/// A scene while it was on.
#[derive(Debug, Clone)]
struct Played {
    scene: String,
    camera: Option<String>,
    entrance: Entrance,
    /// When the scene began to come.
    begun: f64,
    /// When this part of it begins.
    start: f64,
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

impl Performance {
    /// Notes what is on at `time` seconds of the song.
    pub fn note(&mut self, time: f64, seen: &OnStage<'_>) {
        if !time.is_finite() || time < 0.0 {
            return;
        }
        if self.last.is_some_and(|last| time < last) {
            self.forget_from(time);
        }
        let before = self.last.replace(time).unwrap_or(time);
        let last = self.scenes.last().filter(|played| played.is_of(seen));
        if last.is_none_or(Played::is_long) {
            if self.scenes.len() >= LIMITS.show_entries_max {
                self.is_full = true;
                return;
            }
            let (start, entrance) = match last {
                // The same once more, because there is no room for more steps.
                Some(_) => (time, Entrance::CUT),
                None => (seen.start.min(time), seen.entrance),
            };
            let (scene, camera) = (seen.scene.to_owned(), seen.camera.map(str::to_owned));
            let (begun, lines) = (seen.start, BTreeMap::new());
            self.scenes.push(Played {
                scene,
                camera,
                entrance,
                begun,
                start,
                moves: seen.moves.to_vec(),
                lines,
            });
        }
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
                if played.lines.len() >= LIMITS.show_settings_max {
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
    }

    /// The show that does the same.
    pub fn script(&self) -> Script {
        Script { entries: self.scenes.iter().map(Played::entry).collect() }
    }
}

impl Line {
    /// The value at a moment; `before` is the one that was noted last.
    fn note(&mut self, time: f64, before: f64, value: f32) {
        let Some(&(at, last)) = self.points.last() else { return };
        if last.to_bits() == value.to_bits() {
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
        Some(Setting { param: param.to_owned(), from, steps: steps.collect(), after })
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
    }
}

impl Played {
    /// Whether it is what is seen.
    fn is_of(&self, seen: &OnStage<'_>) -> bool {
        (self.scene.as_str(), self.camera.as_deref(), self.begun) == (seen.scene, seen.camera, seen.start)
    }

    /// Whether there is no room for more steps.
    fn is_long(&self) -> bool {
        self.lines.values().any(|line| line.points.len() + 3 > LIMITS.show_steps_max)
    }

    fn entry(&self) -> Entry {
        let Entrance { way, shape, seconds } = self.entrance;
        let length = if way == Way::Cut { Length::ZERO } else { Length::Seconds(seconds) };
        // Texts tell moments to the millisecond.
        let start = (self.start * 1e3).floor() / 1e3;
        let moves = self.moves.iter().map(|one| setting_of(one, start));
        let settings = moves.chain(self.lines.iter().filter_map(|(param, line)| line.setting(param, start)));
        Entry {
            when: When { anchor: Anchor::Time(start), offset: Length::ZERO },
            scene: self.scene.clone(),
            camera: self.camera.clone(),
            transition: Some(Transition { way, shape, length }),
            settings: settings.collect(),
            span: Span::default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::show::{parse, print, resolve};
    use mariana_music::SongStructure;

    /// A picture: seconds since the one before, whether another scene comes, where a knob and the camera are.
    type Picture = (f64, Option<u8>, f32, f32);

    fn pictures() -> impl Strategy<Value = Vec<Picture>> {
        let since = prop_oneof![0.001..0.04f64, 0.5..3.0f64];
        let one = (since, proptest::option::weighted(0.1, 0..3u8), -2.0..2.0f32, -90.0..90.0f32);
        // Often nothing is turned.
        let one = (one, any::<bool>()).prop_map(|((since, scene, knob, yaw), still)| match still {
            true => (since, scene, 0.5, 0.0),
            false => (since, scene, knob, yaw),
        });
        proptest::collection::vec(one, 1..60)
    }

    proptest! {
        #[test]
        fn the_show_of_a_performance_has_each_picture_again(pictures in pictures(), back in 0usize..60) {
            let mut performance = Performance::default();
            let (mut time, mut scene, mut start) = (0.0, "first", 0.0);
            let mut seen = Vec::new();
            let begun = 7.25;
            for (number, (since, change, knob, yaw)) in pictures.into_iter().enumerate() {
                time += since;
                if number == back {
                    // Back to the middle: what came later is played over.
                    time *= 0.5;
                    seen.retain(|(at, ..): &(f64, &str, f32, [f32; 3])| *at < time);
                    (scene, start) = ("again", time);
                }
                if let Some(change) = change {
                    (scene, start) = (["first", "second", "third"][usize::from(change)], time);
                }
                let turns = [yaw, 0.0, 1.0];
                performance.note(begun + time, &OnStage {
                    scene,
                    camera: None,
                    entrance: Entrance::CUT,
                    start: begun + start,
                    params: vec![Turned { name: "knob", value: knob, own: 0.5, is_shown: false }],
                    moves: &[],
                    turns,
                });
                seen.push((time, scene, knob, turns));
            }
            let text = print(&performance.script(), &[]);
            let script = parse("performed.show", &text).script;
            prop_assert!(script.is_some(), "{text}");
            let (plan, left_out) = resolve(&script.unwrap_or_default(), &SongStructure::default(), &[], |_, _| None);
            prop_assert!(left_out.is_empty());
            for (time, scene, knob, turns) in seen {
                let moment = plan.at(begun + time);
                prop_assert_eq!(moment.map(|moment| moment.stay.scene.as_str()), Some(scene), "{}", text);
                let stay = moment.map(|moment| moment.stay.clone());
                let params = stay.as_ref().map(|stay| stay.params_at(begun + time)).unwrap_or_default();
                let found = params.iter().find(|(name, _)| *name == "knob").map_or(0.5, |(_, value)| *value);
                prop_assert_eq!(found.to_bits(), knob.to_bits(), "{} at {}: {}", found, begun + time, text);
                let turned = stay.map_or(UNTURNED, |stay| stay.turns_at(begun + time));
                prop_assert_eq!(turned, turns, "{}", text);
            }
        }
    }

    #[test]
    fn what_nobody_turns_is_not_written() {
        let mut performance = Performance::default();
        assert!(performance.is_empty());
        for frame in 0..100 {
            performance.note(
                f64::from(frame) / 60.0,
                &OnStage {
                    scene: "orb",
                    camera: Some("pole"),
                    entrance: Entrance::new(Way::Melt, 2.0),
                    start: 0.0,
                    params: vec![Turned { name: "relief", value: 0.5, own: 0.5, is_shown: false }],
                    moves: &[],
                    turns: UNTURNED,
                },
            );
        }
        assert_eq!(print(&performance.script(), &[]), "at 0:00  orb  camera pole  melt over 2 s\n");
    }

    #[test]
    fn what_a_show_moves_is_its_own_until_a_hand_takes_it() {
        let mut performance = Performance::default();
        let moves = [Move { param: "swell".to_owned(), start: 12.0, seconds: 8.0, from: 0.0, to: 1.0 }];
        for frame in 0..=160 {
            // Ten pictures a second; a hand takes it at 20 s.
            let time = 10.0 + f64::from(frame) / 10.0;
            let value = if time < 20.0 { 0.125 * (time - 12.0).clamp(0.0, 8.0) as f32 } else { 0.25 };
            performance.note(
                time,
                &OnStage {
                    scene: "orb",
                    camera: None,
                    entrance: Entrance::CUT,
                    start: 10.0,
                    params: vec![Turned { name: "swell", value, own: 0.5, is_shown: time < 20.0 }],
                    moves: &moves,
                    turns: UNTURNED,
                },
            );
        }
        let wanted =
            "at 0:10  orb  cut\n  set swell = 0 -> 1 over 8 s after 2 s\n  set swell = 0.25 after 10 s\n";
        assert_eq!(print(&performance.script(), &[]), wanted);
    }

    #[test]
    fn a_long_performance_goes_on_in_another_entry() {
        let mut performance = Performance::default();
        let frames = LIMITS.show_steps_max as u32 + 5;
        for frame in 0..frames {
            performance.note(
                f64::from(frame) / 60.0,
                &OnStage {
                    scene: "orb",
                    camera: None,
                    entrance: Entrance::CUT,
                    start: 0.0,
                    params: vec![Turned { name: "relief", value: frame as f32, own: 0.5, is_shown: false }],
                    moves: &[],
                    turns: UNTURNED,
                },
            );
        }
        let text = print(&performance.script(), &[]);
        let read = parse("long.show", &text);
        assert_eq!(read.script.map(|script| script.entries.len()), Some(2), "{:?}", read.diagnostics.first());
        assert!(!performance.is_full());
    }
}
