//! The picture of the window for other programs: each send has a thread of its own, which always has the newest picture
//! and leaves out what its receiver is too slow for.
//!
//! **A receiver never holds the show.** The show leaves a picture in a mailbox ([`LatestFrame`]) and goes on. A receiver that
//! blocks, goes away or comes back costs one sentence each time ([`Sending::news`]).

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

/// Why pictures cannot be sent.
#[derive(Debug, thiserror::Error)]
pub enum SendError {
    /// Nothing can be opened under this name, or it is of the wrong kind.
    #[error("pictures cannot be sent to {to}: {reason}")]
    Refused {
        /// Where to.
        to: String,
        /// Why, and what to do.
        reason: String,
    },
    /// The system gives no thread.
    #[error(
        "pictures cannot be sent, because the system cannot start another thread ({0}): close other programs"
    )]
    Thread(std::io::Error),
}

/// A send that goes on until this is dropped.
pub struct Sending {
    latest_frame: Arc<LatestFrame>,
    target: SenderTarget,
}

impl Sending {
    /// Begins to send pictures of `size` pixels, both even, `fps` times a second. Returns at once: a receiver may come
    /// later.
    ///
    /// # Errors
    /// [`SendError`], each with what to do.
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

    /// Where it sends to.
    pub fn target(&self) -> &SenderTarget {
        &self.target
    }

    /// Sends this picture from now on.
    pub fn offer(&self, picture: OutgoingFrame) {
        self.latest_frame.put(picture);
    }

    /// Whether somebody takes pictures, or waits for the first.
    pub fn is_wanted(&self) -> bool {
        self.latest_frame.is_wanted()
    }

    /// What there is to say of the receiver since the last call.
    pub fn news(&self) -> Vec<String> {
        self.latest_frame.news()
    }
}

impl Drop for Sending {
    fn drop(&mut self) {
        // A thread that a receiver blocks is left behind: the program's end does not wait for it.
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
    let reason = "only Linux has such devices; send MJPEG instead".to_owned();
    Err(SendError::Refused { to: path.display().to_string(), reason })
}
