//! Errors of playback. Each message says what happened and what to do.

use mariana_music::limits as music_limits;
use thiserror::Error;

/// The error that prevents playback altogether: a thread could not be started.
#[derive(Debug, Error)]
#[error("playback could not start a thread ({0}); close other programs and try again")]
pub struct PlayerError(std::io::Error);

impl From<std::io::Error> for PlayerError {
    // This is not `#[from]`: the message contains the error already, and error sources are printed after the message.
    fn from(error: std::io::Error) -> Self {
        Self(error)
    }
}

/// The direction of sound through a device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Playback.
    Output,
    /// Recording.
    Input,
}

impl std::fmt::Display for Direction {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Direction::Output => "output",
            Direction::Input => "input",
        })
    }
}

/// The reasons why no sound goes through a device of a direction. The show then continues in silence.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum DeviceError {
    /// No output or input device exists.
    #[error("there is no sound {0} device; connect a device or start the sound server")]
    NoDevice(Direction),
    /// The device with the requested name does not exist.
    #[error(
        "there is no sound {0} called '{1}'; 'mariana devices' lists the available devices, and '{1}' is used as soon \
         as it appears"
    )]
    UnknownDevice(Direction, String),
    /// The device with this name was disconnected.
    #[error("the sound {0} '{1}' is gone; connect it again, or choose another device with --device")]
    Gone(Direction, String),
    /// The computer's own sound cannot be recorded on this system.
    #[error(
        "the computer's own sound can only be captured through PulseAudio or PipeWire, and neither answers; \
         install and start one of them (the package is pipewire-pulse or pulseaudio), or use --mic"
    )]
    NoLoopback,
    /// Another program holds the named device.
    #[error(
        "the sound {0} {1} is busy; close the program that uses it or choose another device with --device"
    )]
    Busy(Direction, String),
    /// The system denies access to the named device.
    #[error(
        "the system denies access to the sound {0} {1}; allow access in the privacy settings, or add your user to \
         the group 'audio'"
    )]
    Denied(Direction, String),
    /// The program supports none of the sample formats that the named device offers.
    #[error(
        "the sound {0} {1} offers only {2} samples, which are not supported; choose another device with --device"
    )]
    Format(Direction, String, String),
    /// The sample rate of the named device, in hertz, is out of range.
    #[error(
        "the sound {0} {1} runs at {2} samples per second, but only {min} to {max} are supported; choose another \
         device with --device",
        min = music_limits::SAMPLE_RATE_MIN,
        max = music_limits::SAMPLE_RATE_MAX
    )]
    Rate(Direction, String, u32),
    /// The named device could not be opened, with the system's error message.
    #[error("the sound {0} {1} could not be opened ({2}); choose another device with --device")]
    Open(Direction, String, String),
    /// Opening the device took longer than this number of seconds.
    #[error(
        "the sound {0} did not answer within {1} s; restart the sound server or choose another device with --device"
    )]
    Timeout(Direction, u64),
    /// The device reported a failure while it was running, with the system's error message.
    #[error("the sound {0} failed ({1}); check the device or the sound server")]
    Lost(Direction, String),
    /// The device stopped requesting or delivering samples.
    #[error("the sound {0} has stalled; check the device or the sound server")]
    Stalled(Direction),
    /// No thread could be started, with the system's error message.
    #[error("no thread could be started for the sound {0} ({1}); close other programs")]
    Thread(Direction, String),
}
