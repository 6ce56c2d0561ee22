//! The segment that the decoding thread is filling.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

use rtrb::Producer;

use crate::output::Segment;
use crate::resample::{ResampleError, Resampler};
use mariana_music::StereoFrame;

pub(super) struct Filling {
    pub(super) id: u64,
    /// The track time of the segment's first frame, in seconds.
    pub(super) target: f64,
    pub(super) ring: Producer<StereoFrame>,
    pub(super) end: Arc<AtomicU64>,
    /// The callback's half of the segment, until this half is handed over.
    pub(super) waiting: Option<Segment>,
    pub(super) conversion: Conversion,
    /// The number of source frames before the target. Only the analysis uses these frames.
    pub(super) skip: u64,
    /// The number of device frames that are or were in the ring.
    pub(super) pushed: u64,
    pub(super) decoded: VecDeque<StereoFrame>,
    ready: VecDeque<StereoFrame>,
    /// The number of source frames since the last jump within the source.
    pub(super) since_jump: u64,
    /// True if the last jump went to the track's start.
    pub(super) from_start: bool,
    pub(super) exhausted: bool,
    pub(super) finished: bool,
}

pub(super) struct Conversion {
    pub(super) resampler: Resampler,
    /// The segment time at which the conversion began, in seconds.
    base: f64,
    /// The number of source frames since `base`, without the skipped frames.
    fed: u64,
}

impl Filling {
    /// Starts a segment at `target` seconds of a track. The source starts `skip` frames earlier, for the analysis.
    pub(super) fn new(
        id: u64,
        target: f64,
        ring_frames: usize,
        resampler: Resampler,
        skip: u64,
        from_start: bool,
    ) -> Self {
        let (ring, end, waiting) = Segment::new(id, ring_frames);
        Self {
            id,
            target,
            ring,
            end,
            waiting: Some(waiting),
            conversion: Conversion { resampler, base: 0.0, fed: 0 },
            skip,
            pushed: 0,
            decoded: VecDeque::new(),
            ready: VecDeque::new(),
            since_jump: 0,
            from_start,
            exhausted: false,
            finished: false,
        }
    }

    pub(super) fn is_pushed(&self) -> bool {
        self.ready.is_empty()
    }

    pub(super) fn push_ready(&mut self) {
        let (front, _) = self.ready.as_slices();
        let (pushed, _) = self.ring.push_partial_slice(front);
        let count = pushed.len();
        self.pushed += count as u64;
        self.ready.drain(..count);
    }

    pub(super) fn feed(&mut self, frames: &[StereoFrame]) -> Result<(), ResampleError> {
        let skipped = self.skip.min(frames.len() as u64);
        self.skip -= skipped;
        let audible = frames.get(skipped as usize..).unwrap_or_default();
        self.conversion.fed += audible.len() as u64;
        let mut converted = Vec::new();
        let resampled = self.conversion.resampler.process(audible, &mut converted);
        self.ready.extend(converted);
        resampled
    }

    pub(super) fn flush(&mut self) -> Result<(), ResampleError> {
        let mut converted = Vec::new();
        let resampled = self.conversion.resampler.finish(&mut converted);
        self.ready.extend(converted);
        resampled
    }

    /// The segment time of the source's next frame, in seconds.
    pub(super) fn next_time(&self) -> f64 {
        self.conversion.base + self.conversion.fed as f64 / f64::from(self.conversion.resampler.from_hz())
    }

    pub(super) fn change_resampler(&mut self, resampler: Resampler, rate: u32) -> Result<(), ResampleError> {
        let flushed = self.flush();
        let base = (self.pushed + self.ready.len() as u64) as f64 / f64::from(rate);
        self.conversion = Conversion { resampler, base, fed: 0 };
        flushed
    }
}
