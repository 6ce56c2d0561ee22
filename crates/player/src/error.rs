//! Errors of playback. Each message says what happened and what to do.

use mariana_music::limits as music_limits;
use thiserror::Error;

/// The errors that prevent playback altogether.
#[derive(Debug, Error)]
pub enum PlayerError {
    /// The source's sample rate, in hertz, is out of range.
    #[error(
        "the sound has {0} samples per second, but only {min} to {max} are supported; convert the \
         file, for example to 48000 samples per second",
        min = music_limits::SAMPLE_RATE_MIN,
        max = music_limits::SAMPLE_RATE_MAX
    )]
    SampleRate(u32),
    /// A thread could not be started.
    #[error("playback could not start a thread ({0}); close other programs and try again")]
    Thread(std::io::Error),
}

impl From<std::io::Error> for PlayerError {
    // This is not `#[from]`: the message contains the error already, and error sources are printed after the message.
    fn from(error: std::io::Error) -> Self {
        Self::Thread(error)
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

/// The reasons why no sound goes through a device. The show then continues in silence.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum DeviceError {
    /// No output or input device exists.
    #[error("there is no sound {0} device; connect a device or start the sound server")]
    NoDevice(Direction),
    /// The requested device does not exist.
    #[error(
        "there is no sound {direction} called '{name}'; 'mariana devices' lists the available devices, and \
         '{name}' is used as soon as it appears"
    )]
    UnknownDevice {
        /// The direction of the sound.
        direction: Direction,
        /// The requested name.
        name: String,
    },
    /// The device was disconnected.
    #[error(
        "the sound {direction} '{name}' is gone; connect it again, or choose another device with --device"
    )]
    Gone {
        /// The direction of the sound.
        direction: Direction,
        /// The device's name.
        name: String,
    },
    /// The computer's own sound cannot be recorded on this system.
    #[error(
        "the computer's own sound can only be captured through PulseAudio or PipeWire, and neither answers; \
         install and start one of them (the package is pipewire-pulse or pulseaudio), or use --mic"
    )]
    NoLoopback,
    /// Another program holds the device.
    #[error(
        "the sound {direction} {device} is busy; close the program that uses it or choose another device with --device"
    )]
    Busy {
        /// The direction of the sound.
        direction: Direction,
        /// The device's name.
        device: String,
    },
    /// The system denies access to the device.
    #[error(
        "the system denies access to the sound {direction} {device}; allow access in the privacy settings, or add \
         your user to the group 'audio'"
    )]
    Denied {
        /// The direction of the sound.
        direction: Direction,
        /// The device's name.
        device: String,
    },
    /// The program supports none of the device's sample formats.
    #[error(
        "the sound {direction} {device} offers only {format} samples, which are not supported; choose another \
         device with --device"
    )]
    Format {
        /// The direction of the sound.
        direction: Direction,
        /// The device's name.
        device: String,
        /// The formats that the device offers.
        format: String,
    },
    /// The device's sample rate is out of range.
    #[error(
        "the sound {direction} {device} runs at {rate} samples per second, but only {} to {} are supported; choose \
         another device with --device",
        music_limits::SAMPLE_RATE_MIN,
        music_limits::SAMPLE_RATE_MAX
    )]
    Rate {
        /// The direction of the sound.
        direction: Direction,
        /// The device's name.
        device: String,
        /// The device's rate, in hertz.
        rate: u32,
    },
    /// The device could not be opened.
    #[error(
        "the sound {direction} {device} could not be opened ({reason}); choose another device with --device"
    )]
    Open {
        /// The direction of the sound.
        direction: Direction,
        /// The device's name.
        device: String,
        /// The system's error message.
        reason: String,
    },
    /// Opening the device took too long.
    #[error(
        "the sound {direction} did not answer within {seconds} s; restart the sound server or choose \
         another device with --device"
    )]
    Timeout {
        /// The direction of the sound.
        direction: Direction,
        /// The time that the program waited.
        seconds: u64,
    },
    /// The device reported a failure while it was running.
    #[error("the sound {direction} failed ({reason}); check the device or the sound server")]
    Lost {
        /// The direction of the sound.
        direction: Direction,
        /// The system's error message.
        reason: String,
    },
    /// The device stopped requesting or delivering samples.
    #[error("the sound {0} has stalled; check the device or the sound server")]
    Stalled(Direction),
    /// No thread could be started.
    #[error("no thread could be started for the sound {direction} ({reason}); close other programs")]
    Thread {
        /// The direction of the sound.
        direction: Direction,
        /// The system's error message.
        reason: String,
    },
}
