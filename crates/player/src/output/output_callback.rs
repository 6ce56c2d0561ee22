//! The audio callback of an output copies frames from a ring into the device's buffer. The callback never locks,
//! allocates, frees, logs or panics. Every change of the audible sound is ramped to avoid clicks: volume and mute over
//! 10 ms; pause, seeks and underruns over 5 ms.
//!
//! A seek hands over a new [`Segment`] through a small ring. The callback fades out the old segment, takes the new
//! segment, and returns the old segment through another ring, so that another thread frees it. A segment that continues
//! the song after a device change has a due time, and the segment's late frames are dropped.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use cpal::{FromSample, Sample};
use rtrb::{Consumer, Producer, RingBuffer};

use crate::clock::{Span, SpanHistory, SpanWriter};
use mariana_music::StereoFrame;

const CHUNK: usize = 256;

/// Duration of a volume ramp over the whole range, in seconds.
const VOLUME_RAMP: f32 = 0.010;

/// Duration of a fade in or out, in seconds.
const FADE: f32 = 0.005;

/// After an underrun the sound resumes when the ring holds this many seconds (or a quarter of its capacity, if less).
const REFILL: f64 = 0.020;

/// Late frames are dropped, unless they are later than this, in seconds: then the process was suspended.
const LATE_MAX: f64 = 3.0;

const LATENCY_MAX: Duration = Duration::from_secs(5);

/// Maximum sample value. It is just below 1 because integer formats end just below 1.
const SAMPLE_MAX: f32 = 1.0 - f32::EPSILON / 2.0;

/// The settings that the window writes for the callbacks of all outputs, and the counts that the callbacks report.
pub struct Controls {
    volume: AtomicU32,
    muted: AtomicBool,
    paused: AtomicBool,
    /// Number of gaps in the sound because the decoding thread or the device's thread was too late.
    pub underruns: AtomicU64,
}

impl Controls {
    /// Creates the settings; `volume` is clamped to 0 to 1.
    pub fn new(volume: f32, paused: bool) -> Self {
        let controls = Self {
            volume: AtomicU32::new(0),
            muted: AtomicBool::new(false),
            paused: AtomicBool::new(paused),
            underruns: AtomicU64::new(0),
        };
        controls.set_volume(volume);
        controls
    }

    /// The volume, 0 to 1.
    pub fn volume(&self) -> f32 {
        f32::from_bits(self.volume.load(Ordering::Relaxed))
    }

    /// Sets the volume, clamped to 0 to 1; NaN becomes 0.
    pub fn set_volume(&self, volume: f32) {
        let volume = if volume.is_nan() { 0.0 } else { volume.clamp(0.0, 1.0) };
        self.volume.store(volume.to_bits(), Ordering::Relaxed);
    }

    /// True if the sound is muted. The song continues silently.
    pub fn muted(&self) -> bool {
        self.muted.load(Ordering::Relaxed)
    }

    /// Mutes or unmutes.
    pub fn set_muted(&self, muted: bool) {
        self.muted.store(muted, Ordering::Relaxed);
    }

    /// True if playback is paused.
    pub fn paused(&self) -> bool {
        self.paused.load(Ordering::Relaxed)
    }

    /// Pauses or resumes.
    pub fn set_paused(&self, paused: bool) {
        self.paused.store(paused, Ordering::Relaxed);
    }

    /// The factor for samples: the third power of the volume, so that equal volume steps sound about equal.
    fn gain(&self) -> f32 {
        if self.muted() { 0.0 } else { self.volume().powi(3) }
    }
}

/// An unbroken run of frames; see [the crate](crate).
pub struct Segment {
    id: u64,
    ring: Consumer<StereoFrame>,
    next: u64,
    /// The final number of frames; `u64::MAX` while more frames may follow.
    end: Arc<AtomicU64>,
    /// The time at which the segment's first frame is due; `None` if the segment has begun or may begin at any time.
    due: Option<Instant>,
}

