//! Wakes a session from other threads.

use std::sync::Arc;

/// Wakes a session. Clones wake the same session.
#[derive(Clone)]
pub struct Waker(Arc<dyn Fn() + Send + Sync>);

impl Waker {
    /// Calls `wake`, possibly before the session begins or after it has ended.
    pub fn new(wake: impl Fn() + Send + Sync + 'static) -> Self {
        Self(Arc::new(wake))
    }

    /// Returns a function that wakes the session.
    pub fn waking(&self) -> impl Fn() + Clone + Send + Sync + use<> {
        let wake = self.0.clone();
        move || wake()
    }

    /// Makes the session look for finished work.
    pub fn wake(&self) {
        (self.0)();
    }
}
