//! Tests with devices of a separate PulseAudio server.

mod device_changes;
mod playback_pulse;
mod tone;
