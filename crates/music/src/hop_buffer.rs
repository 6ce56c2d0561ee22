//! A buffer of the newest sample frames of a stream, which advances in hops.

use super::StereoFrame;

/// The maximum magnitude of samples (+18 dB), so that no feature overflows.
pub(super) const SAMPLE_MAX: f32 = 8.0;

const REFERENCE_RATE: f64 = 48_000.0;

/// The hop in sample frames at the reference rate, at which it lasts 10.7 ms.
const REFERENCE_HOP: f64 = 512.0;

/// Returns the hop at `rate` hertz: the reference hop, scaled by the nearest power of two.
pub(super) fn hop_at(rate: f64) -> usize {
    (REFERENCE_HOP * (rate / REFERENCE_RATE).log2().round().exp2()) as usize
}

pub(super) struct HopBuffer {
    pub(super) frames: Vec<StereoFrame>,
    filled: usize,
    pub(super) hop: usize,
}

impl HopBuffer {
    /// Creates a silent window of `length` frames; the next frame is stored at index `filled`.
    pub(super) fn new(length: usize, hop: usize, filled: usize) -> Self {
        Self { frames: vec![[0.0; 2]; length], filled, hop }
    }

    pub(super) fn restart(&mut self, filled: usize) {
        self.frames.fill([0.0; 2]);
        self.filled = filled;
    }

    /// Stores frames, clamped to ±8 and finite, until the window is full. Returns the stored and the remaining frames.
    pub(super) fn fill<'a>(&mut self, frames: &'a [StereoFrame]) -> (&[StereoFrame], &'a [StereoFrame]) {
        let free = &mut self.frames[self.filled..];
        let (now, later) = frames.split_at(frames.len().min(free.len()));
        for (stored, frame) in free.iter_mut().zip(now) {
            *stored = frame.map(sanitised);
        }
        let start = self.filled;
        self.filled += now.len();
        (&self.frames[start..self.filled], later)
    }

    pub(super) fn end(&mut self) {
        self.frames[self.filled..].fill([0.0; 2]);
        self.filled = self.frames.len();
    }

    pub(super) fn is_full(&self) -> bool {
        self.filled == self.frames.len()
    }

    pub(super) fn advance(&mut self) {
        self.frames.copy_within(self.hop.., 0);
        self.filled -= self.hop;
    }

    pub(super) fn newest(&self, count: usize) -> &[StereoFrame] {
        &self.frames[self.frames.len() - count..]
    }
}

fn sanitised(sample: f32) -> f32 {
    if sample.is_finite() { sample.clamp(-SAMPLE_MAX, SAMPLE_MAX) } else { 0.0 }
}
