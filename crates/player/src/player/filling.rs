//! The segment that is being filled, on the decoding thread.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

use rtrb::Producer;

use crate::output::Segment;
use crate::resample::{ResampleError, Resampler};
use mariana_music::StereoFrame;

pub(super) struct Filling {
    pub(super) id: u64,
    /// Track time of its first frame, in seconds.
    pub(super) target: f64,
    pub(super) ring: Producer<StereoFrame>,
    pub(super) end: Arc<AtomicU64>,
    /// The callback's half, until it is handed over.
    pub(super) waiting: Option<Segment>,
    conversion: Conversion,
    /// Frames still to come before the target: for the analysis alone.
    pub(super) skip: u64,
    /// Frames of the device put into the ring.
    pub(super) pushed: u64,
    /// Frames decoded but not processed yet.
    pub(super) decoded: VecDeque<StereoFrame>,
    /// Frames resampled but not in the ring yet.
    ready: VecDeque<StereoFrame>,
    /// Source frames since the last jump within the source.
    pub(super) since_jump: u64,
    /// Whether that jump went to the track's start.
    pub(super) from_start: bool,
    /// Whether nothing more comes for this segment.
    pub(super) exhausted: bool,
    /// Whether all of it is in the ring.
    pub(super) finished: bool,
}

/// The conversion from the source's rate, until a source of another rate follows.
struct Conversion {
    resampler: Resampler,
    /// Time of the segment at which it began, in seconds.
    base: f64,
    /// Source frames since then, the skipped ones left out.
    fed: u64,
}

impl Filling {
    /// Segment `id`, from `target` seconds of a track on, with a ring of `ring_frames` frames of the device. The
    /// source stands `skip` frames before the target, and at the track's start if `from_start`.
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

    /// Whether all that was resampled is in the ring.
    pub(super) fn is_pushed(&self) -> bool {
        self.ready.is_empty()
    }

    /// Moves as much into the ring as there is room for.
    pub(super) fn push_ready(&mut self) {
        let (front, _) = self.ready.as_slices();
        let (pushed, _) = self.ring.push_partial_slice(front);
        let count = pushed.len();
        self.pushed += count as u64;
        self.ready.drain(..count);
    }

    /// Takes the next frames of the source: those from the target on are resampled.
    pub(super) fn feed(
        &mut self,
        frames: &[StereoFrame],
        scratch: &mut Vec<StereoFrame>,
    ) -> Result<(), ResampleError> {
        let skipped = self.skip.min(frames.len() as u64);
        self.skip -= skipped;
        let audible = frames.get(skipped as usize..).unwrap_or_default();
        self.conversion.fed += audible.len() as u64;
        scratch.clear();
        let resampled = self.conversion.resampler.process(audible, scratch);
        self.ready.extend(scratch.drain(..));
        resampled
    }

    /// Takes out what the resampler still holds.
    pub(super) fn flush(&mut self, scratch: &mut Vec<StereoFrame>) -> Result<(), ResampleError> {
        scratch.clear();
        let resampled = self.conversion.resampler.finish(scratch);
        self.ready.extend(scratch.drain(..));
        resampled
    }

    /// The rate of the source, in hertz.
    pub(super) fn source_hz(&self) -> u32 {
        self.conversion.resampler.from_hz()
    }

    /// The segment time of the source's next frame, in seconds.
    pub(super) fn next_time(&self) -> f64 {
        self.conversion.base + self.conversion.fed as f64 / f64::from(self.source_hz())
    }

    /// Goes on with a source of another rate, on a device of `rate` frames per second.
    pub(super) fn change_resampler(
        &mut self,
        resampler: Resampler,
        rate: u32,
        scratch: &mut Vec<StereoFrame>,
    ) -> Result<(), ResampleError> {
        let flushed = self.flush(scratch);
        let base = (self.pushed + self.ready.len() as u64) as f64 / f64::from(rate);
        self.conversion = Conversion { resampler, base, fed: 0 };
        flushed
    }
}
