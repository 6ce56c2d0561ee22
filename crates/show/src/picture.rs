//! Image settings of a timeline, which persist across scenes: the brightness and frozen frames.

use super::cue_list::PLAIN_PICTURE;
use super::timeline::{Clip, Move, Timeline};
use crate::limits;

/// Sums of times are rounded to 1 / `TICKS` seconds (nanoseconds), the precision of show files.
const TICKS: f64 = 1e9;

/// The image settings at a moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShownPicture {
    /// Factor on the linear light of the image, 0..1.
    pub brightness: f32,
    /// The frozen frame over the image, if any.
    pub held: Option<Held>,
}

/// A frozen frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Held {
    /// The moment of the song that the frame shows, in seconds.
    pub since: f64,
    /// The opacity of the frozen frame, above 0. At 1, the frame covers the image.
    pub fraction: f32,
}

impl ShownPicture {
    /// An unchanged image.
    pub const PLAIN: Self = Self { brightness: 1.0, held: None };
}

impl Timeline {
    /// Returns the image settings at `time` seconds.
    pub fn picture_at(&self, time: f64) -> ShownPicture {
        let [brightness, freeze] = &self.picture_moves;
        let [light, _] = PLAIN_PICTURE;
        ShownPicture {
            brightness: last_at(brightness, time).map_or(light, |(_, brightness)| brightness),
            held: held_at(freeze, time).next(),
        }
    }

    /// Returns the frozen frames at `time` seconds. The first frame is the frame of [`Timeline::picture_at`]. The
    /// second is the frame that was still fading out when the first was frozen, with its opacity at that time, and so
    /// on. The list is empty if no frame is frozen. The oldest frames are dropped above the
    /// [limit](crate::limits).
    pub fn held_at(&self, time: f64) -> Vec<Held> {
        let [_, freeze] = &self.picture_moves;
        held_at(freeze, time).take(limits::HELD_MAX).collect()
    }

    /// True if the image is dimmed at any moment.
    pub fn dims(&self) -> bool {
        let [brightness, _] = &self.picture_moves;
        brightness.iter().any(|one| one.from.min(one.to) < 1.0)
    }
}

/// Collects all animations of the setting `name`, sorted by start. From the start of a clip until its first
/// animation, the setting has the initial value of that animation, like a parameter.
pub(super) fn all_moves(clips: &[Clip], name: &str) -> Vec<Move> {
    let mut moves = Vec::new();
    for clip in clips {
        let of_clip = clip.moves.iter().filter(|one| one.param == name);
        let first = of_clip.clone().next().filter(|one| !one.is_set_at_once() && one.start > clip.start);
        moves.extend(first.map(|first| Move {
            start: clip.start,
            seconds: 0.0,
            to: first.from,
            ..first.clone()
        }));
        moves.extend(of_clip.cloned());
    }
    moves.sort_by(|a, b| a.start.total_cmp(&b.start));
    moves
}

/// Returns the index and the value of the animation in effect at `time`.
fn last_at(moves: &[Move], time: f64) -> Option<(usize, f32)> {
    let place = moves.partition_point(|one| one.has_begun(time)).checked_sub(1)?;
    moves.get(place).map(|one| (place, one.at(time)))
}

/// Returns the frozen frame at `time`, then the frame that was fading out when this freeze began, and so on.
fn held_at(freeze: &[Move], time: f64) -> impl Iterator<Item = Held> {
    let mut next = last_at(freeze, time).map(|(last, fraction)| (last, fraction, time));
    std::iter::from_fn(move || {
        let (last, fraction, time) = next.take().filter(|(_, fraction, _)| *fraction > 0.0)?;
        let (since, begin) = begin_of_hold(freeze, last, time);
        let before = begin.and_then(|begin| begin.checked_sub(1));
        next = before.and_then(|before| Some((before, freeze.get(before)?.at(since), since)));
        Some(Held { since: (since * TICKS).round() / TICKS, fraction })
    })
}

