//! Song times and features of the delivered frames, by segment. The decoding thread and the analysis thread write them,
//! and the window reads them. Each of these threads holds the lock only briefly; the callback never takes the lock.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard};

use super::clock::Audible;
use super::track::TrackInfo;
use crate::limits;
use mariana_music::{FeatureTrack, Features, Recent, Sound, TimedFeatures};
use mariana_work::lock;

const SEGMENTS_KEPT: usize = 8;

/// Maximum number of passages kept per segment, so that many short passages do not fill the memory.
const PASSAGES_KEPT: usize = 8;

/// Seconds of features that a passage keeps beyond the largest delay of the image, for the ring and a reserve.
const TRACK_RESERVE: f64 = 2.0;

#[derive(Debug, Clone, Copy)]
struct Anchor {
    segment_time: f64,
    song_time: f64,
    lap: u32,
}

/// A track within a segment, including its repetitions. Each passage is one run of the analysis.
struct Passage {
    id: u64,
    track: Arc<TrackInfo>,
    segment_time: f64,
    /// The track time at the passage's start. The times of the features continue from this time over all laps.
    start: f64,
    /// Ordered by time, never empty.
    anchors: VecDeque<Anchor>,
    features: FeatureTrack,
}

struct SegmentNotes {
    id: u64,
    /// A number that is the same for all segments between two seeks or skips.
    run: u64,
    rate: u32,
    /// Ordered by time, never empty.
    passages: VecDeque<Passage>,
    laps: u32,
    end_frame: Option<u64>,
}

/// A position in a track.
#[derive(Debug, Clone, PartialEq)]
pub struct SongPlace {
    /// Seconds since the track's start.
    pub song_time: f64,
    /// A number that grows each time a track starts again or another track starts in the segment.
    pub lap: u32,
    /// The passage that contains the position.
    pub passage: u64,
    /// The track.
    pub track: Arc<TrackInfo>,
    /// The features at the position.
    pub features: Features,
}

/// The segments of a playback that may still be audible or become audible.
#[derive(Default)]
pub struct AudibleSegments {
    segments: VecDeque<SegmentNotes>,
    /// The track that follows the track being decoded; `None` if the following track is unknown or the same.
    pub next: Option<Arc<TrackInfo>>,
}

/// [`AudibleSegments`] for several threads.
#[derive(Clone, Default)]
pub struct SharedAudibleSegments(Arc<Mutex<AudibleSegments>>);

impl SharedAudibleSegments {
    /// Locks the segments, even if a thread panicked while it held the lock. Hold the lock only briefly.
    pub fn lock(&self) -> MutexGuard<'_, AudibleSegments> {
        lock(&self.0)
    }
}

impl AudibleSegments {
    /// Adds segment `id` for a device of `rate` frames per second. The segment begins with passage `passage`: `track`
    /// from `start` seconds on. If only the device changed, `run` is the same number as for the previous segment.
    pub fn begin(&mut self, id: u64, run: u64, rate: u32, passage: u64, start: f64, track: Arc<TrackInfo>) {
        if self.segments.len() == SEGMENTS_KEPT {
            self.segments.pop_front();
        }
        let passages = VecDeque::from([Passage::new(passage, track, 0.0, start, 0)]);
        self.segments.push_back(SegmentNotes {
            id,
            run,
            rate: rate.max(1),
            passages,
            laps: 0,
            end_frame: None,
        });
    }

    /// Removes a segment that was never handed over.
    pub fn discard(&mut self, id: u64) {
        self.segments.retain(|segment| segment.id != id);
    }

    /// Corrects the track time at which a passage begins, because the track is shorter than its stated duration.
    pub fn set_start(&mut self, passage: u64, start: f64) {
        let Some(passage) = self.passage_mut(passage) else { return };
        passage.start = start;
        if let Some(anchor) = passage.anchors.front_mut() {
            anchor.song_time = start;
        }
    }

    /// Records that the track starts again at `segment_time` (seconds since the segment's start), or that a passage of
    /// the track `next` begins there. Passages and anchors before the segment time `played`, which has certainly been
    /// heard, are dropped.
    pub fn begin_lap(
        &mut self,
        id: u64,
        segment_time: f64,
        played: f64,
        next: Option<(u64, Arc<TrackInfo>)>,
    ) {
        let Some(segment) = self.find_mut(id) else { return };
        segment.laps = segment.laps.wrapping_add(1);
        let lap = segment.laps;
        if let Some((passage, track)) = next {
            segment.passages.push_back(Passage::new(passage, track, segment_time, 0.0, lap));
            while segment.passages.len() > PASSAGES_KEPT
                || segment.passages.get(1).is_some_and(|second| second.segment_time <= played)
            {
                segment.passages.pop_front();
            }
        } else if let Some(passage) = segment.passages.back_mut() {
            passage.anchors.push_back(Anchor { segment_time, song_time: 0.0, lap });
            while passage.anchors.get(1).is_some_and(|second| second.segment_time <= played) {
                passage.anchors.pop_front();
            }
        }
    }

