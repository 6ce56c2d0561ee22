//! The audible position, for the show and for readers on other threads.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use super::unheard::{Unheard, UnheardWatch};
use crate::clock::{Clock, SpanHistory};
use crate::output::OutputWatch;
use crate::timeline::SharedTimeline;
use crate::track::TrackInfo;

/// The audible position of a player. Clones share one clock, so none reads an earlier position than another has read
/// before, unless the song was changed: by a seek, a skip or another track.
#[derive(Clone)]
pub struct Position(Arc<Mutex<State>>);

struct State {
    outputs: OutputWatch,
    timeline: SharedTimeline,
    clock: Clock,
    unheard: UnheardWatch,
    place: Place,
}

/// An audible place in the list.
#[derive(Clone)]
pub(super) struct Place {
    /// The track that was last audible.
    pub(super) track: Arc<TrackInfo>,
    /// The position in it, in seconds.
    pub(super) seconds: f64,
    /// Parts of the song that were not heard.
    pub(super) unheard: Unheard,
}

impl Position {
    /// The start of `track`.
    pub(super) fn new(outputs: OutputWatch, timeline: SharedTimeline, track: Arc<TrackInfo>) -> Self {
        let place = Place { track, seconds: 0.0, unheard: Unheard::default() };
        let (clock, unheard) = (Clock::default(), UnheardWatch::default());
        Self(Arc::new(Mutex::new(State { outputs, timeline, clock, unheard, place })))
    }

    /// The position in the audible track now, in seconds.
    pub fn seconds(&self) -> f64 {
        self.look().seconds
    }

    /// The present place.
    pub(super) fn look(&self) -> Place {
        // A reader that failed leaves the clock usable.
        self.0.lock().unwrap_or_else(PoisonError::into_inner).look()
    }
}

impl State {
    fn look(&mut self) -> Place {
        let history: Option<Arc<SpanHistory>> = self.outputs.history();
        let timeline = self.timeline.lock();
        let carry = |from, to| timeline.carry(from, to);
        let audible = self.clock.at(history.as_ref(), Instant::now(), 0.0, carry);
        if let Some(history) = self.clock.history() {
            self.unheard.look(history, carry);
        }
        if let Some(audible) = audible {
            if let Some(place) = timeline.place(audible, 0.0) {
                self.place.seconds = place.song_time;
            }
            if let Some(track) = timeline.track(audible) {
                self.place.track = track;
            }
        }
        self.place.unheard = self.unheard.told();
        self.place.clone()
    }
}
