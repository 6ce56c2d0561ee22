//! A long window at a lower sample rate, for low frequencies.

use super::StereoFrame;
use super::decimate::Decimator;
use super::spectrum::Spectrum;

pub(super) struct SlowWindow {
    kept: Vec<StereoFrame>,
    decimator: Decimator,
    spectrum: Spectrum,
}

impl SlowWindow {
    /// Creates a window of `length` decimated frames. The power of each bin is divided by its `gain`.
    pub(super) fn new(decimator: Decimator, length: usize, gain: impl Fn(usize, &Decimator) -> f64) -> Self {
        let spectrum = Spectrum::new(length, |bin| gain(bin, &decimator));
        Self { kept: vec![[0.0; 2]; length], decimator, spectrum }
    }

    pub(super) fn restart(&mut self) {
        self.kept.fill([0.0; 2]);
    }

    /// Advances the window by a hop of `hop` frames. Afterwards the window ends at the newest of `frames`.
    pub(super) fn follow(&mut self, frames: &[StereoFrame], hop: usize) {
        let new = hop / self.decimator.step();
        self.kept.copy_within(new.., 0);
        let start = self.kept.len() - new;
        self.decimator.keep(frames, &mut self.kept[start..]);
    }

    pub(super) fn fill(&mut self, frames: &[StereoFrame]) {
        self.decimator.keep(frames, &mut self.kept);
    }

    pub(super) fn spectrum(&mut self) -> &Spectrum {
        self.spectrum.measure(&self.kept)
    }
}
