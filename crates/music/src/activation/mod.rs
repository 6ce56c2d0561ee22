//! How likely a beat is at each moment of a song or of live input, by a small network. It was trained on generated music
//! only (`training_tests`).

mod input;
mod network;
#[cfg(test)]
mod training_tests;

use input::Input;
use network::Network;

/// The network processes one spectrum every this many hops.
pub(super) const STEP_HOPS: usize = 2;
/// The length of a spectrum's window, in hops.
pub(super) const WINDOW_HOPS: usize = 4;

/// The weights of a network that knows the whole song.
pub(super) const WHOLE: &[u8] = include_bytes!("weights.bin");
/// The weights of a network that knows hardly more than the past.
pub(super) const LIVE: &[u8] = include_bytes!("live_weights.bin");

/// Measures the log odds of a beat.
pub(super) struct Activation {
    input: Input,
    /// `None` if the weights are damaged.
    network: Option<Network>,
}

impl Activation {
    /// Creates the measurement for hops of `hop` frames at `rate` hertz.
    pub(super) fn new(weights: &[u8], hop: usize, rate: f64) -> Self {
        let length = WINDOW_HOPS * hop;
        let step_seconds = (STEP_HOPS * hop) as f64 / rate;
        Self {
            input: Input::new(length / 2, rate / length as f64, step_seconds),
            network: Network::read(weights),
        }
    }

    /// The delay of the results, in steps.
    pub(super) fn late(&self) -> usize {
        self.network.as_ref().map_or(0, Network::late)
    }

    /// Forgets all moments.
    pub(super) fn restart(&mut self) {
        self.input.restart();
        if let Some(network) = &mut self.network {
            network.restart();
        }
    }

    /// Processes the power spectrum of the newest [`WINDOW_HOPS`] hops, every [`STEP_HOPS`] hops, and returns the log
    /// odds of a beat.
    pub(super) fn follow(&mut self, power: &[f32]) -> f32 {
        let numbers = self.input.follow(power);
        self.network.as_mut().map_or(0.0, |network| network.follow(Some(&numbers)))
    }

    /// Returns the next result after the last spectrum.
    pub(super) fn end(&mut self) -> f32 {
        self.network.as_mut().map_or(0.0, |network| network.follow(None))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_weights_are_complete() {
        for weights in [WHOLE, LIVE] {
            assert!(Network::read(weights).is_some());
            assert!(Network::read(&weights[..weights.len() - 1]).is_none());
        }
    }
}
