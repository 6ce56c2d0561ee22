//! The limits on shows, for code, error messages and tests.

/// Limits on show files and on the memory that shows use.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Maximum size of a show's text, in bytes.
    pub bytes_max: usize,
    /// Maximum number of entries in a show. A file with more is refused, and a recording ends there.
    pub entries_max: usize,
    /// Maximum number of settings in an entry.
    pub settings_max: usize,
    /// Maximum number of steps in a setting.
    pub steps_max: usize,
    /// Maximum number of frozen frames that are visible at once. Beyond it, the oldest are dropped.
    pub held_max: usize,
    /// Maximum time and length in a show file, in seconds: a day.
    pub seconds_max: f64,
}

/// The limits in force.
pub const LIMITS: Limits = Limits {
    bytes_max: 1 << 24,
    entries_max: 10_000,
    settings_max: 64,
    steps_max: 20_000,
    held_max: 8,
    seconds_max: 86_400.0,
};
