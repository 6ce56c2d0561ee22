//! Prevents C libraries from printing to the user's terminal. ALSA's jack plugin reports a missing server with a dozen
//! lines on standard error and bypasses all of ALSA's error handlers.

use std::fs::OpenOptions;
use std::os::fd::OwnedFd;

/// Discards the process's standard error output until this value is dropped.
pub(super) struct QuietStderr {
    saved: OwnedFd,
}

impl QuietStderr {
    pub(super) fn new() -> Option<Self> {
        let saved = rustix::io::dup(rustix::stdio::stderr()).ok()?;
        let nowhere = OpenOptions::new().write(true).open("/dev/null").ok()?;
        rustix::stdio::dup2_stderr(&nowhere).ok()?;
        Some(Self { saved })
    }
}

impl Drop for QuietStderr {
    fn drop(&mut self) {
        // The saved descriptor was standard error, so this call cannot fail.
        let _ = rustix::stdio::dup2_stderr(&self.saved);
    }
}
