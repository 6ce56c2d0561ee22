//! All limits of this crate. Code, error messages and tests read them from here.

/// Limits on the analysed sound and on stored results.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// The minimum sample rate of a stream, in hertz.
    pub sample_rate_min: u32,
    /// The maximum sample rate of a stream, in hertz.
    pub sample_rate_max: u32,
    /// The maximum time span of a feature track, in seconds (0.5 MB per second).
    pub feature_track_seconds_max: f64,
    /// The maximum length of a stem, in seconds (8 kB per second). The rest of a longer stem is silent.
    pub part_seconds_max: f64,
    /// The maximum length of the part of a song that is analysed, in seconds (7 kB per second).
    pub song_seconds_max: f64,
}

/// The limits in force.
pub const LIMITS: Limits = Limits {
    sample_rate_min: 4_000,
    sample_rate_max: 768_000,
    feature_track_seconds_max: 60.0,
    part_seconds_max: 3600.0,
    song_seconds_max: 4.0 * 3600.0,
};
