//! What stands behind the frames that were handed out: song time and features, by segment.
//!
//! The decoding and the analysis thread write it, the window reads it; each holds it for moments only, and
//! the callback never touches it.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::clock::Audible;
use crate::dsp::{FeatureTrack, Features, Sound, TimedFeatures};
use crate::limits::LIMITS;

/// Segments remembered: the newest and those that may still sound behind it.
const SEGMENTS_KEPT: usize = 8;

/// What a segment's track holds beyond the largest delay of the picture, in seconds: the ring and a reserve.
const TRACK_RESERVE: f64 = 2.0;

/// From this time of the segment on, the song runs from this time.
#[derive(Debug, Clone, Copy)]
struct Anchor {
    segment_time: f64,
    song_time: f64,
    lap: u32,
}

struct SegmentNotes {
    id: u64,
    /// Frames per second of the device that the segment was made for.
    rate: u32,
    /// Song time of the segment's first frame; the track counts from there on and goes on over laps.
    start: f64,
    /// Never empty; in order of time.
    anchors: VecDeque<Anchor>,
    track: FeatureTrack,
    end_frame: Option<u64>,
}

/// A place in the song.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SongPlace {
    /// Seconds since the song's start.
    pub song_time: f64,
    /// How often the song began anew within the segment.
    pub lap: u32,
    /// The sound of that place.
    pub features: Features,
}

/// The segments of a playback that may be audible.
#[derive(Default)]
pub struct Timeline {
    segments: VecDeque<SegmentNotes>,
}

/// A [`Timeline`] shared by threads.
#[derive(Clone, Default)]
pub struct SharedTimeline(Arc<Mutex<Timeline>>);

impl SharedTimeline {
    /// Access, for moments only. A thread that failed while it held the timeline leaves it usable.
    pub fn lock(&self) -> MutexGuard<'_, Timeline> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Timeline {
    /// Adds segment `id`, whose first frame is at `start` seconds of the song, for a device of `rate` frames per second.
    pub fn begin(&mut self, id: u64, rate: u32, start: f64) {
        if self.segments.len() == SEGMENTS_KEPT {
            self.segments.pop_front();
        }
        let anchors = VecDeque::from([Anchor { segment_time: 0.0, song_time: start, lap: 0 }]);
        let track = FeatureTrack::new(LIMITS.latency_ms_max / 1000.0 + TRACK_RESERVE);
        self.segments.push_back(SegmentNotes {
            id,
            rate: rate.max(1),
            start,
            anchors,
            track,
            end_frame: None,
        });
    }

    /// Forgets a segment that was never handed out.
    pub fn discard(&mut self, id: u64) {
        self.segments.retain(|segment| segment.id != id);
    }

    /// Corrects the song time of a segment's first frame (the song was shorter than was thought).
    pub fn set_start(&mut self, id: u64, start: f64) {
        let Some(segment) = self.find_mut(id) else { return };
        segment.start = start;
        if let Some(anchor) = segment.anchors.front_mut() {
            anchor.song_time = start;
        }
    }

    /// Notes that at `segment_time` (seconds since the segment's start) the song begins anew. `played` is the
    /// segment time that is surely past: what lies before it is forgotten.
    pub fn begin_lap(&mut self, id: u64, segment_time: f64, played: f64) {
        let Some(segment) = self.find_mut(id) else { return };
        let lap = segment.anchors.back().map_or(0, |last| last.lap.wrapping_add(1));
        segment.anchors.push_back(Anchor { segment_time, song_time: 0.0, lap });
        while segment.anchors.get(1).is_some_and(|second| second.segment_time <= played) {
            segment.anchors.pop_front();
        }
    }

    /// Notes that the segment has `end_frame` frames and no more will come.
    pub fn finish(&mut self, id: u64, end_frame: u64) {
        if let Some(segment) = self.find_mut(id) {
            segment.end_frame = Some(end_frame);
        }
    }

    /// Adds the features of a moment; its time counts from the song's start on and goes on over laps.
    pub fn push_features(&mut self, id: u64, moment: &TimedFeatures) {
        if let Some(segment) = self.find_mut(id) {
            segment.track.push(moment);
        }
    }

    /// Where `audible` is in the song, `ahead` seconds later (never before the segment's start nor after its end).
    /// None for a segment that is not remembered.
    pub fn place(&self, audible: Audible, ahead: f64) -> Option<SongPlace> {
        let (segment, time) = self.locate(audible, ahead)?;
        let index = segment.anchors.partition_point(|anchor| anchor.segment_time <= time).saturating_sub(1);
        let anchor = segment.anchors.get(index)?;
        Some(SongPlace {
            song_time: (anchor.song_time + time - anchor.segment_time).max(0.0),
            lap: anchor.lap,
            features: segment.track.at(segment.start + time),
        })
    }

