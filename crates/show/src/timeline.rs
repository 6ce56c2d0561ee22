//! A cue list resolved to seconds of one song.

use super::cue_list::{CAMERA_TURNS, FADER, PICTURE_NUMBERS, TransitionKind, UNTURNED};
use super::picture::all_moves;
use mariana_field::lang::Param;

/// The clips of a show. Every moment has a clip, because the first clip extends to the start of the song.
#[derive(Debug, Clone, PartialEq)]
pub struct Timeline {
    /// Clips sorted by start. The list has at least one clip.
    clips: Vec<Clip>,
    /// The animations of each of [`PICTURE_NUMBERS`] over the whole timeline, sorted by start.
    pub(super) picture_moves: [Vec<Move>; 2],
}

/// A scene with its start, transition and animations.
#[derive(Debug, Clone, PartialEq)]
pub struct Clip {
    /// Start of the clip's transition, in seconds.
    pub start: f64,
    /// Name or file of the scene.
    pub scene: String,
    /// Name of a camera; `None` for the scene's default camera.
    pub camera: Option<String>,
    /// The transition to this clip.
    pub transition: TimedTransition,
    /// Animations of parameters, sorted by start.
    pub moves: Vec<Move>,
}

/// A transition with its duration in seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimedTransition {
    /// The kind.
    pub kind: TransitionKind,
    /// Duration in seconds.
    pub seconds: f64,
    /// True if the next clip may cut the transition off. Otherwise the transition is at most as long as the clip.
    pub unfinished: bool,
    /// True if [`FADER`] moves the transition, which then lasts as long as the clip. `seconds` is 0.
    pub by_fader: bool,
}

impl TimedTransition {
    /// A cut.
    pub const CUT: Self =
        Self { kind: TransitionKind::Cut, seconds: 0.0, unfinished: false, by_fader: false };

    /// A transition of this kind and duration.
    pub fn new(kind: impl Into<TransitionKind>, seconds: f64) -> Self {
        Self { kind: kind.into(), seconds, ..Self::CUT }
    }

    /// A transition of this kind that the fader moves.
    pub fn by_fader(kind: impl Into<TransitionKind>) -> Self {
        Self { kind: kind.into(), by_fader: true, ..Self::CUT }
    }
}

/// A linear animation of a parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Move {
    /// The parameter's name in the scene.
    pub param: String,
    /// Start in seconds of the song.
    pub start: f64,
    /// Duration in seconds; 0 sets the value at once.
    pub seconds: f64,
    /// The value at the start.
    pub from: f32,
    /// The value at the end.
    pub to: f32,
}

/// The value of an animated parameter at a moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moved {
    /// The current value.
    pub value: f32,
    /// Number of the animation. Each animation of the show has a different number.
    pub part: u64,
}

/// The state of a timeline at a moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment<'a> {
    /// Index of the clip.
    pub index: usize,
    /// The current or incoming clip.
    pub clip: &'a Clip,
    /// The outgoing clip and the progress of the transition, between 0 and 1; `None` outside transitions. While the
    /// fader moves the transition, the progress may go back.
    pub leaving: Option<(&'a Clip, f32)>,
}

impl Timeline {
    /// Creates a timeline of `clips`; returns `None` if `clips` is empty. Shortens each transition that is longer
    /// than its clip, unless the transition is marked as unfinished.
    pub fn new(mut clips: Vec<Clip>) -> Option<Self> {
        if clips.is_empty() {
            return None;
        }
        clips.sort_by(|a, b| a.start.total_cmp(&b.start));
        let ends: Vec<f64> = clips.iter().skip(1).map(|clip| clip.start).collect();
        for (index, clip) in clips.iter_mut().enumerate() {
            let left = ends.get(index).map_or(f64::INFINITY, |end| end - clip.start);
            let has_no_length =
                index == 0 || clip.transition.by_fader || clip.transition.kind == TransitionKind::Cut;
            let most = if clip.transition.unfinished { f64::INFINITY } else { left };
            clip.transition.seconds =
                if has_no_length { 0.0 } else { clip.transition.seconds.clamp(0.0, most) };
        }
        let picture_moves = PICTURE_NUMBERS.map(|name| all_moves(&clips, name));
        Some(Self { clips, picture_moves })
    }

