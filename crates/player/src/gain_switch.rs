//! The gain control, which may change during the analysis.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use mariana_music::Gain;

/// A [`Gain`] that one thread sets and other threads read. Clones refer to the same setting.
#[derive(Debug, Clone)]
pub(crate) struct GainSwitch(Arc<AtomicBool>);

impl GainSwitch {
    pub(crate) fn new(gain: Gain) -> Self {
        Self(Arc::new(AtomicBool::new(gain == Gain::Auto)))
    }

    pub(crate) fn set(&self, gain: Gain) {
        self.0.store(gain == Gain::Auto, Ordering::Relaxed);
    }

    pub(crate) fn get(&self) -> Gain {
        if self.0.load(Ordering::Relaxed) { Gain::Auto } else { Gain::Off }
    }
}
