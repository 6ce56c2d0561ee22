//! Every ceiling of this crate, in one place.
//!
//! A limit is data: code that obeys a limit reads it here, an error that reports one names the number from here, and
//! a test reaches it.

/// Ceilings on the sound that is analysed and on what is kept of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Lowest sample rate of a stream, in hertz.
    pub sample_rate_min: u32,
    /// Highest sample rate of a stream, in hertz.
    pub sample_rate_max: u32,
    /// Longest time over which a feature track remembers, in seconds (0.5 MB for each).
    pub feature_track_seconds_max: f64,
    /// How much of a song is listened to for its structure, in seconds (7 kB for each).
    pub song_seconds_max: f64,
}

/// The limits in force.
pub const LIMITS: Limits = Limits {
    sample_rate_min: 4_000,
    sample_rate_max: 768_000,
    feature_track_seconds_max: 60.0,
    song_seconds_max: 4.0 * 3600.0,
};
