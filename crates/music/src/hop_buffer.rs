//! The newest frames of a stream, cut into hops.

use super::StereoFrame;

/// Samples are clamped to this magnitude (+18 dB), so that no input makes a feature overflow.
pub(super) const SAMPLE_MAX: f32 = 8.0;

/// Rate for which the hop is given, in hertz.
const REFERENCE_RATE: f64 = 48_000.0;

/// Frames from one moment to the next at the reference rate: 10.7 ms.
const REFERENCE_HOP: f64 = 512.0;

/// Frames per hop at `rate` hertz: those of the reference rate, scaled by the nearest power of two.
pub(super) fn hop_at(rate: f64) -> usize {
    (REFERENCE_HOP * (rate / REFERENCE_RATE).log2().round().exp2()) as usize
}

/// A window of frames that moves on by a hop whenever it is full.
pub(super) struct HopBuffer {
    frames: Vec<StereoFrame>,
    filled: usize,
    hop: usize,
}

impl HopBuffer {
    /// A window of `length` frames of silence, to be filled from frame `filled` on.
    pub(super) fn new(length: usize, hop: usize, filled: usize) -> Self {
        Self { frames: vec![[0.0; 2]; length], filled, hop }
    }

    /// Forgets all frames; the next ones are stored from frame `filled` on.
    pub(super) fn restart(&mut self, filled: usize) {
        self.frames.fill([0.0; 2]);
        self.filled = filled;
    }

    /// Stores frames until the window is full. Gives those that were stored and the rest. Samples that are not finite
    /// count as 0; others are clamped to ±8.
    pub(super) fn take<'a>(&mut self, frames: &'a [StereoFrame]) -> (&[StereoFrame], &'a [StereoFrame]) {
        let free = &mut self.frames[self.filled..];
        let (now, later) = frames.split_at(frames.len().min(free.len()));
        for (stored, frame) in free.iter_mut().zip(now) {
            *stored = frame.map(sanitised);
        }
        let start = self.filled;
        self.filled += now.len();
        (&self.frames[start..self.filled], later)
    }

    /// Fills the rest of the window with silence.
    pub(super) fn end(&mut self) {
        self.frames[self.filled..].fill([0.0; 2]);
        self.filled = self.frames.len();
    }

    /// Whether the window is full.
    pub(super) fn is_full(&self) -> bool {
        self.filled == self.frames.len()
    }

    /// Moves a full window on by a hop.
    pub(super) fn advance(&mut self) {
        self.frames.copy_within(self.hop.., 0);
        self.filled -= self.hop;
    }

    /// The whole window.
    pub(super) fn frames(&self) -> &[StereoFrame] {
        &self.frames
    }

    /// The last so many frames of the window.
    pub(super) fn newest(&self, count: usize) -> &[StereoFrame] {
        &self.frames[self.frames.len() - count..]
    }

    /// Frames per hop.
    pub(super) fn hop(&self) -> usize {
        self.hop
    }
}

fn sanitised(sample: f32) -> f32 {
    if sample.is_finite() { sample.clamp(-SAMPLE_MAX, SAMPLE_MAX) } else { 0.0 }
}
