//! The segment that is being filled, and the output that plays it.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Instant;

use super::passages::Goal;
use crate::audible_segments::SharedAudibleSegments;
use crate::clock::{Audible, Course};
use crate::limits;
use crate::output::OutputCallbackLink;
use crate::player::filling::Filling;
use crate::resample::{ResampleError, Resampler};
use crate::track::TrackInfo;

/// Depth of the ring, in seconds; [`RING_BUFFERS`] device buffers if they are longer than this.
const RING: f64 = 0.4;

const RING_BUFFERS: usize = 4;

/// A segment is played once this many seconds are ready: more than the look-ahead of the analysis.
const PREFILL: f64 = 0.15;

/// The segment being filled and its output. `filling` is `None` before the first output or after a failed start.
#[derive(Default)]
pub(super) struct CurrentSegment {
    pub(super) audible_segments: SharedAudibleSegments,
    link: Option<OutputCallbackLink>,
    pub(super) filling: Option<Filling>,
    last_id: u64,
    /// A number that grows with each seek and each skip.
    run: u64,
    pub(super) due: Option<Instant>,
    /// The number of callback calls at the time when the process was last suspended.
    stood_still: Option<u64>,
    /// The track time at which the next segment starts once an output is open, in seconds.
    start: f64,
}

impl CurrentSegment {
    pub(super) fn new(audible_segments: SharedAudibleSegments) -> Self {
        Self { audible_segments, ..Self::default() }
    }

    pub(super) fn set_output(&mut self, link: OutputCallbackLink) {
        self.link = Some(link);
        self.stood_still = None;
    }

    pub(super) fn output_rate(&self) -> Option<u32> {
        self.link.as_ref().map(|link| link.rate)
    }

    pub(super) fn clean_up(&mut self) {
        if let Some(link) = &mut self.link {
            link.clean_up();
        }
    }

    pub(super) fn record_standstill(&mut self) {
        self.stood_still = self.link.as_ref().map(|link| link.history.calls());
    }

    /// True if the process was suspended and the callback was not called since. In this case the song has not moved.
    pub(super) fn stands_still(&self) -> bool {
        let calls = self.link.as_ref().map(|link| link.history.calls());
        calls.is_some() && self.stood_still == calls
    }

    pub(super) fn is_finished(&self) -> bool {
        self.filling.as_ref().is_some_and(|filling| filling.exhausted)
    }

    pub(super) fn start(&self) -> f64 {
        self.filling.as_ref().map_or(self.start, |filling| filling.target)
    }

    pub(super) fn audible(&self) -> Option<Audible> {
        let (link, filling) = (self.link.as_ref()?, self.filling.as_ref()?);
        link.history.at(Instant::now()).filter(|audible| audible.segment == filling.id)
    }

    /// Returns the audible frame at `at` if the output continues; `None` before the segment's first frame was audible.
    pub(super) fn course_of_output(&self, at: Instant) -> Option<Course> {
        let (link, filling) = (self.link.as_ref()?, self.filling.as_ref()?);
        link.history.course(at).filter(|course| course.audible.segment == filling.id)
    }

    pub(super) fn aim(&mut self, goal: Goal) {
        self.start = goal.time.max(0.0);
        self.run += u64::from(!goal.same_run);
        self.due = goal.due;
    }

    pub(super) fn abandon(&mut self) {
        if let Some(missed_audio) = self.filling.take().filter(|filling| filling.waiting.is_some()) {
            self.audible_segments.lock().discard(missed_audio.id);
        }
    }

    /// Begins a segment at `target` seconds of a track. The source starts `skip` frames earlier, for the analysis.
    pub(super) fn begin(
        &mut self,
        passage: u64,
        info: Arc<TrackInfo>,
        target: f64,
        resampler: Resampler,
        skip: u64,
        from_start: bool,
    ) {
        let Some(link) = &self.link else { return };
        self.last_id += 1;
        self.start = target;
        self.audible_segments.lock().begin(self.last_id, self.run, link.rate, passage, target, info);
        let ring_frames = ((RING * f64::from(link.rate)) as usize).max(RING_BUFFERS * link.buffer_frames);
        let mut filling = Filling::new(self.last_id, target, ring_frames, resampler, skip, from_start);
        if let Some(due) = self.due {
            filling.waiting = filling.waiting.take().map(|segment| segment.due_at(due));
        }
        self.filling = Some(filling);
    }

    /// Fills the ring, and hands the segment over once the ring holds enough. Returns true if more frames are needed.
    pub(super) fn push(&mut self) -> bool {
        let Some((link, filling)) = self.link.as_mut().zip(self.filling.as_mut()) else { return false };
        filling.push_ready();
        if filling.is_pushed() && filling.exhausted && !filling.finished {
            filling.finished = true;
            filling.end.store(filling.pushed, Ordering::Release);
            self.audible_segments.lock().finish(filling.id, filling.pushed);
        }
        let prefill = ((PREFILL * f64::from(link.rate)) as u64).min(filling.ring.buffer().capacity() as u64);
        // Wait for the features of the first audible frames, unless the ring is full.
        let is_full = !filling.is_pushed();
        let is_ready =
            filling.pushed >= prefill && (is_full || self.audible_segments.lock().has_begun(filling.id));
        if (is_ready || filling.finished)
            && let Some(segment) = filling.waiting.take()
        {
            filling.waiting = link.offer(segment).err();
        }
        !filling.finished && filling.is_pushed()
    }

    /// Starts the segment at the end of a track that ended before the target. `rate` is the source's rate.
    pub(super) fn start_at_end(&mut self, passage: u64, rate: u32) {
        let Some(filling) = self.filling.as_mut().filter(|filling| filling.skip > 0) else { return };
        filling.target = (filling.target - filling.skip as f64 / f64::from(rate)).max(0.0);
        filling.skip = 0;
        self.audible_segments.lock().set_start(passage, filling.target);
    }

    /// Continues with the start of the same track, or with the track `next` as its passage. That track must have the
    /// source rate that was set last.
    pub(super) fn begin_lap(&mut self, next: Option<(u64, Arc<TrackInfo>)>) {
        let played = self.played();
        let Some(filling) = &mut self.filling else { return };
        (filling.since_jump, filling.from_start) = (0, true);
        self.audible_segments.lock().begin_lap(filling.id, filling.next_time(), played, next);
    }

    /// Sets the source's rate for the following frames. Fails if the rate cannot be converted.
    pub(super) fn set_source_rate(&mut self, rate: u32) -> Result<(), ResampleError> {
        let Some((link, filling)) = self.link.as_ref().zip(self.filling.as_mut()) else { return Ok(()) };
        if rate == filling.conversion.resampler.from_hz() {
            return Ok(());
        }
        filling.change_resampler(Resampler::new(rate, link.rate)?, link.rate)
    }

    /// The segment time, in seconds, that was certainly shown, even with the largest delay of the image.
    fn played(&self) -> f64 {
        let rate = self.output_rate().unwrap_or(1);
        let audible = self.audible().map_or(0.0, |audible| audible.frame / f64::from(rate));
        audible - limits::LATENCY_MS_MAX / 1000.0
    }
}

#[cfg(test)]
#[path = "segment_tests.rs"]
mod tests;
