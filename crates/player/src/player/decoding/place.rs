//! Where the decoding thread is in its tracks: what is audible, and where the song goes on.

use std::time::{Duration, Instant};

use super::{Decoding, Next};
use crate::clock::Audible;

/// Where the song goes on.
#[derive(Clone, Copy)]
pub(super) struct Goal {
    /// Time of the track, in seconds.
    pub(super) time: f64,
    /// True if only the output changed.
    pub(super) same_run: bool,
    /// When that time is due, if the song is running.
    pub(super) due: Option<Instant>,
}

impl Goal {
    /// A seek or a skip.
    pub(super) fn seek(time: f64) -> Self {
        Self { time, same_run: false, due: None }
    }
}

impl Decoding {
    pub(super) fn audible(&self) -> Option<Audible> {
        let (link, filling) = (self.link.as_ref()?, self.filling.as_ref()?);
        link.history.at(Instant::now()).filter(|audible| audible.segment == filling.id)
    }

    /// The passage that is audible and the time in its track, in seconds; or the target of a seek that is not heard
    /// yet.
    pub(super) fn place(&self) -> (u64, f64) {
        let Some(filling) = &self.filling else { return (self.current.passage, self.start) };
        let place = self.audible().and_then(|audible| self.timeline.lock().place(audible, 0.0));
        let first = self.before.front().unwrap_or(&self.current).passage;
        place.map_or((first, filling.target), |place| (place.passage, place.song_time))
    }

    /// The passage and the place of the song at a moment if it runs on, whatever the output does.
    pub(super) fn course(&self, at: Instant) -> (u64, Goal) {
        let (passage, time) = self.place();
        let stands = Goal { time, same_run: true, due: None };
        let (Some(link), Some(filling)) = (&self.link, &self.filling) else { return (passage, stands) };
        if self.stood_still == Some(link.history.calls()) {
            // While the process stood still so did the song, and the output has not called since then.
            return (passage, stands);
        }
        let course = link.history.course(at).filter(|course| course.audible.segment == filling.id);
        let Some(course) = course else {
            // Nothing of the segment has been heard yet.
            let runs = |due| {
                let late: Duration = at.saturating_duration_since(due);
                Goal { time: filling.target + late.as_secs_f64(), same_run: true, due: Some(at.max(due)) }
            };
            return (passage, self.due.map_or(stands, runs));
        };
        match self.timeline.lock().place(course.audible, 0.0) {
            Some(place) => {
                let due = course.moving.then_some(at);
                (place.passage, Goal { time: place.song_time, same_run: true, due })
            }
            None => (passage, stands),
        }
    }

    /// Drops tracks that are no longer audible.
    pub(super) fn let_go(&mut self) {
        if self.before.is_empty() {
            return;
        }
        let (audible, _) = self.place();
        while self.before.front().is_some_and(|playing| playing.passage < audible) {
            self.before.pop_front();
        }
    }

    /// The entry of the list that is audible.
    pub(super) fn audible_entry(&self) -> usize {
        let (audible, _) = self.place();
        let playing = self.before.iter().find(|playing| playing.passage == audible).unwrap_or(&self.current);
        playing.track.info.entry
    }

    /// Makes the audible track the current one again, if the next one was begun ahead. A new segment must follow.
    pub(super) fn go_back_to_audible(&mut self) {
        let (audible, _) = self.place();
        self.go_back_to(audible);
    }

    /// The same for a passage that may be later than the audible one.
    pub(super) fn go_back_to(&mut self, passage: u64) {
        while self.before.front().is_some_and(|playing| playing.passage < passage) {
            self.before.pop_front();
        }
        while self.current.passage > passage {
            let Some(earlier) = self.before.pop_back() else { return };
            let mut later = std::mem::replace(&mut self.current, earlier).track;
            self.next = if later.source.seek(0.0).is_ok() { Next::Track(later) } else { Next::Unasked };
        }
    }
}
