//! Devices of a PulseAudio server of the test's own.

mod device_changes;
mod playback_pulse;
mod tone;
