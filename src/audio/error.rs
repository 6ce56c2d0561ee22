//! What can go wrong with playback. Each message says what happened and what to do.

use thiserror::Error;

/// Why a song cannot be played at all.
#[derive(Debug, Error)]
pub enum PlayerError {
    /// The source's sample rate is beyond what the program takes.
    #[error(
        "the sound has {rate} samples per second, but only {min} to {max} are supported; convert it, for example to 48000"
    )]
    SampleRate {
        /// The source's rate, in hertz.
        rate: u32,
        /// Lowest rate taken, in hertz.
        min: u32,
        /// Highest rate taken, in hertz.
        max: u32,
    },
    /// A thread could not be started.
    #[error("playback could not start a thread ({0}); close other programs and try again")]
    Thread(#[from] std::io::Error),
}

/// Why there is no sound from a device. The song then runs on the silent clock.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum OutputError {
    /// Nothing to play on.
    #[error(
        "there is no sound output device; connect one or start the sound server, then start the program again"
    )]
    NoDevice,
    /// The device asked for is not there.
    #[error("there is no sound output called '{0}'; 'mariana devices' lists those that are there")]
    UnknownDevice(String),
    /// Another program holds the device.
    #[error(
        "the sound output {device} is busy; close the program that uses it or choose another with --device"
    )]
    Busy {
        /// The device's name.
        device: String,
    },
    /// The device takes none of the sample formats that can be produced.
    #[error(
        "the sound output {device} takes only {format} samples, which are not supported; choose another with --device"
    )]
    Format {
        /// The device's name.
        device: String,
        /// What it takes.
        format: String,
    },
    /// The device could not be opened.
    #[error("the sound output {device} could not be opened ({reason}); choose another with --device")]
    Open {
        /// The device's name.
        device: String,
        /// What the system said.
        reason: String,
    },
    /// Opening took too long.
    #[error(
        "the sound system did not answer within {seconds} s; restart it or choose another output with --device"
    )]
    Timeout {
        /// How long was waited.
        seconds: u64,
    },
    /// The device reported a failure while playing.
    #[error("the sound output failed while playing ({0}); check the device or the sound server")]
    Lost(String),
    /// The device stopped asking for samples.
    #[error("the sound output stopped asking for samples; check the device or the sound server")]
    Stalled,
}
