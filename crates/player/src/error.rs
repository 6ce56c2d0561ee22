//! What can go wrong with playback. Each message says what happened and what to do.

use mariana_music::limits::LIMITS as MUSIC_LIMITS;
use thiserror::Error;

/// Why a song cannot be played at all.
#[derive(Debug, Error)]
pub enum PlayerError {
    /// The source's sample rate is outside what the program accepts.
    #[error(
        "the sound has {rate} samples per second, but only {min} to {max} are supported; convert it, for example to 48000"
    )]
    SampleRate {
        /// The source's rate, in hertz.
        rate: u32,
        /// Lowest accepted rate, in hertz.
        min: u32,
        /// Highest accepted rate, in hertz.
        max: u32,
    },
    /// A thread could not be started.
    #[error("playback could not start a thread ({0}); close other programs and try again")]
    Thread(std::io::Error),
}

impl From<std::io::Error> for PlayerError {
    // Not as its source: the sentence contains it, and sources are printed after the sentence.
    fn from(error: std::io::Error) -> Self {
        Self::Thread(error)
    }
}

/// Which way sound goes through a device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// It is played.
    Output,
    /// It is recorded.
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

/// Why no sound goes through a device. The show then goes on in silence.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum DeviceError {
    /// There is no device to play on, or to listen to.
    #[error("there is no sound {0} device; connect one or start the sound server")]
    NoDevice(Direction),
    /// The device asked for is not there.
    #[error(
        "there is no sound {direction} called '{name}'; 'mariana devices' lists those that exist, and this one is used \
         as soon as it appears"
    )]
    UnknownDevice {
        /// Which way the sound should go.
        direction: Direction,
        /// What was asked for.
        name: String,
    },
    /// The device was there and no longer is.
    #[error("the sound {direction} '{name}' is gone; connect it again, or choose another with --device")]
    Gone {
        /// Which way the sound went.
        direction: Direction,
        /// The device's name.
        name: String,
    },
    /// What the computer plays cannot be recorded here.
    #[error(
        "what the computer plays can only be heard through PulseAudio or PipeWire, and neither answers; install and \
         start one (the package is pipewire-pulse or pulseaudio), or use --mic"
    )]
    NoLoopback,
    /// Another program holds the device.
    #[error(
        "the sound {direction} {device} is busy; close the program that uses it or choose another with --device"
    )]
    Busy {
        /// Which way the sound should go.
        direction: Direction,
        /// The device's name.
        device: String,
    },
    /// The system does not permit it.
    #[error(
        "the system denies access to the sound {direction} {device}; allow it in the privacy settings, or add your user to \
         the group 'audio'"
    )]
    Denied {
        /// Which way the sound should go.
        direction: Direction,
        /// The device's name.
        device: String,
    },
    /// The device supports none of the sample formats that the program understands.
    #[error(
        "the sound {direction} {device} offers only {format} samples, which are not supported; choose another with \
         --device"
    )]
    Format {
        /// Which way the sound should go.
        direction: Direction,
        /// The device's name.
        device: String,
        /// What it has.
        format: String,
    },
    /// The device's rate is beyond the limits.
    #[error(
        "the sound {direction} {device} runs at {rate} samples per second, but only {} to {} are supported; choose \
         another with --device", MUSIC_LIMITS.sample_rate_min, MUSIC_LIMITS.sample_rate_max
    )]
    Rate {
        /// Which way the sound should go.
        direction: Direction,
        /// The device's name.
        device: String,
        /// Its rate, in hertz.
        rate: u32,
    },
    /// The device could not be opened.
    #[error("the sound {direction} {device} could not be opened ({reason}); choose another with --device")]
    Open {
        /// Which way the sound should go.
        direction: Direction,
        /// The device's name.
        device: String,
        /// What the system said.
        reason: String,
    },
    /// Opening took too long.
    #[error(
        "the sound {direction} did not answer within {seconds} s; restart the sound server or choose another with --device"
    )]
    Timeout {
        /// Which way the sound should go.
        direction: Direction,
        /// How long the program waited.
        seconds: u64,
    },
    /// The device reported a failure while it ran.
    #[error("the sound {direction} failed ({reason}); check the device or the sound server")]
    Lost {
        /// Which way the sound went.
        direction: Direction,
        /// What the system said.
        reason: String,
    },
    /// The device stopped asking for samples, or delivering any.
    #[error("the sound {0} has stalled; check the device or the sound server")]
    Stalled(Direction),
    /// The system could not start a thread.
    #[error("no thread could be started for the sound {direction} ({reason}); close other programs")]
    Thread {
        /// Which way the sound should go.
        direction: Direction,
        /// What the system said.
        reason: String,
    },
}
