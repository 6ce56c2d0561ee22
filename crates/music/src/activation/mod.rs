//! How likely a beat is at each moment of a song, by a small network. It was trained on generated music only
//! (`training_tests`).

mod input;
mod network;
#[cfg(test)]
mod training_tests;

use input::Input;
use network::Network;

use super::StereoFrame;
use super::spectrum::Spectrum;

/// The network processes one spectrum every this many hops.
pub(super) const STEP_HOPS: usize = 2;
/// The length of a spectrum's window, in hops.
pub(super) const WINDOW_HOPS: usize = 4;

const WEIGHTS: &[u8] = include_bytes!("weights.bin");

/// Measures the log odds of a beat.
pub(super) struct Activation {
    spectrum: Spectrum,
    input: Input,
    /// `None` if the weights are damaged.
    network: Option<Network>,
}

impl Activation {
    /// Creates the measurement for hops of `hop` frames at `rate` hertz.
    pub(super) fn new(hop: usize, rate: f64) -> Self {
        let length = WINDOW_HOPS * hop;
        Self {
            spectrum: Spectrum::new(length, |_| 1.0),
            input: Input::new(length / 2, rate / length as f64, (STEP_HOPS * hop) as f64 / rate),
            network: Network::read(WEIGHTS),
        }
    }

    /// The delay of the results, in steps.
    pub(super) fn late(&self) -> usize {
        self.network.as_ref().map_or(0, Network::late)
    }

    /// Processes the newest [`WINDOW_HOPS`] hops, every [`STEP_HOPS`] hops, and returns the log odds of a beat.
    pub(super) fn follow(&mut self, frames: &[StereoFrame]) -> f32 {
        let numbers = self.input.follow(&self.spectrum.measure(frames).power);
        self.network.as_mut().map_or(0.0, |network| network.follow(Some(&numbers)))
    }

    /// Returns the next result after the last frames.
    pub(super) fn end(&mut self) -> f32 {
        self.network.as_mut().map_or(0.0, |network| network.follow(None))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_weights_are_complete() {
        assert!(Network::read(WEIGHTS).is_some());
        assert!(Network::read(&WEIGHTS[..WEIGHTS.len() - 1]).is_none());
    }
}
