//! Why a stream could not be opened or decoded any further.

use std::path::PathBuf;

/// What went wrong with a file or stream. Every message is one sentence: what, where, what to do.
///
/// A malformed input is [`NotAudio`](Self::NotAudio) or [`Damaged`](Self::Damaged), an unsupported one
/// [`UnsupportedFormat`](Self::UnsupportedFormat), [`UnsupportedCodec`](Self::UnsupportedCodec),
/// [`NeedsFfmpeg`](Self::NeedsFfmpeg) or
/// [`NoAudioTrack`](Self::NoAudioTrack), and one past a ceiling of [`crate::limits`]
/// [`OverLimit`](Self::OverLimit).
#[derive(Debug, thiserror::Error)]
pub enum DecodeError {
    /// Nothing is at the path.
    #[error("{} does not exist; check the spelling of the path", .path.display())]
    NotFound {
        /// The path as given.
        path: PathBuf,
    },
    /// The path is a folder.
    #[error("{} is a folder; name an audio file in it", .path.display())]
    IsFolder {
        /// The path as given.
        path: PathBuf,
    },
    /// The path is a pipe, a socket or a device.
    #[error("{} is not a regular file; save the sound to a file first", .path.display())]
    NotAFile {
        /// The path as given.
        path: PathBuf,
    },
    /// The file may not be read by this user.
    #[error("{} cannot be read by this user; change its permissions", .path.display())]
    NoPermission {
        /// The path as given.
        path: PathBuf,
    },
    /// The file has no bytes.
    #[error("{name} is empty; fetch or export the file again")]
    Empty {
        /// The file's name.
        name: String,
    },
    /// The disk or the network failed.
    #[error("{name} could not be read ({reason}); check the disk or the network share")]
    Read {
        /// The file's name.
        name: String,
        /// The system's reason. (Not a source: the sentence contains it, and sources are printed after the sentence.)
        reason: std::io::Error,
    },
    /// The bytes are not sound, or not in a form that can be recognised.
    #[error(
        "{name} is not an audio file: {what}; choose a wav, aiff, flac, mp3, ogg, opus, m4a, caf, mkv or webm file"
    )]
    NotAudio {
        /// The file's name.
        name: String,
        /// What was seen instead.
        what: String,
    },
    /// The container is known but not supported here.
    #[error("{name} is {what}, which is not supported; convert it, for example to flac")]
    UnsupportedFormat {
        /// The file's name.
        name: String,
        /// The container.
        what: String,
    },
    /// The container can be read, but its content cannot be decoded.
    #[error("{name} holds sound in {codec}, which cannot be decoded; convert it, for example to flac")]
    UnsupportedCodec {
        /// The file's name.
        name: String,
        /// The codec or the part of it that is missing.
        codec: String,
    },
    /// Only ffmpeg decodes it, and that is not installed.
    #[error(
        "{name} {what}, which is decoded by ffmpeg, and that is not installed; install ffmpeg, or convert the file, for example to flac"
    )]
    NeedsFfmpeg {
        /// The file's name.
        name: String,
        /// What it is or holds, after its name.
        what: String,
    },
    /// There is no sound in the container.
    #[error("{name} has no audio track; choose a file with sound")]
    NoAudioTrack {
        /// The file's name.
        name: String,
    },
    /// Recognised, but not decodable.
    #[error("{name} is damaged: {what}; fetch or export the file again")]
    Damaged {
        /// The file's name.
        name: String,
        /// What failed.
        what: String,
    },
    /// More than [`crate::limits::LIMITS`] allow.
    #[error("{name} has {what}, but the limit is {limit}; convert the file to stay within it")]
    OverLimit {
        /// The file's name.
        name: String,
        /// What was found, with its number.
        what: String,
        /// The limit, with its unit.
        limit: String,
    },
    /// The codec library failed in an unforeseen way and was stopped.
    #[error("{name} made the decoder fail ({what}); the file is probably damaged: fetch or export it again")]
    CodecFailure {
        /// The file's name.
        name: String,
        /// The library's own message.
        what: String,
    },
}

impl DecodeError {
    /// Whether the sound is in a form that is not decoded here: something else may decode it.
    pub(super) fn is_unsupported(&self) -> bool {
        matches!(self, Self::UnsupportedFormat { .. } | Self::UnsupportedCodec { .. })
    }
}
