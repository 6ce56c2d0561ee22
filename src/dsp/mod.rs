//! Analysis: stereo samples in, [`Features`] out. Pure: no I/O, no clock, no thread, no knowledge of devices.
//!
//! ```text
//! frames ─► Analyzer (fixed hops) ─┬─ window ─ spectrum ─ bands ─ smoothing ─┐
//!                                  └─ volume ─────────────────── smoothing ─┴─► TimedFeatures ─► FeatureTrack ─► at(time)
//! ```
//!
//! Everything runs on hops of samples counted from the start of the stream, never on pictures or on blocks as
//! they happen to arrive. So the features of a moment are the same live and offline, at any frame rate and
//! however the samples were cut into blocks.

mod analyzer;
mod bands;
mod features;
mod smoothing;
mod spectrum;
mod track;
mod volume;
mod window;

pub use analyzer::{Alignment, Analyzer};
pub use bands::{BAND_HIGHEST_HZ, BAND_LOWEST_HZ, band_edge};
pub use features::{BAND_COUNT, Features, LEVEL_FLOOR_DB, TimedFeatures};
pub use track::FeatureTrack;

/// One sample of each channel, left then right; nominally -1..1.
pub type StereoFrame = [f32; 2];
