//! Reasons for which a video or a camera gives no frames.

use std::io;

use crate::ffmpeg::process::Failure;

/// A reason for which a video or a camera gives no frames, and what to do.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct VideoError(pub(super) String);

impl VideoError {
    pub(super) fn of(name: &str, failure: Failure) -> Self {
        match failure {
            Failure::Missing => Self(format!("{name} needs ffmpeg, which is not installed: install ffmpeg")),
            Failure::Start(error) => Self::unreadable(name, &error),
            Failure::Refused(what) | Failure::Useless(what) => Self::damaged(name, &what),
        }
    }

    pub(super) fn unreadable(name: &str, error: &io::Error) -> Self {
        Self(format!("the video {name} cannot be read ({error}): check that the file is still there"))
    }

    /// The error of a video that gives no more frames. `what` is the message of ffmpeg.
    pub(super) fn damaged(name: &str, what: &str) -> Self {
        Self(format!("{name} gives no picture ({what}): check it in another player, or convert it"))
    }
}
