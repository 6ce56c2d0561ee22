//! The song's current position, and the position at which the next segment starts.

use std::time::{Duration, Instant};

use super::segment::CurrentSegment;

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
        let heard = self.audible().and_then(|audible| self.audible_segments().lock().place(audible, 0.0));
        heard.map_or(Place { passage: earliest, time: self.start() }, |heard| Place {
            passage: heard.passage,
            time: heard.song_time,
        })
    }

    /// Returns the passage and position at `at` if the song continues. Before a frame is audible, returns `earliest`.
    pub(super) fn course(&self, at: Instant, earliest: u64) -> (u64, Goal) {
        let Place { passage, time } = self.place(earliest);
        let stands = Goal { time, same_run: true, due: None };
        if !self.is_filling() || self.stands_still() {
            return (passage, stands);
        }
        let Some(course) = self.course_of_output(at) else {
            // The segment has no audible frame yet.
            let runs = |due| {
                let late: Duration = at.saturating_duration_since(due);
                Goal { time: self.start() + late.as_secs_f64(), same_run: true, due: Some(at.max(due)) }
            };
            return (passage, self.due().map_or(stands, runs));
        };
        match self.audible_segments().lock().place(course.audible, 0.0) {
            Some(place) => {
                let due = course.moving.then_some(at);
                (place.passage, Goal { time: place.song_time, same_run: true, due })
            }
            None => (passage, stands),
        }
    }
}
