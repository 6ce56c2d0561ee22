//! Sends the window's frames to other programs. Each program has a thread that takes the latest frame, so slow
//! programs skip frames.
//!
//! **A receiver never blocks the show.** The show puts a frame into a mailbox ([`LatestFrame`]) and continues. Each
//! time a receiver blocks, disconnects or comes back, [`Sending::news`] has one message about it.

mod latest_frame;
mod mjpeg;
mod stream;
mod target;
#[cfg(target_os = "linux")]
mod v4l2;

use std::sync::Arc;

use latest_frame::LatestFrame;
pub use latest_frame::OutgoingFrame;
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
    latest_frame: Arc<LatestFrame>,
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
        match target {
            SenderTarget::Y4m(None) => {
                stream::start(stream::Standard::new(size, fps), fps, latest_frame.clone())?
            }
            SenderTarget::Y4m(Some(path)) => {
                stream::start(stream::Fifo::new(path, size, fps)?, fps, latest_frame.clone())?;
            }
            SenderTarget::V4l2(path) => start_v4l2(path, size, fps, latest_frame.clone())?,
            SenderTarget::Mjpeg(port) => mjpeg::start(*port, latest_frame.clone())?,
        }
        Ok(Self { latest_frame, target: target.clone() })
    }

    /// Replaces the frame that is sent.
    pub fn offer(&self, picture: OutgoingFrame) {
        self.latest_frame.put(picture);
    }

    /// True if a receiver is connected, or no frame has been offered yet.
    pub fn is_wanted(&self) -> bool {
        self.latest_frame.is_wanted()
    }

    /// Returns the messages about receivers since the last call.
    pub fn news(&self) -> Vec<String> {
        self.latest_frame.news()
    }
}

impl Drop for Sending {
    fn drop(&mut self) {
        // Do not wait for the thread: a receiver may block it.
        self.latest_frame.end();
    }
}

#[cfg(target_os = "linux")]
fn start_v4l2(
    path: &std::path::Path,
    size: (u32, u32),
    fps: f64,
    latest_frame: Arc<LatestFrame>,
) -> Result<(), SendError> {
    stream::start(v4l2::Camera::open(path, size)?, fps, latest_frame)
}

#[cfg(not(target_os = "linux"))]
fn start_v4l2(
    path: &std::path::Path,
    _size: (u32, u32),
    _fps: f64,
    _newest: Arc<LatestFrame>,
) -> Result<(), SendError> {
    let reason = "only Linux has such devices: send MJPEG instead".to_owned();
    Err(SendError::Refused { to: path.display().to_string(), reason })
}
