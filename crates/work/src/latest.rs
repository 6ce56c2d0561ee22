//! A thread that shares a state with its owner: it takes its next job from the state, so that only the latest requests
//! count, or runs its own loop.

use std::io;
use std::ops::Deref;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::Thread;
use std::time::Duration;

use super::{Background, contained, lock};

/// The state that a thread shares with its owner.
#[derive(Debug, Default)]
pub struct Shared<State> {
    state: Mutex<State>,
    changed: Condvar,
    is_over: AtomicBool,
}

/// The owner of a thread that [`latest`] or [`looping`] has started, which ends when this is dropped. The default has a
/// state, but no thread.
#[derive(Debug, Default)]
pub struct Latest<State> {
    shared: Arc<Shared<State>>,
    background: Background,
}

/// Starts a thread that takes jobs out of `state` with `next`, and passes each one to `work`. An `Option` as the state
/// is a request that a newer one replaces. A long job can look in the state whether it is still wanted, and must end
/// when [`Shared::is_over`]. A panic of one job is logged, and the thread continues with the next job.
///
/// # Errors
/// Fails if the system cannot start a thread.
pub fn latest<State: Send + 'static, Job>(
    name: &str,
    state: State,
    mut next: impl FnMut(&mut State) -> Option<Job> + Send + 'static,
    mut work: impl FnMut(Job, &Shared<State>) + Send + 'static,
) -> io::Result<Latest<State>> {
    looping(name, state, move |shared| {
        loop {
            let mut job = None;
            drop(shared.wait_while(Duration::MAX, |state| {
                job = next(state);
                job.is_none()
            }));
            let Some(job) = job.filter(|_| !shared.is_over()) else { return };
            contained(|| work(job, shared));
        }
    })
}

/// Starts a thread that runs its own loop, and must end when [`Shared::is_over`].
///
/// # Errors
/// Fails if the system cannot start a thread.
pub fn looping<State: Send + 'static>(
    name: &str,
    state: State,
    work: impl FnOnce(&Shared<State>) + Send + 'static,
) -> io::Result<Latest<State>> {
    let (state, changed) = (Mutex::new(state), Condvar::new());
    let shared = Arc::new(Shared { state, changed, is_over: AtomicBool::new(false) });
    let of_thread = shared.clone();
    let background = Background::start(name, move || work(&of_thread))?;
    Ok(Latest { shared, background })
}

impl<State> Shared<State> {
    /// Locks the state, to read it or to store results.
    pub fn lock(&self) -> MutexGuard<'_, State> {
        lock(&self.state)
    }

    /// Changes what is wanted, and wakes the thread.
    pub fn change<T>(&self, change: impl FnOnce(&mut State) -> T) -> T {
        let changed = change(&mut self.lock());
        self.changed.notify_all();
        changed
    }

    /// Waits for `time`, or until the end.
    pub fn rest(&self, time: Duration) {
        drop(self.wait_while(time, |_| true));
    }

    /// Waits while `waits` is true, for at most `limit` and until the end. `waits` is called after each change.
    pub fn wait_while(
        &self,
        limit: Duration,
        mut waits: impl FnMut(&mut State) -> bool,
    ) -> MutexGuard<'_, State> {
        let waits = |state: &mut State| !self.is_over() && waits(state);
        let waited = self.changed.wait_timeout_while(self.lock(), limit, waits);
        waited.unwrap_or_else(PoisonError::into_inner).0
    }

    /// Ends the thread and all waits.
    pub fn end(&self) {
        self.change(|_| self.is_over.store(true, Ordering::Relaxed));
    }

    /// True once the owner has gone, or has called [`Shared::end`].
    pub fn is_over(&self) -> bool {
        self.is_over.load(Ordering::Relaxed)
    }
}

impl<State> Latest<State> {
    /// Dropping this waits at most `limit` for the job at hand.
    #[must_use]
    pub fn finished_at_drop(mut self, limit: Duration) -> Self {
        self.background.wait = limit;
        self
    }

    /// Returns the thread, to unpark it.
    pub fn thread(&self) -> Option<&Thread> {
        self.background.thread()
    }
}

impl<State> Deref for Latest<State> {
    type Target = Shared<State>;

    fn deref(&self) -> &Shared<State> {
        &self.shared
    }
}

impl<State> Drop for Latest<State> {
    fn drop(&mut self) {
        self.end();
        self.thread().map(Thread::unpark);
    }
}
