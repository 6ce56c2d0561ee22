//! The limits on shows. Code, error messages and tests read them from here.

/// Limits on show files and on the memory for them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Most bytes of a show's text.
    pub bytes_max: usize,
    /// Most entries of a show.
    pub entries_max: usize,
    /// Most settings of an entry.
    pub settings_max: usize,
    /// Most steps of a setting.
    pub steps_max: usize,
    /// Most frozen frames mixed into one image.
    pub held_max: usize,
    /// Latest moment and longest length in a show file, in seconds (a day).
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