impl Segment {
    /// Creates segment `id` with room for `frames` frames. Returns the decoding thread's end, and the callback's end.
    pub fn new(id: u64, frames: usize) -> (Producer<StereoFrame>, Arc<AtomicU64>, Self) {
        let (producer, ring) = RingBuffer::new(frames);
        let end = Arc::new(AtomicU64::new(u64::MAX));
        (producer, end.clone(), Self { id, ring, next: 0, end, due: None })
    }

    /// Sets the time at which the first frame is due. The callback plays silence before it and skips late frames.
    pub fn due_at(self, moment: Instant) -> Self {
        Self { due: Some(moment), ..self }
    }

    fn drained(&self) -> bool {
        // Read the end first, so that all frames up to it are in the ring already.
        let end = self.end.load(Ordering::Acquire);
        self.next >= end
    }

    /// True if the ring has enough frames for a device that takes a full buffer at once.
    fn is_well_fed(&self) -> bool {
        let ended = self.end.load(Ordering::Acquire) != u64::MAX;
        ended || self.ring.slots() >= self.ring.buffer().capacity() / 4
    }

    fn can_go_on(&self, rate: u32) -> bool {
        let enough = ((REFILL * f64::from(rate)) as usize).min(self.ring.buffer().capacity() / 4).max(1);
        let ended = self.end.load(Ordering::Acquire) != u64::MAX;
        let there = self.ring.slots();
        there >= enough || (ended && there > 0)
    }
}

/// The decoding thread's end of an [`OutputCallback`].
pub struct OutputCallbackLink {
    /// The device's frames per second.
    pub rate: u32,
    /// The maximum number of frames per call, if the device reports it.
    pub buffer_frames: usize,
    /// The history of audible frames.
    pub history: Arc<SpanHistory>,
    incoming: Producer<Segment>,
    outgoing: Consumer<Segment>,
    retired: Arc<AtomicBool>,
}

impl OutputCallbackLink {
    /// Hands over the next segment. Returns the segment if the previously offered segment is still waiting.
    pub fn offer(&mut self, segment: Segment) -> Result<(), Segment> {
        self.incoming.push(segment).map_err(|rtrb::PushError::Full(segment)| segment)
    }

    /// Frees the segments that the callback has returned.
    pub fn clean_up(&mut self) {
        while self.outgoing.pop().is_ok() {}
    }
}

impl Drop for OutputCallbackLink {
    /// Silences the callback, even if the device resumes later.
    fn drop(&mut self) {
        self.retired.store(true, Ordering::Relaxed);
    }
}

/// The callback of one output device.
pub struct OutputCallback {
    rate: u32,
    controls: Arc<Controls>,
    retired: Arc<AtomicBool>,
    spans: SpanWriter,
    incoming: Consumer<Segment>,
    outgoing: Producer<Segment>,
    segment: Option<Segment>,
    starved: bool,
    gain: f32,
    /// Position in a fade, in frames. 0 is silence, and `fade_frames` is full volume.
    fade: u32,
    fade_frames: u32,
    last: StereoFrame,
    chunk: [StereoFrame; CHUNK],
    open_span: Option<Span>,
}

impl OutputCallback {
    /// Creates the callback, and its link, for a device of `rate` frames per second and `buffer_frames` per call.
    pub fn new(rate: u32, buffer_frames: usize, controls: Arc<Controls>) -> (Self, OutputCallbackLink) {
        let (spans, history) = SpanHistory::new(rate);
        let (incoming_in, incoming) = RingBuffer::new(1);
        let (outgoing, outgoing_out) = RingBuffer::new(4);
        let retired = Arc::new(AtomicBool::new(false));
        let gain = controls.gain();
        let link = OutputCallbackLink {
            rate: rate.max(1),
            buffer_frames,
            history,
            incoming: incoming_in,
            outgoing: outgoing_out,
            retired: retired.clone(),
        };
        let output_callback = Self {
            rate: rate.max(1),
            controls,
            retired,
            spans,
            incoming,
            outgoing,
            segment: None,
            starved: false,
            gain,
            fade: 0,
            fade_frames: ((FADE * rate as f32) as u32).max(1),
            last: [0.0; 2],
            chunk: [[0.0; 2]; CHUNK],
            open_span: None,
        };
        (output_callback, link)
    }

    #[cfg(test)]
    pub(crate) fn is_offered(&self) -> bool {
        !self.incoming.is_empty()
    }

