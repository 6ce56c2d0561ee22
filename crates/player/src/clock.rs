//! The playback clock: maps moments to audible frames.
//!
//! The callback writes one [`Span`] per stretch of its buffer. The span states which frames of which segment the
//! callback delivered, and when the first of these frames becomes audible (callback time + latency, by the device's
//! timestamps). The last [`SPANS_KEPT`] spans stay readable. Writing is wait-free: each slot is a sequence lock, whose
//! version is odd while the slot is being written.
//!
//! Device timestamps jitter by milliseconds. The writer follows them with a first-order loop (a delay-locked loop
//! without its second integrator; F. Adriaensen, "Using a DLL to filter time", 2005) and jumps only if the deviation
//! is large.
//!
//! **The song continues through device faults.** A [`Clock`] computes the song's position:
//! - While spans cover the moment, they determine the position.
//! - If a device falls silent while frames are moving, the song continues at its normal pace until another output
//!   sounds. The new output knows when its first frame is due ([`super::output::Segment::due_at`]) and drops late
//!   frames.
//! - The reported position never steps. If the reported position differs from the audible position, the clock runs at
//!   [`SLOWEST`] to [`FASTEST`] times its normal pace until both agree.
//! - Only a seek, a skip or another track moves the position at once. A pause or an underrun stops the position.
//! - If the clock was not read and no device called for [`AWAY_MAX`], the process was suspended and the song stopped.
//!
//! All times are measured with the monotonic clock.

use std::sync::atomic::{AtomicU64, Ordering, fence};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

/// Number of spans that stay readable. They last at least 5 s at 512 frames of 48 kHz per callback.
const SPANS_KEPT: usize = 512;

/// Fraction of the deviation between expected and reported time that each callback corrects.
const FOLLOW: f64 = 0.1;

/// The smallest deviation, in nanoseconds, at which the clock jumps to the reported time.
const JUMP_NS: f64 = 30e6;

const NS_PER_SECOND: f64 = 1e9;

/// The slowest pace of a clock that is ahead of the audible sound, and the fastest pace of a clock that is behind it.
const SLOWEST: f64 = 0.8;

const FASTEST: f64 = 1.2;

/// If two reads are further apart than this, in seconds, the position advances only by the frames delivered in between.
const AWAY_MAX: f64 = 0.5;

/// If the clock is ahead of the sound by more than this, in seconds, it waits, so that stalls do not add up.
const AHEAD_MAX: f64 = 1.5;

/// If the positions of two segments differ by more than this, in seconds, the clock jumps to the newer segment.
const APART_MAX: f64 = 3.0;

const NEVER: u64 = u64::MAX;

/// A stretch of sound that was delivered to the device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Span {
    /// The time at which the span's first frame is audible, in nanoseconds since the history's epoch.
    pub start_ns: u64,
    /// The segment of the span's frames.
    pub segment: u64,
    /// The index of the span's first frame within the segment.
    pub frame: u64,
    /// The length of the span in device frames.
    pub frames: u32,
    /// False while the segment is paused, starved or ended. Then `frame` is audible throughout the span.
    pub moving: bool,
}

/// An audible position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Audible {
    /// The segment's number.
    pub segment: u64,
    /// Device frames since the segment's start.
    pub frame: f64,
}

/// The song's position at a moment, assuming that the song continues in real time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Course {
    /// The position.
    pub audible: Audible,
    /// True unless the song is paused, starved or at its end.
    pub moving: bool,
    /// The number of frames up to this position that no device received.
    beyond: f64,
}

#[derive(Default)]
struct Slot {
    version: AtomicU64,
    start_ns: AtomicU64,
    segment: AtomicU64,
    frame: AtomicU64,
    /// The number of frames. Bit 32 is set if `Span::moving` is true.
    shape: AtomicU64,
}

const MOVING: u64 = 1 << 32;

/// The spans that the callback wrote recently, readable from any thread without a lock.
pub struct SpanHistory {
    epoch: Instant,
    rate: u32,
    device: OnceLock<Box<str>>,
    slots: Box<[Slot]>,
    written: AtomicU64,
    calls: AtomicU64,
    /// The segment and frame of the first span; the frame is written last.
    first_segment: AtomicU64,
    first_frame: AtomicU64,
    moved: AtomicU64,
}

impl SpanHistory {
    /// Creates an empty history for a device with `rate` frames per second, and the history's only writer.
    pub fn new(rate: u32) -> (SpanWriter, Arc<Self>) {
        let slots = (0..SPANS_KEPT).map(|_| Slot::default()).collect();
        let history = Arc::new(Self {
            epoch: Instant::now(),
            rate: rate.max(1),
            device: OnceLock::new(),
            slots,
            written: AtomicU64::new(0),
            calls: AtomicU64::new(0),
            first_segment: AtomicU64::new(0),
            first_frame: AtomicU64::new(NEVER),
            moved: AtomicU64::new(0),
        });
        (SpanWriter { history: history.clone(), next_start_ns: None }, history)
    }

    /// The device's frames per second.
    pub fn rate(&self) -> u32 {
        self.rate
    }

