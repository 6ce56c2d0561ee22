//! The clock of the sound: which frame is audible at a moment.
//!
//! The callback writes one [`Span`] per stretch of its buffer: which frames of which segment it handed out and when
//! the first of them becomes audible (callback time + latency, by the device's timestamps). The last
//! [`SPANS_KEPT`] spans stay readable. Writing is wait-free; a reader that meets a slot being overwritten looks
//! again. A slot is a sequence lock: its version is odd while it is written and tells which span it holds.
//!
//! Timestamps of devices jitter by milliseconds. As the device plays at a steady rate, the writer follows them with a
//! first-order loop (a delay-locked loop without its second integrator; F. Adriaensen, "Using a DLL to filter time",
//! 2005) and jumps only where they are far off.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering, fence};
use std::time::{Duration, Instant};

/// How many spans stay readable: at least 5 s at 512 frames of 48 kHz per callback.
const SPANS_KEPT: usize = 512;

/// Part of the deviation between expected and reported time that each callback corrects.
const FOLLOW: f64 = 0.1;

/// A larger deviation than this is taken at once, in nanoseconds.
const JUMP_NS: f64 = 30e6;

const NS_PER_SECOND: f64 = 1e9;

/// A stretch of sound that was handed to the device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Span {
    /// When its first frame is audible, in nanoseconds since the history's epoch.
    pub start_ns: u64,
    /// The segment it belongs to.
    pub segment: u64,
    /// Index of its first frame within the segment.
    pub frame: u64,
    /// Its length in frames of the device.
    pub frames: u32,
    /// False while the segment stands still (paused, starved, ended): then every moment of it is at `frame`.
    pub moving: bool,
}

/// A place in the sound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Audible {
    /// The segment.
    pub segment: u64,
    /// Frames (of the device's rate) since the segment's start.
    pub frame: f64,
}

#[derive(Default)]
struct Slot {
    version: AtomicU64,
    start_ns: AtomicU64,
    segment: AtomicU64,
    frame: AtomicU64,
    /// Frames, and in bit 32 whether they move.
    shape: AtomicU64,
}

const MOVING: u64 = 1 << 32;

/// What the callback handed out lately, readable from any thread without a lock.
pub struct SpanHistory {
    epoch: Instant,
    rate: u32,
    slots: Box<[Slot]>,
    written: AtomicU64,
    calls: AtomicU64,
}

impl SpanHistory {
    /// An empty history of a device with `rate` frames per second, and its only writer.
    pub fn new(rate: u32) -> (SpanWriter, Arc<Self>) {
        let slots = (0..SPANS_KEPT).map(|_| Slot::default()).collect();
        let history = Arc::new(Self {
            epoch: Instant::now(),
            rate: rate.max(1),
            slots,
            written: AtomicU64::new(0),
            calls: AtomicU64::new(0),
        });
        (SpanWriter { history: history.clone(), next_start_ns: None }, history)
    }

    /// Frames per second of the device.
    pub fn rate(&self) -> u32 {
        self.rate
    }

    /// How often the callback was called: its sign of life.
    pub fn calls(&self) -> u64 {
        self.calls.load(Ordering::Relaxed)
    }

    /// What is audible at `moment`: never more than was handed out. None before the first callback.
    pub fn at(&self, moment: Instant) -> Option<Audible> {
        let moment_ns = self.nanoseconds(moment);
        // Each look fails only if the writer went round the whole history meanwhile.
        (0..4).find_map(|_| self.look(moment_ns))
    }

    fn nanoseconds(&self, moment: Instant) -> u64 {
        moment.saturating_duration_since(self.epoch).as_nanos() as u64
    }

