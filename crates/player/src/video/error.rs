//! Reasons for which a video or a camera gives no frames.

use std::io;

use crate::ffmpeg::process::Failure;

/// A reason for which a video or a camera gives no frames. `name` is the name in messages.
#[derive(Debug, thiserror::Error)]
pub enum VideoError {
    /// The file cannot be read.
    #[error("the video {name} cannot be read ({reason}): check that the file is still there")]
    Unreadable {
        /// The video.
        name: String,
        /// The system's reason.
        reason: io::Error,
    },
    /// ffmpeg or ffprobe is not installed.
    #[error("{0} needs ffmpeg, which is not installed: install ffmpeg")]
    NeedsFfmpeg(String),
    /// The file has no video stream, or no frames.
    #[error("{name} has no moving picture ({what}): choose a video")]
    NoVideo {
        /// The file.
        name: String,
        /// A description of what is missing.
        what: String,
    },
    /// The frames are too large to decode.
    #[error("{name} has {width} x {height} pixels, more than {max} on a side: convert it to a smaller size")]
    TooLarge {
        /// The file.
        name: String,
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
        /// The limit on both.
        max: u32,
    },
    /// ffmpeg reports an error, or gives no data.
    #[error("{name} gives no picture ({what}): check it in another player, or convert it")]
    Damaged {
        /// The video.
        name: String,
        /// ffmpeg's message.
        what: String,
    },
    /// No camera has this number.
    #[error("there is no camera {0}: check that it is plugged in")]
    NoCamera(usize),
    /// The camera gives no frames.
    #[error("{name} gives no picture ({what}): check its cable, and that no other program uses it")]
    Camera {
        /// The camera.
        name: String,
        /// ffmpeg's message.
        what: String,
    },
}

impl VideoError {
    pub(super) fn of(name: &str, failure: Failure) -> Self {
        let name = name.to_owned();
        match failure {
            Failure::Missing => Self::NeedsFfmpeg(name),
            Failure::Start(reason) => Self::Unreadable { name, reason },
            Failure::Refused(what) | Failure::Useless(what) => Self::Damaged { name, what },
        }
    }
}
