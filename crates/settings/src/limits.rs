//! The limits of the settings. Code, messages and tests read them from here.

/// The maximum size of the settings file, in bytes.
pub const SETTINGS_BYTES_MAX: usize = 1 << 20;
/// The maximum number of recent folders.
pub const RECENT_FOLDERS_MAX: usize = 8;
/// The maximum duration of a fade between scenes, in seconds.
pub const FADE_SECONDS_MAX: f64 = 60.0;
