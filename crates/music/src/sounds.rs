//! Drums and loudness: features that are measured from the same hops and spectra as the bands.

use super::StereoFrame;
use super::drums::Drums;
use super::features::Features;
use super::loudness::Loudness;
use super::resolution::Resolution;

pub(super) struct Sounds {
    pub(super) drums: Drums,
    loudness: Loudness,
}

impl Sounds {
    pub(super) fn new(hop: usize, rate: f64, centred: bool) -> Self {
        let hop_seconds = hop as f64 / rate;
        let short = hop * Resolution::Short.hops();
        Self {
            drums: Drums::new(short / 2, rate / short as f64, hop_seconds, centred),
            loudness: Loudness::new(rate, hop_seconds),
        }
    }

    pub(super) fn restart(&mut self) {
        self.drums.restart();
        self.loudness.restart();
    }

    /// Measures a moment from the newest hop of frames and the spectra of [`Resolution::ALL`].
    pub(super) fn follow(
        &mut self,
        newest: &[StereoFrame],
        [_, middle, short]: [&[f32]; Resolution::ALL.len()],
        features: &mut Features,
    ) {
        [features.kick, features.snare, features.hat] = self.drums.follow(middle, short);
        features.loudness_lufs = self.loudness.follow(newest);
    }
}
