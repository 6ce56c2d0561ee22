//! A long window of the stream at a lower rate, for low frequencies.

use super::StereoFrame;
use super::decimate::Decimator;
use super::spectrum::Spectrum;

/// The window, what fills it, and its spectrum.
pub(super) struct SlowWindow {
    kept: Vec<StereoFrame>,
    decimator: Decimator,
    spectrum: Spectrum,
}

impl SlowWindow {
    /// A window of `length` frames that the decimator keeps. The power of bin n is divided by `gain` of n.
    pub(super) fn new(decimator: Decimator, length: usize, gain: impl Fn(usize, &Decimator) -> f64) -> Self {
        let spectrum = Spectrum::new(length, |bin| gain(bin, &decimator));
        Self { kept: vec![[0.0; 2]; length], decimator, spectrum }
    }

    /// Forgets all frames.
    pub(super) fn restart(&mut self) {
        self.kept.fill([0.0; 2]);
    }

    /// Moves the window on by a hop of `hop` frames; the newest of `frames` ends it.
    pub(super) fn follow(&mut self, frames: &[StereoFrame], hop: usize) {
        let new = hop / self.decimator.step();
        self.kept.copy_within(new.., 0);
        let start = self.kept.len() - new;
        self.decimator.keep(frames, &mut self.kept[start..]);
    }

    /// Fills the whole window from `frames`.
    pub(super) fn fill(&mut self, frames: &[StereoFrame]) {
        self.decimator.keep(frames, &mut self.kept);
    }

    /// The power per bin.
    pub(super) fn power(&mut self) -> &[f32] {
        self.spectrum.power(&self.kept)
    }
}
