//! Every limit on settings.
//!
//! Code, error messages and tests all read the limits from here.

/// Limits on what comes from outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Most bytes of the settings file.
    pub settings_bytes_max: usize,
    /// Longest fade from one scene to another, in seconds.
    pub fade_seconds_max: f64,
}

/// The limits in force.
pub const LIMITS: Limits = Limits { settings_bytes_max: 1 << 20, fade_seconds_max: 60.0 };
