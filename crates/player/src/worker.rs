//! A thread with a time-limited join.

use std::io;
use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError, channel};
use std::thread::{Builder, JoinHandle, Thread};
use std::time::Duration;

pub(crate) struct Worker {
    handle: Option<JoinHandle<()>>,
    done: Receiver<()>,
}

impl Worker {
    pub(crate) fn spawn(name: &str, work: impl FnOnce() + Send + 'static) -> io::Result<Self> {
        let (at_end, done) = channel();
        let handle = Builder::new().name(name.into()).spawn(move || {
            // This drops `at_end` when the work returns or panics.
            let _at_end = at_end;
            work();
        })?;
        Ok(Self { handle: Some(handle), done })
    }

    pub(crate) fn wake(&self) {
        if let Some(handle) = &self.handle {
            handle.thread().unpark();
        }
    }

    pub(crate) fn thread(&self) -> Option<&Thread> {
        self.handle.as_ref().map(JoinHandle::thread)
    }

    pub(crate) fn has_ended(&self) -> bool {
        matches!(self.done.try_recv(), Err(TryRecvError::Disconnected))
    }

    /// Waits at most `limit` for the thread's end, and returns true if it ended. Otherwise the thread is detached.
    pub(crate) fn join_within(&mut self, limit: Duration) -> bool {
        let ended = matches!(self.done.recv_timeout(limit), Err(RecvTimeoutError::Disconnected));
        if let Some(handle) = self.handle.take().filter(|_| ended)
            && handle.join().is_err()
        {
            tracing::error!("a playback thread panicked");
        }
        ended
    }
}

// The priority of threads that work ahead.

/// Lowers the priority of the calling thread: 0 is normal, 19 the lowest. Without effect where the system offers no
/// priorities.
#[cfg(target_os = "linux")]
pub fn lower_priority(niceness: i32) {
    if let Err(error) = rustix::process::setpriority_process(None, niceness) {
        tracing::debug!("the priority of a thread cannot be changed: {error}");
    }
}

/// Lowers the priority of the calling thread: 0 is normal, 19 the lowest. Without effect where the system offers no
/// priorities.
#[cfg(not(target_os = "linux"))]
pub fn lower_priority(_: i32) {}
