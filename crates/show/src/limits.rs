//! Every limit of shows.
//!
//! A limit is data: code that applies one reads it here, an error that reports one gives the number defined here, and
//! a test reaches it.

/// Limits on what comes from outside and on what is allocated for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Most bytes of a show's text.
    pub bytes_max: usize,
    /// Most entries of a show.
    pub entries_max: usize,
    /// Most parameters that an entry of a show moves.
    pub settings_max: usize,
    /// Most steps of one of their movements.
    pub steps_max: usize,
    /// Pictures of a show of which one is held while another gives way, that are mixed into one.
    pub held_max: usize,
    /// Latest moment and longest length in a show, in seconds (a day).
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
