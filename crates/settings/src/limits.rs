//! The limits of the settings. Code, messages and tests read them from here.

/// Limits on data from outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// The maximum size of the settings file, in bytes.
    pub settings_bytes_max: usize,
    /// The maximum number of recent folders.
    pub recent_folders_max: usize,
    /// The maximum duration of a fade between scenes, in seconds.
    pub fade_seconds_max: f64,
}

/// The limits in force.
pub const LIMITS: Limits =
    Limits { settings_bytes_max: 1 << 20, recent_folders_max: 8, fade_seconds_max: 60.0 };
