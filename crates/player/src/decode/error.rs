//! Errors of opening and decoding a stream.

use std::path::PathBuf;

/// An error of a file or stream. Each message is one sentence: what happened, where, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum DecodeError {
    /// The path does not exist.
    #[error("{} does not exist; check the spelling of the path", .0.display())]
    NotFound(PathBuf),
    /// The path is a folder.
    #[error("{} is a folder; name an audio file in it", .0.display())]
    IsFolder(PathBuf),
    /// The path is a pipe, a socket or a device.
    #[error("{} is not a regular file; save the sound to a file first", .0.display())]
    NotAFile(PathBuf),
    /// The user may not read the file.
    #[error("{} cannot be read by this user; change its permissions", .0.display())]
    NoPermission(PathBuf),
    /// The file is empty.
    #[error("{0} is empty; fetch or export the file again")]
    Empty(String),
    /// The disk or the network failed.
    #[error("{name} could not be read ({reason}); check the disk or the network share")]
    Read {
        /// The file's name.
        name: String,
        /// The system's message. The field is no error source, because the message above contains it already.
        reason: std::io::Error,
    },
    /// The bytes are not audio, or they are audio in an unknown form.
    #[error(
        "{name} is not an audio file: {what}; choose a wav, aiff, flac, mp3, ogg, opus, m4a, caf, mkv or webm file"
    )]
    NotAudio {
        /// The file's name.
        name: String,
        /// A description of the content.
        what: String,
    },
    /// The container is known but not supported.
    #[error("{name} is {what}, which is not supported; convert it, for example to flac")]
    UnsupportedFormat {
        /// The file's name.
        name: String,
        /// A description of the container.
        what: String,
    },
    /// The container can be read, but its codec is not supported.
    #[error("{name} holds sound in {codec}, which cannot be decoded; convert it, for example to flac")]
    UnsupportedCodec {
        /// The file's name.
        name: String,
        /// The codec or its missing feature.
        codec: String,
    },
    /// The file needs ffmpeg, which is not installed.
    #[error(
        "{name} {what}, which needs ffmpeg, and ffmpeg is not installed; install it, or convert the file, \
         for example to flac"
    )]
    NeedsFfmpeg {
        /// The file's name.
        name: String,
        /// The rest of the sentence after the name: the kind or the content of the file.
        what: String,
    },
    /// The container has no audio track.
    #[error("{0} has no audio track; choose a file with sound")]
    NoAudioTrack(String),
    /// The container has no audio track with this number.
    #[error("{name} has no audio track {number}; export the file again with all its tracks")]
    NoTrack {
        /// The file's name.
        name: String,
        /// The number, from 1.
        number: usize,
    },
    /// The stream was recognised but cannot be decoded.
    #[error("{name} is damaged: {what}; fetch or export the file again")]
    Damaged {
        /// The file's name.
        name: String,
        /// A description of the damage.
        what: String,
    },
    /// The stream exceeds [`crate::limits`].
    #[error(
        "{name} has {what}, but the limit is {limit}; convert the file so that it stays within the limit"
    )]
    OverLimit {
        /// The file's name.
        name: String,
        /// A description of the excess, with its number.
        what: String,
        /// The limit, with its unit.
        limit: String,
    },
    /// The codec library panicked and was contained.
    #[error("{name} made the decoder fail ({what}); the file is probably damaged: fetch or export it again")]
    CodecFailure {
        /// The file's name.
        name: String,
        /// The library's message.
        what: String,
    },
}

impl DecodeError {
    /// True if ffmpeg may decode the file.
    pub(super) fn is_for_ffmpeg(&self) -> bool {
        let is_misread = matches!(self, Self::Damaged { .. } | Self::CodecFailure { .. });
        let is_unknown = matches!(self, Self::NotAudio { .. } | Self::NoAudioTrack(_));
        is_misread || is_unknown || self.is_unsupported()
    }

    pub(super) fn is_unsupported(&self) -> bool {
        matches!(self, Self::UnsupportedFormat { .. } | Self::UnsupportedCodec { .. })
    }
}