    /// The number of callback calls, which shows whether the device is alive.
    pub fn calls(&self) -> u64 {
        self.calls.load(Ordering::Relaxed)
    }

    /// Sets the id of the device that plays these frames. Only the first call has an effect.
    pub fn set_device(&self, id: &str) {
        let _ = self.device.set(id.into());
    }

    /// The id of the device that plays these frames; `None` if the silent clock takes them.
    pub fn device(&self) -> Option<&str> {
        self.device.get().map(AsRef::as_ref)
    }

    /// The first delivered frame.
    pub fn first(&self) -> Option<Audible> {
        let frame = self.first_frame.load(Ordering::Acquire);
        let segment = self.first_segment.load(Ordering::Relaxed);
        (frame != NEVER).then_some(Audible { segment, frame: frame as f64 })
    }

    /// The end of the delivered frames.
    pub fn end(&self) -> Option<Audible> {
        // Retry, because the callback may be writing at this moment.
        let newest = || self.read(self.written.load(Ordering::Acquire).checked_sub(1)?);
        let span = (0..4).find_map(|_| newest())?;
        let frame = span.frame + if span.moving { u64::from(span.frames) } else { 0 };
        Some(Audible { segment: span.segment, frame: frame as f64 })
    }

    /// The total duration of moving sound, in seconds.
    pub fn moved(&self) -> f64 {
        self.moved.load(Ordering::Relaxed) as f64 / f64::from(self.rate)
    }

    /// Returns the audible frame at `moment`, at most the last delivered frame; `None` before the first callback.
    pub fn at(&self, moment: Instant) -> Option<Audible> {
        let found = self.find(moment)?;
        let handed_out = found.passed.clamp(0.0, f64::from(found.span.frames));
        let moved = if found.span.moving { handed_out } else { 0.0 };
        Some(Audible { segment: found.span.segment, frame: found.span.frame as f64 + moved })
    }

    /// Returns the song's position at `moment`, assuming that the song continues in real time even if the device
    /// stopped. Returns `None` before the first frame is audible.
    pub fn course(&self, moment: Instant) -> Option<Course> {
        let Found { span, passed, first, newest } = self.find(moment)?;
        if passed < 0.0 && first {
            return None;
        }
        let handed_out = f64::from(span.frames);
        let limit = if newest { f64::INFINITY } else { handed_out };
        let moved = if span.moving { passed.clamp(0.0, limit) } else { 0.0 };
        Some(Course {
            audible: Audible { segment: span.segment, frame: span.frame as f64 + moved },
            moving: span.moving,
            beyond: (moved - handed_out).max(0.0),
        })
    }

    /// Converts a moment to nanoseconds since the epoch.
    pub(crate) fn nanoseconds(&self, moment: Instant) -> u64 {
        moment.saturating_duration_since(self.epoch).as_nanos() as u64
    }

    /// The duration of `frames`, in nanoseconds.
    pub(crate) fn duration_ns(&self, frames: usize) -> f64 {
        frames as f64 * NS_PER_SECOND / f64::from(self.rate)
    }

    fn find(&self, moment: Instant) -> Option<Found> {
        let moment_ns = self.nanoseconds(moment);
        // An attempt fails only if the writer overwrote the whole history during the attempt.
        (0..4).find_map(|_| self.find_span(moment_ns))
    }

    /// Finds the span for a moment, or the oldest kept span if the moment is earlier than all kept spans.
    fn find_span(&self, moment_ns: u64) -> Option<Found> {
        let written = self.written.load(Ordering::Acquire);
        let mut oldest_seen = None;
        for index in (written.saturating_sub(SPANS_KEPT as u64)..written).rev() {
            let Some(span) = self.read(index) else { break };
            let passed_ns = moment_ns as f64 - span.start_ns as f64;
            let passed = passed_ns / NS_PER_SECOND * f64::from(self.rate);
            let found = Found { span, passed, first: index == 0, newest: index + 1 == written };
            if passed_ns >= 0.0 {
                return Some(found);
            }
            oldest_seen = Some(found);
        }
        oldest_seen
    }

    fn read(&self, index: u64) -> Option<Span> {
        let slot = &self.slots[(index % SPANS_KEPT as u64) as usize];
        let wanted = 2 * index + 2;
        if slot.version.load(Ordering::Acquire) != wanted {
            return None;
        }
        let shape = slot.shape.load(Ordering::Relaxed);
        let span = Span {
            start_ns: slot.start_ns.load(Ordering::Relaxed),
            segment: slot.segment.load(Ordering::Relaxed),
            frame: slot.frame.load(Ordering::Relaxed),
            frames: shape as u32,
            moving: shape & MOVING != 0,
        };
        fence(Ordering::Acquire);
        (slot.version.load(Ordering::Relaxed) == wanted).then_some(span)
    }
}

struct Found {
    span: Span,
    /// Number of frames from the span's start to the moment; negative if the span starts later.
    passed: f64,
    first: bool,
    newest: bool,
}

/// The writing end of a [`SpanHistory`]. It is wait-free and never allocates.
pub struct SpanWriter {
    pub(crate) history: Arc<SpanHistory>,
    /// The time at which the next buffer is audible if the device keeps its pace.
    next_start_ns: Option<f64>,
}

