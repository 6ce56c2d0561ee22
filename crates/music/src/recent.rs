//! The sound of the last seconds, without curves, for scenes whose things have inertia.

use super::features::Features;
use super::song::SongMoment;

/// The time span of recent moments, in seconds.
pub const RECENT_SECONDS: f64 = 6.0;

/// One of this many moments of the analysis is kept: one every 21 ms at 48 kHz. They are at fixed moments of the stream,
/// so that what is computed from them does not depend on the frames.
pub(super) const MOMENTS_PER_RECENT: u64 = 2;

/// The sound of an earlier moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Recent {
    /// Seconds before the moment of the image, above 0 and at most [`RECENT_SECONDS`].
    pub age: f64,
    /// The features.
    pub features: Features,
    /// The position in the song.
    pub song: SongMoment,
    /// The numbers of the song's parts, as in [`Sound`](super::Sound).
    pub parts: Vec<f32>,
}
