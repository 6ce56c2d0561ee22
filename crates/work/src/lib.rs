//! Background threads of four kinds: [`once`] computes one answer, [`in_order`] carries out all orders one after the
//! other, [`latest`] takes its next job from a state in which the owner replaces what it no longer wants, and [`looping`]
//! runs its own loop on a state that it shares with the owner.
//!
//! The owner never waits for a thread unless it asks to. A panic is logged with the name of the thread, and never hangs
//! the owner. A thread ends when its owner is dropped, after the job at hand.

use std::convert::Infallible;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::{Builder, JoinHandle, Thread, current};
use std::time::Duration;

mod in_order;
mod latest;

pub use in_order::{Worker, in_order};
pub use latest::{Latest, Shared, latest, looping};

/// A thread that runs its own loop. Dropping this leaves the thread alone, or waits for its end
/// ([`Background::finished_at_drop`]).
#[derive(Debug)]
pub struct Background {
    handle: Option<JoinHandle<()>>,
    end: Mutex<Receiver<Infallible>>,
    /// How long dropping this waits for the end.
    wait: Duration,
}

/// Returns the result of `work`. A panic is logged with the name of the thread and returns `None`.
pub fn contained<T>(work: impl FnOnce() -> T) -> Option<T> {
    let done = catch_unwind(AssertUnwindSafe(work)).ok();
    if done.is_none() {
        let thread = current();
        let name = thread.name().unwrap_or_default();
        tracing::error!("the thread '{name}' panicked: this is a bug in Mariana");
    }
    done
}

/// Locks `mutex` even after a panic: the data must be valid between any two changes.
pub fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Default for Background {
    /// A thread that has ended.
    fn default() -> Self {
        Self { handle: None, end: Mutex::new(channel().1), wait: Duration::ZERO }
    }
}

impl Background {
    /// Starts a thread that runs its own loop.
    ///
    /// # Errors
    /// Fails if the system cannot start a thread.
    pub fn start(name: &str, work: impl FnOnce() + Send + 'static) -> io::Result<Self> {
        let (at_end, end) = channel();
        let handle = Builder::new().name(name.into()).spawn(move || {
            let _at_end = at_end;
            let _ = contained(work);
        })?;
        Ok(Self { handle: Some(handle), end: Mutex::new(end), wait: Duration::ZERO })
    }

    /// Returns the thread, to unpark it; `None` after [`Background::finish`].
    pub fn thread(&self) -> Option<&Thread> {
        self.handle.as_ref().map(JoinHandle::thread)
    }

    /// Dropping this waits at most `limit` for the thread's end.
    #[must_use]
    pub fn finished_at_drop(mut self, limit: Duration) -> Self {
        self.wait = limit;
        self
    }

    /// True once the thread has ended.
    pub fn has_ended(&self) -> bool {
        matches!(lock(&self.end).try_recv(), Err(TryRecvError::Disconnected))
    }

    /// Waits at most `limit` for the thread's end, and returns true if it ended. Otherwise the thread is left alone.
    pub fn finish(&mut self, limit: Duration) -> bool {
        let ended = matches!(lock(&self.end).recv_timeout(limit), Err(RecvTimeoutError::Disconnected));
        // Panics are already reported.
        self.handle.take().filter(|_| ended).map(JoinHandle::join);
        ended
    }
}

impl Drop for Background {
    fn drop(&mut self) {
        let thread = self.thread().cloned().filter(|_| !self.wait.is_zero());
        if let Some(thread) = thread
            && !self.finish(self.wait)
        {
            tracing::warn!(
                "the thread '{}' does not stop and is abandoned",
                thread.name().unwrap_or_default()
            );
        }
    }
}

/// The answer of a thread that [`once`] has started. The default has no thread and no answer.
#[derive(Debug)]
pub struct Awaited<T>(Option<(Receiver<T>, Background)>);

/// The error of an [`Awaited`] that will not come, because the thread panicked.
pub const NO_ANSWER: &str = "the work ended without an answer";

/// Starts a thread that computes one answer and calls `wake` afterwards.
///
/// # Errors
/// Fails if the system cannot start a thread.
pub fn once<T: Send + 'static>(
    name: &str,
    wake: impl FnOnce() + Send + 'static,
    work: impl FnOnce() -> T + Send + 'static,
) -> io::Result<Awaited<T>> {
    let (tell, answer) = channel();
    let background = Background::start(name, move || {
        // The owner may be gone.
        let _ = contained(work).map(|found| tell.send(found));
        drop(tell);
        wake();
    })?;
    Ok(Awaited(Some((answer, background))))
}

impl<T> Default for Awaited<T> {
    fn default() -> Self {
        Self(None)
    }
}

impl<T> Awaited<T> {
    /// Returns the answer once, as soon as it has come.
    pub fn poll(&mut self) -> Option<Result<T, &'static str>> {
        self.within(Duration::ZERO)
    }

    /// Waits at most `limit` for the answer, and returns it once.
    pub fn within(&mut self, limit: Duration) -> Option<Result<T, &'static str>> {
        let answer = match self.0.as_ref()?.0.recv_timeout(limit) {
            Ok(answer) => Ok(answer),
            Err(RecvTimeoutError::Disconnected) => Err(NO_ANSWER),
            Err(RecvTimeoutError::Timeout) => return None,
        };
        self.0 = None;
        Some(answer)
    }

    /// True until the answer is returned.
    pub fn is_awaited(&self) -> bool {
        self.0.is_some()
    }
}

#[cfg(test)]
mod tests;
