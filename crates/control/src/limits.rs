//! All limits of this crate. Code, error messages and tests read them from here.

use std::time::Duration;

/// The maximum length of a parameter, scene or action name, in bytes.
pub const NAME_BYTES_MAX: usize = 256;
/// The maximum number of parameters changed between two frames; changes of other parameters are rejected.
pub const PENDING_PARAMS_MAX: usize = 512;
/// The maximum number of actions between two frames; later actions are rejected.
pub const PENDING_ACTIONS_MAX: usize = 64;
/// The maximum number of bundles and messages in one OSC packet; the rest is ignored.
pub const OSC_ELEMENTS_MAX: usize = 1_024;
/// The maximum nesting depth of OSC bundles.
pub const OSC_DEPTH_MAX: usize = 8;
/// The maximum number of arguments of an OSC message.
pub const OSC_ARGUMENTS_MAX: usize = 64;
/// The maximum number of answers to one packet.
pub const OSC_ANSWERS_MAX: usize = 1_024;
/// The maximum number of addresses that a pattern matches; the rest is ignored.
pub const OSC_MATCHES_MAX: usize = 256;
/// The maximum time that a bundle may be scheduled ahead, in seconds.
pub const OSC_AHEAD_SECONDS_MAX: f64 = 60.0;
/// The maximum number of scheduled messages; later messages are rejected.
pub const OSC_WAITING_MAX: usize = 1_024;
/// The interval between two attempts to open a port.
pub const PORT_RETRY: Duration = Duration::from_secs(1);
/// The minimum rate at which OSC is sent, in packets a second.
pub const OSC_RATE_MIN: f64 = 1.0;
/// The maximum rate at which OSC is sent, in packets a second.
pub const OSC_RATE_MAX: f64 = 240.0;
/// The maximum number of knobs moved between two frames; movements of other knobs are rejected.
pub const MOVED_KNOBS_MAX: usize = 4_096;
/// The maximum number of presses counted for one key or button between two frames.
pub const PRESSES_MAX: u32 = 8;
/// The maximum number of MIDI devices open at the same time.
pub const MIDI_DEVICES_MAX: usize = 32;
/// The maximum number of knob mappings.
pub const MAPPINGS_MAX: usize = 1_000;
/// The maximum size of a mapping file, in bytes.
pub const MAPPING_BYTES_MAX: usize = 1 << 20;
/// The maximum smoothing time, in seconds.
pub const SMOOTHING_SECONDS_MAX: f32 = 60.0;
