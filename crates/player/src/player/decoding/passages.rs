//! The tracks that have begun in the segment: the current track, and earlier tracks that may still be audible.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use super::segment::CurrentSegment;
use crate::source::FrameSource;
use crate::track::Track;

struct Playing {
    passage: u64,
    track: Track,
}

pub(super) struct Passages {
    current: Playing,
    /// Earlier tracks of the segment whose ends may still be audible, the oldest first.
    before: VecDeque<Playing>,
    /// The newest passage. Numbers are never reused, so that late features are not assigned to a wrong passage.
    last: u64,
}

impl Passages {
    pub(super) fn new(first: Track) -> Self {
        Self { current: Playing { passage: 0, track: first }, before: VecDeque::new(), last: 0 }
    }

    pub(super) fn track(&self) -> &Track {
        &self.current.track
    }

    pub(super) fn source(&mut self) -> &mut dyn FrameSource {
        &mut *self.current.track.source
    }

    pub(super) fn current(&self) -> u64 {
        self.current.passage
    }

    pub(super) fn earliest(&self) -> u64 {
        self.before.front().unwrap_or(&self.current).passage
    }

    pub(super) fn entry_in(&self, passage: u64) -> u64 {
        let playing = self.before.iter().find(|playing| playing.passage == passage).unwrap_or(&self.current);
        playing.track.info.id
    }

    pub(super) fn has_begun(&self, id: u64, passage: u64) -> bool {
        let mut begun = self.before.iter().chain([&self.current]);
        begun.any(|playing| playing.passage > passage && playing.track.info.id == id)
    }

    pub(super) fn begin_anew(&mut self) {
        self.last += 1;
        self.current.passage = self.last;
    }

    pub(super) fn follow_with(&mut self, track: Track) {
        self.last += 1;
        let current = Playing { passage: self.last, track };
        self.before.push_back(std::mem::replace(&mut self.current, current));
    }

    /// Replaces all tracks by `track`. The track becomes audible only when a segment begins with it.
    pub(super) fn replace_with(&mut self, track: Track) {
        self.forget_earlier();
        self.last += 1;
        self.current = Playing { passage: self.last, track };
    }

    pub(super) fn has_earlier(&self) -> bool {
        !self.before.is_empty()
    }

    pub(super) fn forget_earlier(&mut self) {
        self.before.clear();
    }

    pub(super) fn forget_before(&mut self, passage: u64) {
        while self.before.front().is_some_and(|playing| playing.passage < passage) {
            self.before.pop_front();
        }
    }

    /// Makes the track of `passage` current again if the decoder has already begun later tracks. Returns the next
    /// track, which is no longer at its start. The caller must begin a new segment.
    pub(super) fn return_to(&mut self, passage: u64) -> Option<Track> {
        self.forget_before(passage);
        let mut after = None;
        while self.current.passage > passage
            && let Some(earlier) = self.before.pop_back()
        {
            after = Some(std::mem::replace(&mut self.current, earlier).track);
        }
        after
    }
}

// The song's current position, and the position at which the next segment starts.

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    pub(super) passage: u64,
    /// The time within the passage's track, in seconds.
    pub(super) time: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Goal {
    pub(super) time: f64,
    /// True if only the output changed.
    pub(super) same_run: bool,
    /// The moment at which `time` is due, if the song is running.
    pub(super) due: Option<Instant>,
}

impl Goal {
    pub(super) fn seek(time: f64) -> Self {
        Self { time, same_run: false, due: None }
    }
}

impl CurrentSegment {
    /// Returns the audible position, or the target of a seek in passage `earliest` if the seek is not audible yet.
    pub(super) fn place(&self, earliest: u64) -> Place {
        let heard = self.audible().and_then(|audible| self.audible_segments.lock().place(audible, 0.0));
        heard.map_or(Place { passage: earliest, time: self.start() }, |heard| Place {
            passage: heard.passage,
            time: heard.song_time,
        })
    }

    /// Returns the passage and position at `at` if the song continues. Before a frame is audible, returns `earliest`.
    pub(super) fn course(&self, at: Instant, earliest: u64) -> (u64, Goal) {
        let Place { passage, time } = self.place(earliest);
        let stands = Goal { time, same_run: true, due: None };
        if self.filling.is_none() || self.stands_still() {
            return (passage, stands);
        }
        let Some(course) = self.course_of_output(at) else {
            // The segment has no audible frame yet.
            let runs = |due| {
                let late: Duration = at.saturating_duration_since(due);
                Goal { time: self.start() + late.as_secs_f64(), same_run: true, due: Some(at.max(due)) }
            };
            return (passage, self.due.map_or(stands, runs));
        };
        match self.audible_segments.lock().place(course.audible, 0.0) {
            Some(place) => {
                let due = course.moving.then_some(at);
                (place.passage, Goal { time: place.song_time, same_run: true, due })
            }
            None => (passage, stands),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn three() -> Passages {
        let mut passages = Passages::new(Track::silence(0, 3));
        passages.follow_with(Track::silence(1, 3));
        passages.follow_with(Track::silence(2, 3));
        passages
    }

    #[test]
    fn going_back_gives_the_track_that_came_next() {
        let mut passages = three();
        let (first, last) = (passages.earliest(), passages.current());
        assert_eq!([first, first + 1, last].map(|passage| passages.entry_in(passage)), [0, 1, 2]);
        let after = passages.return_to(first).expect("a later track");
        assert_eq!((passages.track().info.entry, after.info.entry), (0, 1));
        assert!(passages.return_to(first).is_none(), "it is current already");
    }

    #[test]
    fn past_tracks_are_dropped_and_the_current_one_stays() {
        let mut passages = three();
        passages.forget_before(passages.current());
        assert!(!passages.has_earlier());
        assert_eq!((passages.earliest(), passages.track().info.entry), (passages.current(), 2));
    }

    #[test]
    fn tracks_that_were_replaced_do_not_come_back() {
        let mut passages = three();
        let heard = passages.earliest();
        passages.replace_with(Track::silence(7, 9));
        assert!(!passages.has_earlier() && passages.return_to(heard).is_none());
        assert_eq!(passages.track().info.entry, 7);
    }

    #[test]
    fn passage_numbers_are_unique() {
        let mut passages = three();
        let last = passages.current();
        let _ = passages.return_to(last - 1);
        passages.begin_anew();
        assert!(passages.current() > last);
        let last = passages.current();
        passages.replace_with(Track::silence(0, 3));
        assert!(passages.current() > last);
    }
}
