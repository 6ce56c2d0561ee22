//! What the command line says of quality.

use crate::config::QualityChoice;

/// See [`QualityChoice`].
#[derive(Clone, Copy, clap::ValueEnum)]
pub(super) enum Quality {
    /// As good as the frame rate allows
    Auto,
    /// About half of the window's width and height
    Low,
    Medium,
    High,
    /// Every pixel, every term, however long it takes
    Best,
}

impl From<Quality> for QualityChoice {
    fn from(quality: Quality) -> Self {
        match quality {
            Quality::Auto => QualityChoice::Auto,
            Quality::Low => QualityChoice::Low,
            Quality::Medium => QualityChoice::Medium,
            Quality::High => QualityChoice::High,
            Quality::Best => QualityChoice::Best,
        }
    }
}
