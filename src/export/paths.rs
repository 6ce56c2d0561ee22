//! Light by paths, for stills and videos.

use std::time::Duration;

use super::path_store::SharedStore;
use crate::config::Choice;
use crate::frame::Frame;
use crate::gpu::renderer::{PathProgress, PathWatcher};
use crate::gpu::{KeptPaths, PathOrder, PathSampling};

/// How the light of an image is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LightModel {
    /// As in the window.
    Raster,
    /// By paths of light.
    Paths,
}

impl Choice for LightModel {
    const ALL: &'static [(Self, &'static str, &'static str)] = &[
        (Self::Raster, "raster", "as in the window"),
        (Self::Paths, "path", "paths of light: exact shadows, reflections and indirect light, but slow"),
    ];
}

/// When an image by paths is good enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathChoice {
    /// The largest number of paths of a pixel.
    pub samples: u16,
    /// Pixels get no more paths when their relative standard error is below this number; 0 for no such limit.
    pub noise: f32,
    /// True to smooth the noise that is left.
    pub is_filtered: bool,
}

impl PathChoice {
    /// The default number of paths.
    pub const SAMPLES: u16 = 256;
    /// The default noise.
    pub const NOISE: f32 = 0.03;
}

/// Watches a still by paths.
pub struct PathWatch {
    /// Receives the number of paths of a pixel so far, in the mean. Returns false to finish the image early.
    pub reach: Box<dyn FnMut(f64) -> bool>,
    /// The time after which the paths are saved. An interruption without a signal loses less than these.
    pub save_every: Duration,
}

impl PathWatch {
    /// The default time.
    pub const SAVE_EVERY: Duration = Duration::from_secs(60);
}

impl Default for PathWatch {
    fn default() -> Self {
        Self { reach: Box::new(|_| true), save_every: Self::SAVE_EVERY }
    }
}

/// The paths of the images of a renderer.
pub(super) struct PathDrawing {
    choice: PathChoice,
    /// The exposure of the next image, and their number.
    pub(super) exposure: (usize, usize),
    /// The hash of the scene of the next image.
    pub(super) scene: u64,
    pub(super) watch: PathWatch,
    pub(super) store: Option<SharedStore>,
    is_ending: bool,
}

impl PathDrawing {
    pub(super) fn of(choice: PathChoice) -> Self {
        let watch = PathWatch::default();
        Self { choice, exposure: (0, 1), scene: 0, watch, store: None, is_ending: false }
    }

    /// The paths of the next exposure, which is a part of the image's paths.
    pub(super) fn order(&self) -> PathOrder {
        let (number, count) = self.exposure;
        let samples = usize::from(self.choice.samples).div_ceil(count.max(1));
        // The error of the mean of exposures is smaller than theirs.
        let noise = self.choice.noise * (count.max(1) as f32).sqrt();
        let [samples, first] = [samples, number * samples].map(|number| number as u32);
        PathOrder {
            samples,
            noise,
            first,
            sampling: PathSampling::Both,
            is_filtered: self.choice.is_filtered,
        }
    }
}

impl PathWatcher for PathDrawing {
    fn begin(&mut self, frame: &Frame, pixels: usize) -> Option<KeptPaths> {
        let mut store = self.store.as_ref()?.borrow_mut();
        store.begin(self.scene, frame, pixels, &self.order())
    }

    fn resume(&mut self, progress: PathProgress, kept: &dyn Fn() -> KeptPaths) -> bool {
        if self.is_ending {
            return false;
        }
        let (number, count) = self.exposure;
        let fraction = (number as f64 + progress.fraction) / count.max(1) as f64;
        self.is_ending = !(self.watch.reach)(fraction * f64::from(self.choice.samples));
        match self.store.as_ref().map(|store| store.borrow_mut()) {
            Some(mut store) if self.is_ending => store.interrupt(kept),
            Some(mut store) => store.save_in_time(kept),
            None => {}
        }
        !self.is_ending
    }

    fn end(&mut self, is_last: bool, kept: &dyn Fn() -> KeptPaths) {
        let (number, count) = self.exposure;
        if let Some(store) = self.store.as_ref().filter(|_| !self.is_ending) {
            store.borrow_mut().end(is_last && number + 1 == count, kept);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exposures_share_the_paths_of_a_pixel_without_overlap() {
        let mut drawing = PathDrawing::of(PathChoice { samples: 100, noise: 0.01, is_filtered: true });
        let order = drawing.order();
        assert_eq!((order.samples, order.first, order.noise), (100, 0, 0.01));
        let mut next = 0;
        for number in 0..8 {
            drawing.exposure = (number, 8);
            let order = drawing.order();
            assert_eq!((order.first, order.samples), (next, 13));
            next += order.samples;
        }
    }
}
