//! Keeps C libraries from printing over the user's terminal: ALSA's jack plugin reports a missing server with a
//! dozen lines on standard error, past every error handler that ALSA offers.

use std::fs::OpenOptions;
use std::os::fd::OwnedFd;

/// While this lives, what the process writes to standard error is discarded.
pub(super) struct QuietStderr {
    saved: OwnedFd,
}

impl QuietStderr {
    /// None if standard error cannot be redirected; then it stays as it is.
    pub(super) fn new() -> Option<Self> {
        let saved = rustix::io::dup(rustix::stdio::stderr()).ok()?;
        let nowhere = OpenOptions::new().write(true).open("/dev/null").ok()?;
        rustix::stdio::dup2_stderr(&nowhere).ok()?;
        Some(Self { saved })
    }
}

impl Drop for QuietStderr {
    fn drop(&mut self) {
        // It was standard error before, so this cannot fail.
        let _ = rustix::stdio::dup2_stderr(&self.saved);
    }
}
