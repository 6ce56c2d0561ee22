//! Every ceiling of this crate, in one place.
//!
//! A limit is data: code that obeys a limit reads it here, an error that reports one names the number from here, and
//! a test reaches it.

use std::time::Duration;

/// Ceilings on what comes from outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Most bytes of a name that comes from outside: of a parameter, a scene, an action.
    pub name_bytes_max: usize,
    /// Most different parameters that are wished for between two frames; further ones are refused.
    pub pending_params_max: usize,
    /// Most actions that are wished for between two frames; further ones are refused.
    pub pending_actions_max: usize,
    /// Most bundles and messages of one packet of OSC; what comes behind them is left out.
    pub osc_elements_max: usize,
    /// Deepest nesting of bundles.
    pub osc_depth_max: usize,
    /// Most arguments of a message.
    pub osc_arguments_max: usize,
    /// Most answers to one packet.
    pub osc_answers_max: usize,
    /// Most addresses that one pattern stands for; further ones are left out.
    pub osc_matches_max: usize,
    /// Furthest time of a bundle that is waited for, in seconds.
    pub osc_ahead_seconds_max: f64,
    /// Most messages that wait for their time; further ones are refused.
    pub osc_waiting_max: usize,
    /// Time between two attempts to open a port that the system refuses.
    pub port_retry: Duration,
    /// Lowest and highest rate at which OSC is sent, in packets a second.
    pub osc_rate_min: f64,
    /// See [`Limits::osc_rate_min`].
    pub osc_rate_max: f64,
    /// Most different knobs that move between two frames; further ones are refused.
    pub moved_knobs_max: usize,
    /// Most presses of one key or button that count between two frames.
    pub presses_max: u32,
    /// Most MIDI devices that are heard at a time.
    pub midi_devices_max: usize,
    /// Most mappings of knobs.
    pub mappings_max: usize,
    /// Most bytes of a file of mappings.
    pub mapping_bytes_max: usize,
    /// Longest smoothing, in seconds.
    pub smoothing_seconds_max: f32,
}

/// The limits in force.
pub const LIMITS: Limits = Limits {
    name_bytes_max: 256,
    pending_params_max: 512,
    pending_actions_max: 64,
    osc_elements_max: 1_024,
    osc_depth_max: 8,
    osc_arguments_max: 64,
    osc_answers_max: 1_024,
    osc_matches_max: 256,
    osc_ahead_seconds_max: 60.0,
    osc_waiting_max: 1_024,
    port_retry: Duration::from_secs(1),
    osc_rate_min: 1.0,
    osc_rate_max: 240.0,
    moved_knobs_max: 4_096,
    presses_max: 8,
    midi_devices_max: 32,
    mappings_max: 1_000,
    mapping_bytes_max: 1 << 20,
    smoothing_seconds_max: 60.0,
};
