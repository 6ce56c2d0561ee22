//! Errors of opening and decoding a stream.

use std::io::{self, ErrorKind};

use thiserror::Error;

/// An error of a file or stream. Each message is one sentence: what happened, where, and what to do.
#[derive(Debug, Error)]
#[error("{name} {problem}")]
pub struct DecodeError {
    /// The file's name, with its folders if the file could not be found.
    pub name: String,
    /// The rest of the sentence.
    pub problem: Problem,
}

/// A problem of a file or stream. Each message continues a sentence that begins with the file's name.
#[derive(Debug, Error)]
pub enum Problem {
    /// The path does not exist.
    #[error("does not exist; check the spelling of the path")]
    NotFound,
    /// The path is a folder.
    #[error("is a folder; name an audio file in it")]
    IsFolder,
    /// The path is a pipe, a socket or a device.
    #[error("is not a regular file; save the sound to a file first")]
    NotAFile,
    /// The user may not read the file.
    #[error("cannot be read by this user; change its permissions")]
    NoPermission,
    /// The file is empty.
    #[error("is empty; fetch or export the file again")]
    Empty,
    /// The disk or the network failed. The system's message is no error source: this message contains it already.
    #[error("could not be read ({0}); check the disk or the network share")]
    Read(io::Error),
    /// The bytes are not audio, or they are audio in an unknown form. The text describes the content.
    #[error(
        "is not an audio file: {0}; choose a wav, aiff, flac, mp3, ogg, opus, m4a, caf, mkv or webm file"
    )]
    NotAudio(String),
    /// The container is known but not supported. The text describes the container.
    #[error("is {0}, which is not supported; convert it, for example to flac")]
    UnsupportedFormat(String),
    /// The container can be read, but its codec, or a feature of the codec, is not supported.
    #[error("holds sound in {0}, which cannot be decoded; convert it, for example to flac")]
    UnsupportedCodec(String),
    /// The file needs ffmpeg, which is not installed. The text is the verb and the kind or the content of the file.
    #[error(
        "{0}, which needs ffmpeg, and ffmpeg is not installed; install it, or convert the file, for example to flac"
    )]
    NeedsFfmpeg(String),
    /// The container has no audio track.
    #[error("has no audio track; choose a file with sound")]
    NoAudioTrack,
    /// The container has no audio track with this number, from 1.
    #[error("has no audio track {0}; export the file again with all its tracks")]
    NoTrack(usize),
    /// The stream was recognised but cannot be decoded. The text describes the damage.
    #[error("is damaged: {0}; fetch or export the file again")]
    Damaged(String),
    /// The stream exceeds [`crate::limits`].
    #[error("has {what}, but the limit is {limit}; convert the file so that it stays within the limit")]
    OverLimit {
        /// A description of the excess, with its number.
        what: String,
        /// The limit, with its unit.
        limit: String,
    },
    /// The codec library panicked with this message and was contained.
    #[error("made the decoder fail ({0}); the file is probably damaged: fetch or export it again")]
    CodecFailure(String),
}

impl Problem {
    pub(super) fn of(self, name: &str) -> DecodeError {
        DecodeError { name: name.to_owned(), problem: self }
    }

    /// True if ffmpeg may decode the file.
    pub(super) fn is_for_ffmpeg(&self) -> bool {
        let is_misread = matches!(self, Self::Damaged(_) | Self::CodecFailure(_));
        let is_unknown = matches!(self, Self::NotAudio(_) | Self::NoAudioTrack);
        is_misread || is_unknown || self.is_unsupported()
    }

    pub(super) fn is_unsupported(&self) -> bool {
        matches!(self, Self::UnsupportedFormat(_) | Self::UnsupportedCodec(_))
    }
}

impl From<io::Error> for Problem {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            ErrorKind::NotFound | ErrorKind::NotADirectory => Self::NotFound,
            ErrorKind::PermissionDenied => Self::NoPermission,
            _ => Self::Read(error),
        }
    }
}