    /// Returns the clips, sorted by start. There is at least one clip.
    pub fn clips(&self) -> &[Clip] {
        &self.clips
    }

    /// Returns the state at `time` seconds. Before the start of the first clip, the first clip is already shown.
    pub fn at(&self, time: f64) -> Moment<'_> {
        let index = self.clips.partition_point(|clip| clip.start <= time).saturating_sub(1);
        let clip = &self.clips[index];
        self.in_transition(index, clip.progress_at(time))
    }

    /// Returns the state in which the transition to the last clip has this progress, from 0 to 1.
    pub fn at_end_with(&self, progress: f32) -> Moment<'_> {
        self.in_transition(self.clips.len() - 1, progress)
    }

    fn in_transition(&self, index: usize, progress: f32) -> Moment<'_> {
        let alone = |index: usize| Moment { index, clip: &self.clips[index], leaving: None };
        let moment = alone(index);
        match index.checked_sub(1) {
            Some(before) if progress <= 0.0 => alone(before),
            Some(before) if progress < 1.0 => {
                Moment { leaving: Some((&self.clips[before], progress)), ..moment }
            }
            _ => moment,
        }
    }
}

/// Tolerance in seconds for the start and end of an animation. It is shorter than a frame and longer than the
/// rounding errors of times in texts.
const EXACT: f64 = 1e-6;

impl Move {
    pub(super) fn has_begun(&self, time: f64) -> bool {
        time - self.start >= -EXACT
    }

    /// True if the value is constant and set at once.
    pub(super) fn is_set_at_once(&self) -> bool {
        self.seconds <= 0.0 && self.from == self.to
    }

    /// Returns the value at `time` seconds; before the start, the initial value.
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
    /// Returns the progress of the transition to this clip at `time` seconds of the song: at most 0 before it, and 1
    /// after it.
    fn progress_at(&self, time: f64) -> f32 {
        let TimedTransition { seconds, by_fader, .. } = self.transition;
        let gone = time - self.start;
        if by_fader {
            self.moved(FADER, time).map_or(0.0, |moved| moved.value)
        } else if gone >= seconds {
            1.0
        } else {
            (gone / seconds) as f32
        }
    }

    /// Returns the values of all `params` of a scene at `time` seconds of the song: their defaults where this clip does not
    /// animate them.
    pub fn numbers_at(&self, params: &[Param], time: f64) -> Vec<f32> {
        let moved = self.all_moved(time);
        let value = |param: &Param| {
            let of_param = moved.iter().find(|(name, _)| *name == param.name);
            of_param.map_or(param.default, |(_, moved)| moved.value)
        };
        params.iter().map(value).collect()
    }

    /// Returns the camera settings at `time` seconds of the song: the values of [`CAMERA_TURNS`].
    pub fn turns_at(&self, time: f64) -> [f32; 3] {
        let mut turns = UNTURNED;
        for (turn, name) in turns.iter_mut().zip(CAMERA_TURNS) {
            *turn = self.moved(name, time).map_or(*turn, |moved| moved.value);
        }
        turns
    }

    /// Returns the value of a parameter at `time` seconds of the song, with the number of its animation; `None` if this
    /// clip does not animate the parameter.
    pub fn moved(&self, param: &str, time: f64) -> Option<Moved> {
        self.moved_where(time, |name| name == param).pop().map(|(_, moved)| moved)
    }

    /// Returns all parameters that this clip animates, as [`Clip::moved`] does for one. A recording has thousands of
    /// animations, so they are searched only once.
    pub fn all_moved(&self, time: f64) -> Vec<(&str, Moved)> {
        self.moved_where(time, |_| true)
    }