impl SpanWriter {
    /// Returns the time at which the buffer's first frame is audible, in nanoseconds since the epoch. Smooths the time
    /// that the device reports (`called_at` + `latency`). `frames` is the buffer's length.
    pub fn place(&mut self, called_at: Instant, latency: Duration, frames: usize) -> u64 {
        self.history.calls.fetch_add(1, Ordering::Relaxed);
        let reported = self.history.nanoseconds(called_at) as f64 + latency.as_nanos() as f64;
        let start = match self.next_start_ns {
            Some(expected) if (reported - expected).abs() < JUMP_NS => {
                expected + (reported - expected) * FOLLOW
            }
            _ => reported,
        };
        self.next_start_ns = Some(start + self.history.duration_ns(frames));
        start as u64
    }

    /// Makes a span readable.
    pub fn push(&mut self, span: Span) {
        let history = &*self.history;
        let index = history.written.load(Ordering::Relaxed);
        if index == 0 {
            history.first_segment.store(span.segment, Ordering::Relaxed);
            history.first_frame.store(span.frame, Ordering::Release);
        }
        if span.moving {
            history.moved.fetch_add(u64::from(span.frames), Ordering::Relaxed);
        }
        let slot = &history.slots[(index % SPANS_KEPT as u64) as usize];
        slot.version.store(2 * index + 1, Ordering::Relaxed);
        fence(Ordering::Release);
        slot.start_ns.store(span.start_ns, Ordering::Relaxed);
        slot.segment.store(span.segment, Ordering::Relaxed);
        slot.frame.store(span.frame, Ordering::Relaxed);
        slot.shape.store(u64::from(span.frames) | if span.moving { MOVING } else { 0 }, Ordering::Relaxed);
        slot.version.store(2 * index + 2, Ordering::Release);
        history.written.store(index + 1, Ordering::Release);
    }
}

/// A reader whose position continues through device changes, by the rules in this module's documentation.
#[derive(Default)]
pub struct Clock {
    history: Option<Arc<SpanHistory>>,
    last: Option<(Audible, Instant)>,
    delay: f64,
}

impl Clock {
    /// Returns the song's position at `moment`. `delay` is the time in seconds (0 or more) by which the sound is heard
    /// later than the device reports. `newest` is the history of the open output; until its first frame is audible, the
    /// previous history is used, or the last position is returned. `carry` maps an audible frame of an earlier segment
    /// to a frame of a later segment (negative before its start), or returns `None` if a seek or another track
    /// separates them.
    pub fn at(
        &mut self,
        newest: Option<&Arc<SpanHistory>>,
        moment: Instant,
        delay: f64,
        carry: impl FnOnce(Audible, u64) -> Option<f64>,
    ) -> Option<Audible> {
        if delay != self.delay {
            // A changed delay may move the position back.
            self.last = None;
            self.delay = delay;
        }
        let earlier = moment.checked_sub(Duration::try_from_secs_f64(delay).unwrap_or_default());
        let earlier = earlier.unwrap_or(moment);
        let course = match newest.and_then(|history| Some((history, history.course(earlier)?))) {
            Some((history, course)) => {
                self.history = Some(history.clone());
                Some(course)
            }
            None => self.history.as_ref().and_then(|history| history.course(earlier)),
        };
        let Some(course) = course else {
            let first = newest.and_then(|history| history.at(earlier));
            return self.last.map(|(last, _)| last).or(first);
        };
        let rate = self.history.as_ref().map_or(1.0, |history| f64::from(history.rate));
        let reported = match self.last {
            Some((last, at)) => follow(course, last, moment.saturating_duration_since(at), rate, carry),
            None => course.audible,
        };
        self.last = Some((reported, moment));
        Some(reported)
    }

    /// The history that the last reported position comes from.
    pub fn history(&self) -> Option<&Arc<SpanHistory>> {
        self.history.as_ref()
    }
}

fn follow(
    course: Course,
    last: Audible,
    passed: Duration,
    rate: f64,
    carry: impl FnOnce(Audible, u64) -> Option<f64>,
) -> Audible {
    let Course { audible: Audible { segment, mut frame }, moving, beyond } = course;
    let from = match last.segment.cmp(&segment) {
        // Frames from before a seek are never reported again.
        std::cmp::Ordering::Greater => return last,
        std::cmp::Ordering::Equal => Some(last.frame),
        std::cmp::Ordering::Less => {
            carry(last, segment).filter(|from| (from - frame).abs() <= APART_MAX * rate)
        }
    };
    let passed = passed.as_secs_f64();
    let stood_still = passed > AWAY_MAX;
    if stood_still {
        frame -= beyond;
    }
    if let Some(from) = from {
        let is_near = from - frame < AHEAD_MAX * rate;
        let least = if moving && is_near && !stood_still { SLOWEST * passed } else { 0.0 };
        frame = frame.max(from + least * rate).min(from + FASTEST * passed * rate);
    }
    Audible { segment, frame }
}

#[cfg(test)]
#[path = "clock_tests.rs"]
mod tests;
