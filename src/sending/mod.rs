//! Sends the window's frames to other programs. Each program has a thread that takes the latest frame, so slow
//! programs skip frames.
//!
//! **A receiver never blocks the show.** The show puts a frame into a mailbox ([`LatestFrame`]) and continues. Each
//! time a receiver blocks, disconnects or comes back, [`LatestFrame::news`] has one message about it.

mod latest_frame;
mod mjpeg;
mod stream;
mod target;
#[cfg(target_os = "linux")]
mod v4l2;

use std::sync::Arc;

pub use latest_frame::{LatestFrame, OutgoingFrame};
pub use target::SenderTarget;

/// Errors of starting to send.
#[derive(Debug, thiserror::Error)]
pub enum SendError {
    /// The target does not exist, or is of the wrong kind.
    #[error("frames cannot be sent to {to}: {reason}")]
    Refused {
        /// The target.
        to: String,
        /// The reason, and what to do.
        reason: String,
    },
    /// The system cannot start a thread.
    #[error(
        "frames cannot be sent, because the system cannot start another thread ({0}): close other programs"
    )]
    Thread(std::io::Error),
}

/// Sends frames to a target until it is dropped.
pub struct Sending {
    /// The mailbox, which also has the messages about receivers.
    pub latest_frame: Arc<LatestFrame>,
    /// Where the frames go.
    pub target: SenderTarget,
}

impl Sending {
    /// Sends frames of `size` pixels (both even) `fps` times a second. Returns at once: a receiver may connect later.
    ///
    /// # Errors
    /// [`SendError`]
    pub fn start(target: &SenderTarget, size: (u32, u32), fps: f64) -> Result<Self, SendError> {
        let latest_frame = Arc::new(LatestFrame::new(target.to_string()));
        let start = |receiver| stream::start(receiver, fps, latest_frame.clone());
        match target {
            SenderTarget::Y4m(None) => start(stream::standard(size, fps))?,
            SenderTarget::Y4m(Some(path)) => start(stream::fifo(path, size, fps)?)?,
            #[cfg(target_os = "linux")]
            SenderTarget::V4l2(path) => start(v4l2::camera(path, size)?)?,
            #[cfg(not(target_os = "linux"))]
            SenderTarget::V4l2(path) => {
                let reason = "only Linux has such devices: send MJPEG instead".to_owned();
                return Err(SendError::Refused { to: path.display().to_string(), reason });
            }
            SenderTarget::Mjpeg(port) => mjpeg::start(*port, latest_frame.clone())?,
        }
        Ok(Self { latest_frame, target: target.clone() })
    }
}

impl Drop for Sending {
    fn drop(&mut self) {
        // Do not wait for the thread: a receiver may block it.
        self.latest_frame.end();
    }
}
