//! A show in seconds.

use super::cue_list::{CAMERA_TURNS, TransitionKind, UNTURNED};
use super::picture::{Held, Picture, Pictures};
use mariana_field::lang::{Param, Scene};

/// What is on when. There is something on at every moment.
#[derive(Debug, Clone, PartialEq)]
pub struct Timeline {
    /// Stays that follow each other in time; at least one.
    clips: Vec<Clip>,
    /// What is done to whole pictures.
    pictures: Pictures,
}

/// A scene for a while.
#[derive(Debug, Clone, PartialEq)]
pub struct Clip {
    /// When its transition begins, in seconds.
    pub start: f64,
    /// The scene, by name or by file.
    pub scene: String,
    /// One of its cameras; none is the scene's own.
    pub camera: Option<String>,
    /// How it comes.
    pub transition: TimedTransition,
    /// What moves its parameters, in the order of their starts.
    pub moves: Vec<Move>,
}

/// How a scene comes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimedTransition {
    /// The kind of its transition.
    pub kind: TransitionKind,
    /// How long it takes, in seconds.
    pub seconds: f64,
    /// Whether it breaks off where the next stay begins sooner; else it takes no longer than until then.
    pub unfinished: bool,
}

impl TimedTransition {
    /// At once.
    pub const CUT: Self = Self { kind: TransitionKind::Cut, seconds: 0.0, unfinished: false };

    /// By a transition that takes some seconds.
    pub fn new(kind: impl Into<TransitionKind>, seconds: f64) -> Self {
        Self { kind: kind.into(), seconds, ..Self::CUT }
    }
}

/// A parameter that moves from one value to another.
#[derive(Debug, Clone, PartialEq)]
pub struct Move {
    /// Its name in the scene.
    pub param: String,
    /// When it begins, in seconds of the song.
    pub start: f64,
    /// How long it takes, in seconds; 0 sets it.
    pub seconds: f64,
    /// The value before.
    pub from: f32,
    /// The value behind.
    pub to: f32,
}

/// What a show does with a parameter at a moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moved<'a> {
    /// The parameter's name.
    pub name: &'a str,
    /// Its value.
    pub value: f32,
    /// The same number for as long as it is the same movement in the same stay.
    pub part: u64,
}

/// What is on at a moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment<'a> {
    /// Which stay it is.
    pub index: usize,
    /// The scene that is on, or is coming.
    pub clip: &'a Clip,
    /// The scene that goes, and how far the transition has come, above 0 and below 1; none between transitions.
    pub leaving: Option<(&'a Clip, f32)>,
}

impl Timeline {
    /// The plan of stays that follow each other; `None` if there are none. A transition ends before the next one begins,
    /// or breaks off there.
    pub fn new(mut clips: Vec<Clip>) -> Option<Self> {
        if clips.is_empty() {
            return None;
        }
        clips.sort_by(|a, b| a.start.total_cmp(&b.start));
        let ends: Vec<f64> = clips.iter().skip(1).map(|clip| clip.start).collect();
        for (index, clip) in clips.iter_mut().enumerate() {
            let left = ends.get(index).map_or(f64::INFINITY, |end| end - clip.start);
            let is_cut = index == 0 || clip.transition.kind == TransitionKind::Cut;
            let most = if clip.transition.unfinished { f64::INFINITY } else { left };
            clip.transition.seconds = if is_cut { 0.0 } else { clip.transition.seconds.clamp(0.0, most) };
        }
        let pictures = Pictures::of(&clips);
        Some(Self { clips, pictures })
    }

    /// What is done to the whole picture at `time` seconds.
    pub fn picture_at(&self, time: f64) -> Picture {
        self.pictures.at(time)
    }

    /// What is held at `time` seconds: the picture of [`Timeline::picture_at`]; the one that still had a share of that picture
    /// when it began to be held, with this share; and so on. Empty if nothing is held; those that gave way longest ago are
    /// left out above [`LIMITS`](crate::limits::LIMITS).
    pub fn held_at(&self, time: f64) -> Vec<Held> {
        self.pictures.held_at(time)
    }

    /// Whether some picture has less than its light.
    pub fn dims(&self) -> bool {
        self.pictures.dim()
    }

    /// The stays in their order; at least one.
    pub fn clips(&self) -> &[Clip] {
        &self.clips
    }

    /// What is on at `time` seconds; before the first scene begins, this scene.
    pub fn at(&self, time: f64) -> Moment<'_> {
        let index = self.clips.partition_point(|clip| clip.start <= time).saturating_sub(1);
        let alone = |index: usize| Moment { index, clip: &self.clips[index], leaving: None };
        let moment = alone(index);
        let Some(before) = index.checked_sub(1) else { return moment };
        let (gone, length) = (time - moment.clip.start, moment.clip.transition.seconds);
        if gone >= length {
            return moment;
        }
        let fraction = (gone / length) as f32;
        if fraction > 0.0 {
            return Moment { leaving: Some((&self.clips[before], fraction)), ..moment };
        }
        // The first picture of a transition is that of the scene that goes.
        alone(before)
    }
}

/// At so many seconds from its ends a movement is at them: no picture is that short, and texts round.
const EXACT: f64 = 1e-6;

impl Move {
    /// Whether it has begun at `time` seconds.
    pub(super) fn has_begun(&self, time: f64) -> bool {
        time - self.start >= -EXACT
    }