    /// Fills a device's buffer: `data` with `channels` interleaved channels. `latency` is the time from the call at
    /// `called_at` until the buffer's first frame is heard, if the device reports a plausible latency. A single channel
    /// gets the mean of left and right. Channels after the second get silence. Samples are within -1..1.
    pub fn fill<T: Sample + FromSample<f32>>(
        &mut self,
        data: &mut [T],
        channels: usize,
        called_at: Instant,
        latency: Option<Duration>,
    ) {
        let channels = channels.max(1);
        let frames = data.len() / channels;
        let (whole, rest) = data.split_at_mut(frames * channels);
        rest.fill(T::EQUILIBRIUM);
        if frames == 0 {
            return;
        }
        // A device that reports no latency is assumed to be playing the previous buffer.
        let of_one_buffer = Duration::from_nanos(self.spans.history.duration_ns(frames) as u64);
        let latency = latency.filter(|&latency| latency < LATENCY_MAX);
        let start_ns = self.spans.place(called_at, latency.unwrap_or(of_one_buffer), frames);
        let mut done = 0;
        while done < frames {
            let count = self.next_run((frames - done).min(CHUNK), start_ns, done);
            for (frame, out) in
                self.chunk[..count].iter().zip(whole[done * channels..].chunks_exact_mut(channels))
            {
                write_frame(*frame, out);
            }
            done += count;
        }
        self.close_span();
    }

    /// Produces up to `wanted` frames in `chunk`, at `offset` of a buffer that is audible from `start_ns` on. Returns
    /// the number of frames (at least 1).
    fn next_run(&mut self, wanted: usize, start_ns: u64, offset: usize) -> usize {
        let switching = !self.incoming.is_empty() && !self.outgoing.is_full();
        if switching && (self.fade == 0 || self.segment.is_none()) {
            self.swap_segment();
        } else if self.starved
            && self.fade == 0
            && self.segment.as_ref().is_some_and(|segment| segment.can_go_on(self.rate))
        {
            self.starved = false;
        }
        if let Some(count) = self.await_due(wanted, start_ns, offset) {
            return count;
        }
        let switching = !self.incoming.is_empty() && !self.outgoing.is_full();
        let halted = self.controls.paused() || self.retired.load(Ordering::Relaxed);
        let silent = halted || switching || self.starved || self.segment.is_none();
        let target = if silent { 0 } else { self.fade_frames };
        if silent && self.fade == 0 {
            self.be_silent(wanted);
            self.record_span(start_ns, offset, 0, wanted);
            return wanted;
        }
        let fading = self.fade.abs_diff(target) as usize;
        let run = if fading == 0 { wanted } else { wanted.min(fading) };
        let taken = self.copy_frames(run);
        if taken == 0 {
            // If there are no frames, repeat the last frame while it fades out.
            self.chunk[..run].fill(self.last);
        }
        let count = if taken == 0 { run } else { taken };
        let gain = self.controls.gain();
        let full = self.fade_frames as f32;
        let gain_step = 1.0 / (VOLUME_RAMP * self.rate as f32).max(1.0);
        let target = if taken == 0 { 0 } else { target };
        if let Some(&last) = self.chunk[..count].last() {
            self.last = last;
        }
        for frame in &mut self.chunk[..count] {
            self.fade =
                if self.fade < target { self.fade + 1 } else { self.fade.saturating_sub(1).max(target) };
            self.gain = approach(self.gain, gain, gain_step);
            let factor = self.gain * (self.fade as f32 / full);
            *frame = [frame[0] * factor, frame[1] * factor];
        }
        self.record_span(start_ns, offset, taken, count);
        count
    }