/// Finds the start of the freeze at `time`: the moment when the opacity rose from zero or jumped up. `last` is the
/// index of the animation in effect. Also returns the index of the animation that starts the freeze, or `None` if the
/// frame was frozen from the start of the song.
fn begin_of_hold(freeze: &[Move], last: usize, time: f64) -> (f64, Option<usize>) {
    for (place, one) in freeze.iter().enumerate().take(last + 1).rev() {
        let before = place.checked_sub(1).and_then(|before| freeze.get(before));
        let before = before.map_or(0.0, |before| before.at(one.start));
        // An animation without length has its final value at once.
        let first = if one.seconds > 0.0 { one.from } else { one.to };
        if (before <= 0.0 && first.max(one.to) > 0.0) || first > before {
            return (one.start, Some(place));
        }
    }
    (time, None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{parse, resolve};
    use mariana_music::SongStructure;

    fn timeline(text: &str) -> Timeline {
        let parsed = parse("test.show", text);
        let cue_list = parsed.cue_list.clone().unwrap_or_else(|| panic!("{}", parsed.render(false)));
        resolve(&cue_list, &SongStructure::default(), &[], |_, _| None).0.unwrap()
    }

    #[test]
    fn a_blackout_stays_across_scenes_until_it_is_set_again() {
        let timeline = timeline(
            "at 0 one\n set picture brightness = 1 -> 0 over 2 s after 4 s\nat 8 s two cut\nat 10 s three cut\n\
             set picture brightness = 0 -> 0.5 over 1 s after 1 s",
        );
        let at = |time| timeline.picture_at(time).brightness;
        assert_eq!(
            [0.0, 4.0, 5.0, 6.0, 9.0, 10.5, 11.5, 99.0].map(at),
            [1.0, 1.0, 0.5, 0.0, 0.0, 0.0, 0.25, 0.5]
        );
        assert!(timeline.dims());
        assert!(timeline.clips().iter().all(|clip| clip.turns_at(5.0) == crate::UNTURNED));
    }

    #[test]
    fn a_frame_is_frozen_at_its_moment_and_fades_out() {
        let timeline = timeline(
            "at 0 one\n set picture freeze = 1 after 3.3 s\nat 5 s two cut\n set picture freeze = 1 -> 0 over 2 s after 1 s\n\
             at 9 s three cut\n set picture freeze = 0 -> 1 over 1 s -> 0 over 0 s",
        );
        let at = |time| timeline.picture_at(time).held.map(|held| (held.since, held.fraction));
        assert_eq!([0.0, 3.0, 8.5].map(at), [None; 3]);
        assert_eq!([3.3, 4.0, 5.5, 7.0].map(at), [1.0, 1.0, 1.0, 0.5].map(|fraction| Some((3.3, fraction))));
        assert_eq!([at(9.5), at(10.5)], [Some((9.0, 0.5)), None]);
        assert!(!timeline.dims());
    }

    #[test]
    fn another_frame_is_frozen_while_one_fades_out() {
        let timeline = timeline(
            "at 0 one\n set picture freeze = 1 -> 0 over 2 s after 1 s\n set picture freeze = 1 after 2 s",
        );
        let at = |time| timeline.picture_at(time).held.map(|held| (held.since, held.fraction));
        assert_eq!([at(1.5), at(2.5)], [Some((0.0, 0.75)), Some((2.0, 1.0))]);
    }

    #[test]
    fn a_frozen_frame_contains_a_fraction_of_earlier_ones() {
        let timeline = timeline(
            "at 0 one\n set picture freeze = 1 -> 0 over 4 s -> 1 over 0 s after 1 s\n\
             at 3 s two cut\n set picture freeze = 0.5 -> 1 over 0 s -> 0 over 4 s\n\
             at 5 s three cut\n set picture freeze = 0.5 -> 0.75 over 0 s -> 0 over 6 s",
        );
        let at = |time| -> Vec<(f64, f32)> {
            timeline.held_at(time).iter().map(|held| (held.since, held.fraction)).collect()
        };
        assert_eq!(at(2.0), [(0.0, 0.75)]);
        assert_eq!([at(3.0), at(4.0)], [vec![(3.0, 1.0), (0.0, 0.5)], vec![(3.0, 0.75), (0.0, 0.5)]]);
        assert_eq!(at(7.0), [(5.0, 0.5), (3.0, 0.5), (0.0, 0.5)]);
        assert_eq!(at(11.5), []);
        assert_eq!(timeline.picture_at(7.0).held, timeline.held_at(7.0).first().copied());
    }

    #[test]
    fn the_number_of_mixed_frames_is_limited() {
        let mut text = "at 0 one\n set picture freeze = 1".to_owned();
        for _ in 0..limits::HELD_MAX + 5 {
            text.push_str(" -> 0.5 over 1 s -> 1 over 0 s");
        }
        let held = timeline(&text).held_at(1_000.0);
        assert_eq!(held.len(), limits::HELD_MAX);
        assert_eq!(
            held.first().map(|held| held.since),
            Some(limits::HELD_MAX as f64 + 5.0),
            "the limit drops the oldest frames"
        );
    }
}