    /// Records that the segment is complete and has `end_frame` frames.
    pub fn finish(&mut self, id: u64, end_frame: u64) {
        if let Some(segment) = self.find_mut(id) {
            segment.end_frame = Some(end_frame);
        }
    }

    /// True if the features of the segment's first moment are known.
    pub fn has_begun(&self, id: u64) -> bool {
        let first = self.find(id).and_then(|segment| segment.passages.front());
        first.is_some_and(|passage| passage.features.span().is_some_and(|(_, last)| last >= passage.start))
    }

    /// Adds a moment's features to `passage`. The moment's time counts from the track's start, over all laps.
    pub fn push_features(&mut self, passage: u64, moment: &TimedFeatures) {
        if let Some(passage) = self.passage_mut(passage) {
            passage.features.push(moment);
        }
    }

    /// Returns the position `ahead` seconds after `audible`, or the segment's end; `None` if the segment is unknown.
    pub fn place(&self, audible: Audible, ahead: f64) -> Option<SongPlace> {
        let (passage, time) = self.passage_at(audible, ahead)?;
        let index = passage.anchors.partition_point(|anchor| anchor.segment_time <= time).saturating_sub(1);
        let anchor = passage.anchors.get(index)?;
        Some(SongPlace {
            song_time: (anchor.song_time + time - anchor.segment_time).max(0.0),
            lap: anchor.lap,
            passage: passage.id,
            track: passage.track.clone(),
            features: passage.features.at(passage.start + time - passage.segment_time),
        })
    }

    /// Returns the frame of segment `to` that has the same track time as `from`. The frame is negative if `to` starts
    /// later. Returns `None` if a seek, a skip or another track separates `from` and `to`.
    pub fn carry(&self, from: Audible, to: u64) -> Option<f64> {
        let (passage, _) = self.passage_at(from, 0.0)?;
        let (before, after) = (self.find(from.segment)?, self.find(to)?);
        let first = after.passages.front()?;
        if before.run != after.run || !Arc::ptr_eq(&passage.track, &first.track) {
            return None;
        }
        let (time, anchor) = (self.place(from, 0.0)?.song_time, first.anchors.front()?);
        Some((time - anchor.song_time + anchor.segment_time) * f64::from(after.rate))
    }

    fn passage_at(&self, audible: Audible, ahead: f64) -> Option<(&Passage, f64)> {
        let segment = self.find(audible.segment)?;
        let rate = f64::from(segment.rate);
        let end = segment.end_frame.map_or(f64::INFINITY, |frame| frame as f64 / rate);
        let time = (audible.frame / rate + ahead).min(end);
        let passages = &segment.passages;
        let index = passages.partition_point(|passage| passage.segment_time <= time).saturating_sub(1);
        Some((passages.get(index)?, time))
    }

    /// Returns the sound and its tables `ahead` seconds after `audible`.
    pub fn sound(&self, audible: Audible, ahead: f64) -> Option<Sound> {
        let (passage, time) = self.passage_at(audible, ahead)?;
        Some(passage.features.sound_at(passage.start + time - passage.segment_time))
    }

    /// Returns the sound of the last seconds of the track before the time `ahead` seconds after `audible`.
    pub fn recent(&self, audible: Audible, ahead: f64) -> Vec<Recent> {
        let Some((passage, time)) = self.passage_at(audible, ahead) else { return Vec::new() };
        passage.features.recent(passage.start + time - passage.segment_time)
    }

    /// True if `audible` is the end of the newest segment.
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

    fn passage_mut(&mut self, id: u64) -> Option<&mut Passage> {
        let passages = self.segments.iter_mut().rev().flat_map(|segment| segment.passages.iter_mut().rev());
        passages.into_iter().find(|passage| passage.id == id)
    }
}