    fn moved_where(&self, time: f64, is_included: impl Fn(&str) -> bool) -> Vec<(&str, Moved)> {
        let mut current: Vec<&Move> = Vec::new();
        for one in self.moves.iter().filter(|one| is_included(&one.param)) {
            let known = current.iter_mut().find(|known| known.param == one.param);
            match (known, one.has_begun(time)) {
                (Some(known), true) => *known = one,
                (None, true) => current.push(one),
                // Before its first animation, a parameter has the initial value of that animation.
                (None, false) if !one.is_set_at_once() => current.push(one),
                _ => {}
            }
        }
        let moved = |one: &Move| {
            let part = self.start.to_bits().rotate_left(32) ^ one.start.to_bits();
            Moved { value: one.at(time), part }
        };
        current.into_iter().map(|one| (one.param.as_str(), moved(one))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_field::lang::TransitionStyle;

    fn clip(start: f64, style: TransitionStyle, seconds: f64) -> Clip {
        let transition = TimedTransition::new(style, seconds);
        Clip { start, scene: format!("at {start}"), camera: None, transition, moves: Vec::new() }
    }

    #[test]
    fn a_moment_has_a_clip_and_the_progress_of_its_transition() {
        let timeline = Timeline::new(vec![
            clip(10.0, TransitionStyle::Melt, 4.0),
            clip(0.0, TransitionStyle::Fade, 9.0),
            clip(12.0, TransitionStyle::Cut, 3.0),
        ])
        .unwrap();
        let at = |time| {
            let moment = timeline.at(time);
            (moment.index, moment.leaving.map(|(from, fraction)| (from.start, fraction)))
        };
        assert_eq!(at(-5.0), (0, None));
        assert_eq!(at(3.0), (0, None), "the first clip has no transition");
        assert_eq!(at(10.0), (0, None), "the first frame of a transition shows only the outgoing clip");
        // The transition ends where the next one begins.
        assert_eq!(at(10.5), (1, Some((0.0, 0.25))));
        assert_eq!((at(12.0), at(1e9)), ((2, None), (2, None)));
        let broken_off =
            TimedTransition { unfinished: true, ..TimedTransition::new(TransitionStyle::Fade, 4.0) };
        let clips = vec![
            clip(0.0, TransitionStyle::Cut, 0.0),
            Clip { transition: broken_off, ..clip(10.0, TransitionStyle::Fade, 4.0) },
        ];
        let timeline = Timeline::new([clips, vec![clip(11.0, TransitionStyle::Cut, 0.0)]].concat()).unwrap();
        let fraction = |time| timeline.at(time).leaving.map(|(_, fraction)| fraction);
        assert_eq!(
            (fraction(10.5), fraction(11.0)),
            (Some(0.125), None),
            "an unfinished transition keeps its speed"
        );
        assert_eq!(Timeline::new(Vec::new()), None);
    }

    #[test]
    fn parameters_keep_their_last_value() {
        let mut one = clip(0.0, TransitionStyle::Cut, 0.0);
        let part = |start, seconds, from, to| Move { param: "swell".to_owned(), start, seconds, from, to };
        one.moves = vec![part(2.0, 4.0, 0.0, 1.0), part(8.0, 0.0, 0.3, 0.5)];
        let at = |time| one.moved("swell", time).unwrap().value;
        assert_eq!([0.0, 2.0, 3.0, 6.0, 7.0, 8.0, 99.0].map(at), [0.0, 0.0, 0.25, 1.0, 1.0, 0.5, 0.5]);
        let part = |time| one.moved("swell", time).unwrap().part;
        assert!(part(3.0) == part(7.0) && part(7.0) != part(8.0), "each animation has its own number");
        let later = Clip { start: 1.0, ..one.clone() };
        assert_ne!(later.moved("swell", 3.0).unwrap().part, part(3.0));
        assert_eq!(one.moved("glow", 3.0), None);
    }
}
