//! The audible moment for the image, which may be shifted against the device.

use std::sync::Arc;
use std::time::Instant;

use mariana_music::{Features, Recent, SongMoment, Sound};

use crate::audible_segments::{SharedAudibleSegments, SongPlace};
use crate::clock::{Audible, Clock, SpanHistory};
use crate::limits;
use crate::output::OutputWatch;
use crate::track::TrackInfo;
use mariana_work::lock;

/// The audible moment of a song.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Moment {
    /// Position in the track, in seconds.
    pub song_time: f64,
    /// The features of the sound.
    pub features: Features,
    /// The position in the song's structure. The player sets the default value, which callers replace.
    pub song: SongMoment,
    /// The track's id ([`TrackInfo::id`]); 0 for an input.
    pub track: u64,
    /// A number that grows with each seek and device change. The song time continues through a device change.
    pub segment: u64,
    /// A number that grows each time a track starts again or another track starts in the segment.
    pub lap: u32,
}

pub(super) struct AudibleMoment {
    outputs: OutputWatch,
    audible_segments: SharedAudibleSegments,
    /// This clock is separate from the position's clock, because the image may be shifted.
    clock: Clock,
    moment: Moment,
    /// The audible frame of the last moment, and the number of seconds by which the image looks ahead.
    heard: Option<(Audible, f64)>,
    /// The latency shift of the last call, in seconds.
    shift: f64,
}

impl AudibleMoment {
    pub(super) fn new(outputs: OutputWatch, audible_segments: SharedAudibleSegments, track: u64) -> Self {
        let moment = Moment { track, ..Moment::default() };
        Self { outputs, audible_segments, clock: Clock::default(), moment, heard: None, shift: 0.0 }
    }

    pub(super) fn now(&mut self, latency_shift: f64) -> Moment {
        let limit = limits::LATENCY_MS_MAX / 1000.0;
        let shift = if latency_shift.is_finite() { latency_shift.clamp(-limit, limit) } else { 0.0 };
        self.shift = shift.max(0.0);
        let history = lock(&self.outputs).note.clone();
        let audible_segments = self.audible_segments.lock();
        let carry = |from, to| audible_segments.carry(from, to);
        if let Some(audible) = self.clock.at(history.as_ref(), Instant::now(), self.shift, carry)
            && let Some(place) = audible_segments.place(audible, (-shift).max(0.0))
        {
            let segment = audible.segment;
            let SongPlace { song_time, lap, track, features, .. } = place;
            self.moment = Moment { song_time, features, track: track.id, segment, lap, ..Moment::default() };
            self.heard = Some((audible, (-shift).max(0.0)));
        }
        drop(audible_segments);
        self.moment
    }

    /// Returns the sound at a time of the track, in seconds; the nearest known sound if it is forgotten or
    /// comes from before a seek.
    pub(super) fn sound_at(&self, song_time: f64) -> Sound {
        let back = self.moment.song_time - song_time;
        let sound =
            self.heard.and_then(|(audible, ahead)| self.audible_segments.lock().sound(audible, ahead - back));
        sound.unwrap_or_else(|| self.moment.features.into())
    }

    /// Returns the known sound of the seconds before an earlier time of the track.
    pub(super) fn recent(&self, song_time: f64) -> Vec<Recent> {
        let back = self.moment.song_time - song_time;
        let recent =
            self.heard.map(|(audible, ahead)| self.audible_segments.lock().recent(audible, ahead - back));
        recent.unwrap_or_default()
    }

    /// Returns two values: true if the (possibly delayed) image has shown the last frame; and the next track.
    pub(super) fn end_and_next(
        &mut self,
        history: Option<&Arc<SpanHistory>>,
    ) -> (bool, Option<Arc<TrackInfo>>) {
        let audible_segments = self.audible_segments.lock();
        let carry = |from, to| audible_segments.carry(from, to);
        let shown = self.clock.at(history, Instant::now(), self.shift, carry);
        (shown.is_some_and(|shown| audible_segments.is_end(shown)), audible_segments.next.clone())
    }
}