    /// Advances a segment with a due time to the frame that is due now, at `offset` of a buffer that is audible from
    /// `start_ns` on. If the segment cannot begin yet, produces silence and returns its length. The clock does not see
    /// the segment until it begins.
    fn await_due(&mut self, wanted: usize, start_ns: u64, offset: usize) -> Option<usize> {
        let halted = self.controls.paused();
        let segment = self.segment.as_mut()?;
        let due = segment.due?;
        let early_ns = self.spans.history.nanoseconds(due) as f64
            - (start_ns as f64 + self.spans.history.duration_ns(offset));
        let rate = f64::from(self.rate);
        let late = (-early_ns * 1e-9 * rate).round() - segment.next as f64;
        let mut begins = halted || late > LATE_MAX * rate;
        if !begins && late >= 0.0 {
            let count = segment.ring.slots().min(late as usize);
            if let Ok(chunk) = segment.ring.read_chunk(count) {
                chunk.commit_all();
                segment.next += count as u64;
            }
            begins = segment.drained() || (count as f64 == late && segment.is_well_fed());
        }
        if begins {
            segment.due = None;
            return None;
        }
        let silence = if late < 0.0 { wanted.min(-late as usize) } else { wanted };
        self.be_silent(silence);
        Some(silence)
    }

    fn be_silent(&mut self, count: usize) {
        self.chunk[..count].fill([0.0; 2]);
        self.last = [0.0; 2];
        self.gain = self.controls.gain();
    }

    /// Takes up to `count` frames of the segment into `chunk`, and detects an underrun or the end.
    fn copy_frames(&mut self, count: usize) -> usize {
        let Some(segment) = self.segment.as_mut().filter(|_| !self.starved) else { return 0 };
        // Read the end before the ring, so that all frames pushed before the end are seen.
        let drained = segment.drained();
        let (filled, _) = segment.ring.pop_partial_slice(&mut self.chunk[..count]);
        let taken = filled.len();
        segment.next += taken as u64;
        if taken == 0 {
            self.starved = true;
            if !drained && !segment.drained() {
                self.controls.underruns.fetch_add(1, Ordering::Relaxed);
            }
        }
        taken
    }

    fn swap_segment(&mut self) {
        let Ok(next) = self.incoming.pop() else { return };
        if let Some(old) = self.segment.replace(next) {
            // The caller has checked that the ring has room. Without room, leaking the segment would be the only way
            // not to free it on this thread.
            if let Err(rtrb::PushError::Full(old)) = self.outgoing.push(old) {
                std::mem::forget(old);
            }
        }
        self.starved = false;
        self.fade = 0;
    }

    /// Records for the clock that `frames` at `offset` of the buffer play the last `taken` frames of the segment.
    /// `taken` is 0 if the segment does not move.
    fn record_span(&mut self, start_ns: u64, offset: usize, taken: usize, frames: usize) {
        let Some(segment) = &self.segment else { return };
        let moving = taken > 0;
        // The song continues on another output, so nothing is recorded.
        if !moving && self.retired.load(Ordering::Relaxed) {
            return;
        }
        let id = segment.id;
        let frame = segment.next - taken as u64;
        if let Some(open) = self.open_span.as_mut() {
            let expected = open.frame + if open.moving { u64::from(open.frames) } else { 0 };
            if open.segment == id && open.moving == moving && frame == expected {
                open.frames = open.frames.saturating_add(frames as u32);
                return;
            }
        }
        self.close_span();
        let start_ns = start_ns + self.spans.history.duration_ns(offset) as u64;
        self.open_span = Some(Span { start_ns, segment: id, frame, frames: frames as u32, moving });
    }

    fn close_span(&mut self) {
        if let Some(span) = self.open_span.take() {
            self.spans.push(span);
        }
    }
}

fn approach(value: f32, target: f32, step: f32) -> f32 {
    if value < target { (value + step).min(target) } else { (value - step).max(target) }
}

fn write_frame<T: Sample + FromSample<f32>>(frame: StereoFrame, out: &mut [T]) {
    match out {
        [mono] => *mono = to_device((frame[0] + frame[1]) * 0.5),
        [left, right, others @ ..] => {
            *left = to_device(frame[0]);
            *right = to_device(frame[1]);
            others.fill(T::EQUILIBRIUM);
        }
        [] => {}
    }
}

fn to_device<T: Sample + FromSample<f32>>(sample: f32) -> T {
    let finite = if sample.is_finite() { sample } else { 0.0 };
    T::from_sample(finite.clamp(-1.0, SAMPLE_MAX))
}

#[cfg(test)]
#[path = "output_callback_tests.rs"]
mod tests;