    /// The sound of the same place, with its tables.
    pub fn sound(&self, audible: Audible, ahead: f64) -> Option<Sound> {
        let (segment, time) = self.locate(audible, ahead)?;
        Some(segment.track.sound_at(segment.start + time))
    }

    /// The segment, and the time in it that is meant.
    fn locate(&self, audible: Audible, ahead: f64) -> Option<(&SegmentNotes, f64)> {
        let segment = self.find(audible.segment)?;
        let rate = f64::from(segment.rate);
        let end = segment.end_frame.map_or(f64::INFINITY, |frame| frame as f64 / rate);
        Some((segment, (audible.frame / rate + ahead).min(end).max(0.0)))
    }

    /// Whether `audible` is the end of a segment after which nothing comes.
    pub fn is_end(&self, audible: Audible) -> bool {
        let newest = self.segments.back();
        newest.is_some_and(|segment| {
            segment.id == audible.segment && segment.end_frame.is_some_and(|end| audible.frame >= end as f64)
        })
    }

    fn find(&self, id: u64) -> Option<&SegmentNotes> {
        self.segments.iter().rev().find(|segment| segment.id == id)
    }

    fn find_mut(&mut self, id: u64) -> Option<&mut SegmentNotes> {
        self.segments.iter_mut().rev().find(|segment| segment.id == id)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(segment: u64, frame: f64) -> Audible {
        Audible { segment, frame }
    }

    fn song_time(timeline: &Timeline, segment: u64, frame: f64) -> Option<(f64, u32)> {
        timeline.place(at(segment, frame), 0.0).map(|place| (place.song_time, place.lap))
    }

    #[test]
    fn laps_and_seeks_are_told_apart() {
        let mut timeline = Timeline::default();
        timeline.begin(1, 100, 7.0);
        timeline.begin_lap(1, 3.0, 0.0);
        timeline.begin_lap(1, 13.0, 0.0);
        timeline.begin(2, 200, 2.0);
        assert_eq!(song_time(&timeline, 1, 150.0), Some((8.5, 0)));
        assert_eq!(song_time(&timeline, 1, 300.0), Some((0.0, 1)));
        assert_eq!(song_time(&timeline, 1, 1350.0), Some((0.5, 2)));
        assert_eq!(song_time(&timeline, 2, 150.0), Some((2.75, 0)));
        assert_eq!(song_time(&timeline, 3, 0.0), None);
        timeline.discard(2);
        assert_eq!(song_time(&timeline, 2, 150.0), None);
    }

    #[test]
    fn features_belong_to_their_segment() {
        let mut timeline = Timeline::default();
        let moment = |time: f64, volume| {
            let features = Features { volume: [volume; 2], ..Features::default() };
            TimedFeatures::new(time, (100.0 * time) as u64, features)
        };
        timeline.begin(1, 100, 5.0);
        timeline.push_features(1, &moment(5.0, 0.25));
        timeline.begin(2, 100, 5.0);
        timeline.push_features(2, &moment(5.0, 0.75));
        timeline.push_features(2, &moment(7.0, 0.25));
        let volume = |segment, frame, ahead| {
            timeline.place(at(segment, frame), ahead).map(|place| place.features.volume[0])
        };
        assert_eq!(volume(1, 10.0, 0.0), Some(0.25));
        assert_eq!(volume(2, 0.0, 0.0), Some(0.75));
        assert_eq!(volume(2, 100.0, 0.0), Some(0.5));
        assert_eq!(volume(2, 0.0, 1.0), Some(0.5));
    }

    #[test]
    fn what_is_past_is_forgotten_and_the_end_is_known() {
        let mut timeline = Timeline::default();
        timeline.begin(1, 100, 0.0);
        (1..1000).for_each(|n| timeline.begin_lap(1, f64::from(n), f64::from(n) - 2.0));
        assert!(timeline.segments[0].anchors.len() <= 4);
        assert_eq!(song_time(&timeline, 1, 99_950.0), Some((0.5, 999)));
        assert!(!timeline.is_end(at(1, 99_950.0)));
        timeline.finish(1, 99_950);
        assert!(timeline.is_end(at(1, 99_950.0)));
        assert_eq!(song_time(&timeline, 1, 120_000.0), Some((0.5, 999)));
    }
}