    /// Whether it goes nowhere.
    pub(super) fn is_set_at_once(&self) -> bool {
        self.seconds <= 0.0 && self.from == self.to
    }

    /// The value at `time` seconds; before it begins, the one with which it will.
    pub(super) fn at(&self, time: f64) -> f32 {
        let gone = time - self.start;
        if gone >= self.seconds - EXACT && gone >= -EXACT {
            self.to
        } else if gone <= EXACT {
            self.from
        } else {
            self.from + (self.to - self.from) * (gone / self.seconds) as f32
        }
    }
}

impl Clip {
    /// The parameters of its scene at `time` seconds of the song; those that it does not move are as `other` says.
    pub fn numbers_at(&self, scene: &Scene, time: f64, other: impl Fn(&Param) -> f32) -> Vec<f32> {
        let moved = self.params_at(time);
        let value = |name: &str| moved.iter().find(|(moved, _)| *moved == name).map(|(_, value)| *value);
        scene.params.iter().map(|param| value(&param.name).unwrap_or_else(|| other(param))).collect()
    }

    /// The values of the parameters that this stay moves, at `time` seconds of the song, the last word for each.
    pub fn params_at(&self, time: f64) -> Vec<(&str, f32)> {
        self.moved_at(time).into_iter().map(|moved| (moved.name, moved.value)).collect()
    }

    /// How it turns the camera of its scene at `time` seconds of the song: the values of [`CAMERA_TURNS`].
    pub fn turns_at(&self, time: f64) -> [f32; 3] {
        let mut turns = UNTURNED;
        if self.moves.iter().any(|one| CAMERA_TURNS.contains(&one.param.as_str())) {
            let moved = self.params_at(time);
            for (turn, name) in turns.iter_mut().zip(CAMERA_TURNS) {
                *turn = moved.iter().find(|(moved, _)| *moved == name).map_or(*turn, |(_, value)| *value);
            }
        }
        turns
    }

    /// The same with which of its movements each value is part of.
    pub fn moved_at(&self, time: f64) -> Vec<Moved<'_>> {
        let mut values: Vec<Moved<'_>> = Vec::new();
        for one in &self.moves {
            // Before its first move a parameter is where that begins.
            let known = values.iter_mut().find(|known| known.name == one.param);
            if !one.has_begun(time) && (known.is_some() || one.is_set_at_once()) {
                continue;
            }
            let value = one.at(time);
            let part = self.start.to_bits().rotate_left(32) ^ one.start.to_bits();
            let moved = Moved { name: &one.param, value, part };
            match known {
                Some(known) => *known = moved,
                None => values.push(moved),
            }
        }
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_field::lang::Way;

    fn clip(start: f64, way: Way, seconds: f64) -> Clip {
        let transition = TimedTransition::new(way, seconds);
        Clip { start, scene: format!("at {start}"), camera: None, transition, moves: Vec::new() }
    }

    #[test]
    fn a_moment_has_its_scene_and_the_share_of_its_transition() {
        let timeline = Timeline::new(vec![
            clip(10.0, Way::Melt, 4.0),
            clip(0.0, Way::Fade, 9.0),
            clip(12.0, Way::Cut, 3.0),
        ])
        .unwrap();
        let at = |time| {
            let moment = timeline.at(time);
            (moment.index, moment.leaving.map(|(from, fraction)| (from.start, fraction)))
        };
        assert_eq!(at(-5.0), (0, None));
        assert_eq!(at(3.0), (0, None), "the first scene has nothing to come from");
        assert_eq!(at(10.0), (0, None), "the first picture of a transition is that of the scene that goes");
        // It ends where the next one begins.
        assert_eq!(at(10.5), (1, Some((0.0, 0.25))));
        assert_eq!((at(12.0), at(1e9)), ((2, None), (2, None)));
        let broken_off = TimedTransition { unfinished: true, ..TimedTransition::new(Way::Fade, 4.0) };
        let clips =
            vec![clip(0.0, Way::Cut, 0.0), Clip { transition: broken_off, ..clip(10.0, Way::Fade, 4.0) }];
        let timeline = Timeline::new([clips, vec![clip(11.0, Way::Cut, 0.0)]].concat()).unwrap();
        let fraction = |time| timeline.at(time).leaving.map(|(_, fraction)| fraction);
        assert_eq!((fraction(10.5), fraction(11.0)), (Some(0.125), None), "it goes at its own pace");
        assert_eq!(Timeline::new(Vec::new()), None);
    }

    #[test]
    fn parameters_move_and_stay_where_they_got_to() {
        let mut one = clip(0.0, Way::Cut, 0.0);
        let part = |start, seconds, from, to| Move { param: "swell".to_owned(), start, seconds, from, to };
        one.moves = vec![part(2.0, 4.0, 0.0, 1.0), part(8.0, 0.0, 0.3, 0.5)];
        let at = |time| one.params_at(time).first().map(|(_, value)| *value).unwrap();
        assert_eq!([0.0, 2.0, 3.0, 6.0, 7.0, 8.0, 99.0].map(at), [0.0, 0.0, 0.25, 1.0, 1.0, 0.5, 0.5]);
        let part = |time| one.moved_at(time).first().map(|moved| moved.part).unwrap();
        assert!(part(3.0) == part(7.0) && part(7.0) != part(8.0), "another movement has another number");
        let later = Clip { start: 1.0, ..one.clone() };
        assert_ne!(later.moved_at(3.0).first().map(|moved| moved.part), Some(part(3.0)));
    }
}