impl Passage {
    fn new(id: u64, track: Arc<TrackInfo>, segment_time: f64, start: f64, lap: u32) -> Self {
        let anchors = VecDeque::from([Anchor { segment_time, song_time: start, lap }]);
        let features = FeatureTrack::new(limits::LATENCY_MS_MAX / 1000.0 + TRACK_RESERVE);
        Self { id, track, segment_time, start, anchors, features }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::track::Track;

    fn begin(audible_segments: &mut AudibleSegments, id: u64, rate: u32, start: f64) {
        audible_segments.begin(id, id, rate, id, start, Track::silence(id as usize, 9).info);
    }

    fn at(segment: u64, frame: f64) -> Audible {
        Audible { segment, frame }
    }

    fn song_time(audible_segments: &AudibleSegments, segment: u64, frame: f64) -> Option<(f64, u32)> {
        audible_segments.place(at(segment, frame), 0.0).map(|place| (place.song_time, place.lap))
    }

    #[test]
    fn laps_and_seeks_are_distinguished() {
        let mut audible_segments = AudibleSegments::default();
        begin(&mut audible_segments, 1, 100, 7.0);
        audible_segments.begin_lap(1, 3.0, 0.0, None);
        audible_segments.begin_lap(1, 13.0, 0.0, None);
        begin(&mut audible_segments, 2, 200, 2.0);
        assert_eq!(song_time(&audible_segments, 1, 150.0), Some((8.5, 0)));
        assert_eq!(song_time(&audible_segments, 1, 300.0), Some((0.0, 1)));
        assert_eq!(song_time(&audible_segments, 1, 1350.0), Some((0.5, 2)));
        assert_eq!(song_time(&audible_segments, 2, 150.0), Some((2.75, 0)));
        assert_eq!(song_time(&audible_segments, 3, 0.0), None);
        audible_segments.discard(2);
        assert_eq!(song_time(&audible_segments, 2, 150.0), None);
    }

    #[test]
    fn features_belong_to_their_segment() {
        let mut audible_segments = AudibleSegments::default();
        let moment = |time: f64, volume| {
            let features = Features { volume: [volume; 2], ..Features::default() };
            TimedFeatures::new(time, (100.0 * time) as u64, features)
        };
        begin(&mut audible_segments, 1, 100, 5.0);
        audible_segments.push_features(1, &moment(5.0, 0.25));
        begin(&mut audible_segments, 2, 100, 5.0);
        audible_segments.push_features(2, &moment(5.0, 0.75));
        audible_segments.push_features(2, &moment(7.0, 0.25));
        let volume = |segment, frame, ahead| {
            audible_segments.place(at(segment, frame), ahead).map(|place| place.features.volume[0])
        };
        assert_eq!(volume(1, 10.0, 0.0), Some(0.25));
        assert_eq!(volume(2, 0.0, 0.0), Some(0.75));
        assert_eq!(volume(2, 100.0, 0.0), Some(0.5));
        assert_eq!(volume(2, 0.0, 1.0), Some(0.5));
    }

    #[test]
    fn past_anchors_are_dropped_and_the_end_is_known() {
        let mut audible_segments = AudibleSegments::default();
        begin(&mut audible_segments, 1, 100, 0.0);
        (1..1000).for_each(|n| audible_segments.begin_lap(1, f64::from(n), f64::from(n) - 2.0, None));
        assert!(audible_segments.segments[0].passages[0].anchors.len() <= 4);
        assert_eq!(song_time(&audible_segments, 1, 99_950.0), Some((0.5, 999)));
        assert!(!audible_segments.is_end(at(1, 99_950.0)));
        audible_segments.finish(1, 99_950);
        assert!(audible_segments.is_end(at(1, 99_950.0)));
        assert_eq!(song_time(&audible_segments, 1, 120_000.0), Some((0.5, 999)));
    }

    #[test]
    fn tracks_follow_each_other_with_their_own_times_and_features() {
        let mut audible_segments = AudibleSegments::default();
        begin(&mut audible_segments, 1, 100, 8.0);
        audible_segments.begin_lap(1, 2.0, 0.0, None);
        audible_segments.begin_lap(1, 12.0, 0.0, Some((2, Track::silence(2, 9).info)));
        let moment = |time: f64, volume| {
            let features = Features { volume: [volume; 2], ..Features::default() };
            TimedFeatures::new(time, (100.0 * time) as u64, features)
        };
        // The analysis runs after the decoding: late features of the first track belong to the first track.
        audible_segments.push_features(1, &moment(19.0, 0.25));
        audible_segments.push_features(2, &moment(0.0, 0.5));
        audible_segments.push_features(1, &moment(20.0, 0.75));
        let reported = |audible_segments: &AudibleSegments, frame| {
            let place = audible_segments.place(at(1, frame), 0.0).unwrap();
            let entry = audible_segments.place(at(1, frame), 0.0).unwrap().track.entry;
            (place.song_time, place.lap, entry, place.features.volume[0])
        };
        assert_eq!(reported(&audible_segments, 199.0), (9.99, 0, 1, 0.25));
        assert_eq!(reported(&audible_segments, 1199.0).1, 1);
        assert_eq!(reported(&audible_segments, 1150.0), (9.5, 1, 1, 0.5));
        assert_eq!(reported(&audible_segments, 1200.0), (0.0, 2, 2, 0.5));
        for n in 3..1000_u32 {
            audible_segments.begin_lap(
                1,
                f64::from(n) * 12.0,
                0.0,
                Some((n.into(), Track::silence(5, 9).info)),
            );
        }
        assert_eq!(audible_segments.segments[0].passages.len(), PASSAGES_KEPT);
        audible_segments.begin_lap(1, 12_000.0, 11_990.0, Some((2000, Track::silence(7, 9).info)));
        assert_eq!(audible_segments.segments[0].passages.len(), 2);
        assert_eq!(audible_segments.place(at(1, 1_200_000.0), 0.0).unwrap().track.entry, 7);
    }
}
