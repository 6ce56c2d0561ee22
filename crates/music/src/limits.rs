//! All limits of this crate. Code, error messages and tests read them from here.

/// The minimum sample rate of a stream, in hertz.
pub const SAMPLE_RATE_MIN: u32 = 4_000;
/// The maximum sample rate of a stream, in hertz.
pub const SAMPLE_RATE_MAX: u32 = 768_000;
/// The maximum time span of a feature track, in seconds (0.5 MB per second).
pub const FEATURE_TRACK_SECONDS_MAX: f64 = 60.0;
/// The maximum length of a stem, in seconds (8 kB per second). The rest of a longer stem is silent.
pub const PART_SECONDS_MAX: f64 = 3600.0;
/// The maximum length of the part of a song that is analysed, in seconds (7 kB per second).
pub const SONG_SECONDS_MAX: f64 = 4.0 * 3600.0;
