//! All limits of this crate. Code, error messages and tests read them from here.

use std::time::Duration;

/// Limits on input from outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// The maximum length of a parameter, scene or action name, in bytes.
    pub name_bytes_max: usize,
    /// The maximum number of parameters changed between two frames; changes of other parameters are rejected.
    pub pending_params_max: usize,
    /// The maximum number of actions between two frames; later actions are rejected.
    pub pending_actions_max: usize,
    /// The maximum number of bundles and messages in one OSC packet; the rest is ignored.
    pub osc_elements_max: usize,
    /// The maximum nesting depth of OSC bundles.
    pub osc_depth_max: usize,
    /// The maximum number of arguments of an OSC message.
    pub osc_arguments_max: usize,
    /// The maximum number of answers to one packet.
    pub osc_answers_max: usize,
    /// The maximum number of addresses that a pattern matches; the rest is ignored.
    pub osc_matches_max: usize,
    /// The maximum time that a bundle may be scheduled ahead, in seconds.
    pub osc_ahead_seconds_max: f64,
    /// The maximum number of scheduled messages; later messages are rejected.
    pub osc_waiting_max: usize,
    /// The interval between two attempts to open a port.
    pub port_retry: Duration,
    /// The minimum rate at which OSC is sent, in packets a second.
    pub osc_rate_min: f64,
    /// The maximum rate at which OSC is sent, in packets a second.
    pub osc_rate_max: f64,
    /// The maximum number of knobs moved between two frames; movements of other knobs are rejected.
    pub moved_knobs_max: usize,
    /// The maximum number of presses counted for one key or button between two frames.
    pub presses_max: u32,
    /// The maximum number of MIDI devices open at the same time.
    pub midi_devices_max: usize,
    /// The maximum number of knob mappings.
    pub mappings_max: usize,
    /// The maximum size of a mapping file, in bytes.
    pub mapping_bytes_max: usize,
    /// The maximum smoothing time, in seconds.
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
