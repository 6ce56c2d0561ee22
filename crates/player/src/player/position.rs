//! The audible position, for the show and for readers on other threads.

use std::sync::{Arc, Mutex};
use std::time::Instant;

use mariana_work::lock;

use super::missed_audio::{MissedAudio, MissedAudioWatch};
use crate::audible_segments::SharedAudibleSegments;
use crate::clock::Clock;
use crate::output::OutputWatch;
use crate::track::TrackInfo;

/// The audible position of a player. Clones use the same clock. So if one reader has seen a position, no reader sees an
/// earlier position afterwards, except after a seek, a skip or a change of track.
#[derive(Clone)]
pub struct Position(Arc<Mutex<State>>);

struct State {
    outputs: OutputWatch,
    audible_segments: SharedAudibleSegments,
    clock: Clock,
    missed_audio: MissedAudioWatch,
    place: Place,
}

#[derive(Clone)]
pub(super) struct Place {
    pub(super) track: Arc<TrackInfo>,
    pub(super) seconds: f64,
    pub(super) missed_audio: MissedAudio,
}

impl Position {
    pub(super) fn new(
        outputs: OutputWatch,
        audible_segments: SharedAudibleSegments,
        track: Arc<TrackInfo>,
    ) -> Self {
        let place = Place { track, seconds: 0.0, missed_audio: MissedAudio::default() };
        let (clock, missed_audio) = (Clock::default(), MissedAudioWatch::default());
        Self(Arc::new(Mutex::new(State { outputs, audible_segments, clock, missed_audio, place })))
    }

    /// Returns the current position in the audible track, in seconds.
    pub fn seconds(&self) -> f64 {
        self.current().seconds
    }

    pub(super) fn current(&self) -> Place {
        // The clock stays usable if a reader panicked.
        lock(&self.0).current()
    }
}

impl State {
    fn current(&mut self) -> Place {
        let history = lock(&self.outputs).note.clone();
        let audible_segments = self.audible_segments.lock();
        let carry = |from, to| audible_segments.carry(from, to);
        let audible = self.clock.at(history.as_ref(), Instant::now(), 0.0, carry);
        if let Some(history) = self.clock.history() {
            self.missed_audio.update(history, carry);
        }
        if let Some(place) = audible.and_then(|audible| audible_segments.place(audible, 0.0)) {
            (self.place.seconds, self.place.track) = (place.song_time, place.track);
        }
        self.place.missed_audio = self.missed_audio.reported;
        self.place.clone()
    }
}
