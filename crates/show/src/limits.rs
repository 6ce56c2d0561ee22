//! The limits on shows, for code, error messages and tests.

/// Maximum size of a show's text, in bytes.
pub const BYTES_MAX: usize = 1 << 24;
/// Maximum number of entries in a show. A file with more is refused, and a recording ends there.
pub const ENTRIES_MAX: usize = 10_000;
/// Maximum number of settings in an entry.
pub const SETTINGS_MAX: usize = 64;
/// Maximum number of steps in a setting.
pub const STEPS_MAX: usize = 20_000;
/// Maximum number of frozen frames that are visible at once. Beyond it, the oldest are dropped.
pub const HELD_MAX: usize = 8;
/// Maximum time and length in a show file, in seconds: a day.
pub const SECONDS_MAX: f64 = 86_400.0;
