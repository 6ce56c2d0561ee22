//! Every ceiling of this crate, in one place.
//!
//! A limit is data: code that obeys a limit reads it here, an error that reports one names the number from here, and
//! a test reaches it.

/// Ceilings on what comes from outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Most bytes of a name that comes from outside: of a parameter, a scene, an action.
    pub name_bytes_max: usize,
    /// Most different parameters that are wished for between two frames; further ones are refused.
    pub wished_params_max: usize,
    /// Most actions that are wished for between two frames; further ones are refused.
    pub wished_deeds_max: usize,
    /// Most bundles and messages of one packet of OSC; what comes behind them is left out.
    pub osc_elements_max: usize,
    /// Deepest nesting of bundles.
    pub osc_depth_max: usize,
    /// Most arguments of a message.
    pub osc_arguments_max: usize,
    /// Most answers to one packet.
    pub osc_answers_max: usize,
    /// Longest smoothing, in seconds.
    pub smoothing_seconds_max: f32,
}

/// The limits in force.
pub const LIMITS: Limits = Limits {
    name_bytes_max: 256,
    wished_params_max: 512,
    wished_deeds_max: 64,
    osc_elements_max: 1_024,
    osc_depth_max: 8,
    osc_arguments_max: 64,
    osc_answers_max: 1_024,
    smoothing_seconds_max: 60.0,
};