    fn look(&self, moment_ns: u64) -> Option<Audible> {
        let newest = self.written.load(Ordering::Acquire);
        let mut oldest_seen = None;
        for index in (newest.saturating_sub(SPANS_KEPT as u64)..newest).rev() {
            let Some(span) = self.read(index) else { break };
            if span.start_ns <= moment_ns {
                let passed = (moment_ns - span.start_ns) as f64 / NS_PER_SECOND * f64::from(self.rate);
                let moved = if span.moving { passed.min(f64::from(span.frames)) } else { 0.0 };
                return Some(Audible { segment: span.segment, frame: span.frame as f64 + moved });
            }
            oldest_seen = Some(Audible { segment: span.segment, frame: span.frame as f64 });
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

/// The writing end of a [`SpanHistory`]. Wait-free; never allocates.
pub struct SpanWriter {
    history: Arc<SpanHistory>,
    /// When the next buffer should be audible if the device keeps its pace.
    next_start_ns: Option<f64>,
}

impl SpanWriter {
    /// When the first of a buffer's `frames` is audible, in nanoseconds since the epoch: the device's word
    /// (`called_at` + `latency`), smoothed.
    pub fn place(&mut self, called_at: Instant, latency: Duration, frames: usize) -> u64 {
        self.history.calls.fetch_add(1, Ordering::Relaxed);
        let reported = self.history.nanoseconds(called_at) as f64 + latency.as_nanos() as f64;
        let start = match self.next_start_ns {
            Some(expected) if (reported - expected).abs() < JUMP_NS => {
                expected + (reported - expected) * FOLLOW
            }
            _ => reported,
        };
        self.next_start_ns = Some(start + self.duration_ns(frames));
        start as u64
    }

    /// How long `frames` last, in nanoseconds.
    pub fn duration_ns(&self, frames: usize) -> f64 {
        frames as f64 * NS_PER_SECOND / f64::from(self.history.rate)
    }

    /// Makes a span readable.
    pub fn push(&mut self, span: Span) {
        let history = &*self.history;
        let index = history.written.load(Ordering::Relaxed);
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

/// A reader that never steps back within a segment nor to an earlier segment, whatever the timestamps do.
#[derive(Default)]
pub struct Clock {
    last: Option<Audible>,
    delay: f64,
}

impl Clock {
    /// What is audible at `moment` if the sound is heard `delay` seconds (0 or more) later than the device says.
    /// While the history is empty: what was last audible.
    pub fn at(&mut self, history: Option<&SpanHistory>, moment: Instant, delay: f64) -> Option<Audible> {
        if delay != self.delay {
            // Another delay is another clock: it may start earlier.
            self.last = None;
            self.delay = delay;
        }
        let earlier = moment.checked_sub(Duration::try_from_secs_f64(delay).unwrap_or_default());
        let fresh = history.and_then(|history| history.at(earlier.unwrap_or(moment)));
        self.last = match (self.last, fresh) {
            (Some(last), Some(fresh)) => {
                let steps_back = (fresh.segment, fresh.frame) < (last.segment, last.frame);
                Some(if steps_back { last } else { fresh })
            }
            (last, fresh) => fresh.or(last),
        };
        self.last
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn span(start_ms: u64, segment: u64, frame: u64, frames: u32, moving: bool) -> Span {
        Span { start_ns: start_ms * 1_000_000, segment, frame, frames, moving }
    }

    fn at_ms(history: &SpanHistory, ms: u64) -> Option<Audible> {
        history.at(history.epoch + Duration::from_millis(ms))
    }

    #[test]
    fn the_frame_moves_with_time_and_stops_at_what_was_handed_out() {
        let (mut writer, history) = SpanHistory::new(1000);
        assert_eq!(at_ms(&history, 5), None);
        writer.push(span(10, 1, 0, 20, true));
        writer.push(span(30, 1, 20, 10, false));
        writer.push(span(40, 2, 0, 10, true));
        for (ms, segment, frame) in [
            (0, 1, 0.0),
            (10, 1, 0.0),
            (15, 1, 5.0),
            (30, 1, 20.0),
            (39, 1, 20.0),
            (44, 2, 4.0),
            (900, 2, 10.0),
        ] {
            assert_eq!(at_ms(&history, ms), Some(Audible { segment, frame }), "at {ms} ms");
        }
    }

    #[test]
    fn old_spans_are_forgotten_and_the_oldest_kept_answers_for_them() {
        let (mut writer, history) = SpanHistory::new(1000);
        let count = SPANS_KEPT as u64 + 100;
        (0..count).for_each(|n| writer.push(span(10 * n, 1, 10 * n, 10, true)));
        assert_eq!(
            at_ms(&history, 10 * count - 5).map(|audible| audible.frame),
            Some(10.0 * count as f64 - 5.0)
        );
        assert_eq!(at_ms(&history, 0).map(|audible| audible.frame), Some(1000.0));
    }

    #[test]
    fn jitter_is_smoothed_and_a_real_change_of_latency_is_taken_at_once() {
        let (mut writer, history) = SpanHistory::new(48_000);
        let period = Duration::from_millis(10);
        let latency = Duration::from_millis(20);
        let mut previous: Option<f64> = None;
        for n in 0..200_u32 {
            let jitter = Duration::from_millis(u64::from(n * 7919 % 5));
            let start = writer.place(history.epoch + period * n + jitter, latency, 480);
            if let Some(previous) = previous.filter(|_| n > 50) {
                let step = start as f64 - previous;
                assert!((step - 10e6).abs() < 0.5e6, "a step of {step} ns at callback {n}");
            }
            previous = Some(start as f64);
        }
        let start = writer.place(history.epoch + period * 200, latency + Duration::from_millis(100), 480);
        assert_eq!(start, (period * 200 + latency).as_nanos() as u64 + 100_000_000);
    }

    #[test]
    fn readers_never_see_a_span_half_written() {
        let (mut writer, history) = SpanHistory::new(1_000_000_000);
        let done = AtomicU64::new(0);
        std::thread::scope(|scope| {
            let reader = scope.spawn(|| {
                let mut seen = 0_u64;
                while done.load(Ordering::Acquire) == 0 {
                    // Every span holds n in all its fields.
                    if let Some(audible) = history.look(u64::MAX) {
                        assert_eq!(audible.frame, audible.segment as f64);
                        seen += 1;
                    }
                }
                seen
            });
            for n in 1..=400_000_u64 {
                writer.push(Span { start_ns: n, segment: n, frame: n, frames: 0, moving: true });
            }
            done.store(1, Ordering::Release);
            assert!(reader.join().expect("the reader saw a torn span") > 0);
        });
    }

    proptest! {
        #[test]
        fn the_clock_never_steps_back(
            callbacks in prop::collection::vec((0_u64..25, 0_u64..60, 1_usize..2000, 0_u8..10), 1..60),
            looks in prop::collection::vec(0_u64..15, 1..8),
        ) {
            let (mut writer, history) = SpanHistory::new(48_000);
            let mut clock = Clock::default();
            let (mut now_ms, mut segment, mut frame) = (0, 1, 0);
            let mut last: Option<Audible> = None;
            for (gap, latency, frames, event) in callbacks {
                now_ms += gap;
                if event == 0 {
                    segment += 1;
                    frame = 0;
                }
                let moving = event != 1;
                let start_ns = writer.place(history.epoch + Duration::from_millis(now_ms), Duration::from_millis(latency), frames);
                writer.push(Span { start_ns, segment, frame, frames: frames as u32, moving });
                frame += if moving { frames as u64 } else { 0 };
                for look in &looks {
                    let moment = history.epoch + Duration::from_millis(now_ms + look);
                    let audible = clock.at(Some(&history), moment, 0.0).expect("a span was written");
                    prop_assert!(last.is_none_or(|last| (last.segment, last.frame) <= (audible.segment, audible.frame)));
                    prop_assert!(audible.segment < segment || audible.frame <= frame as f64, "more than was handed out");
                    last = Some(audible);
                }
            }
        }
    }
}
