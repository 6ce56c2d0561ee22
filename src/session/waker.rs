//! Wakes a session from other threads.

use std::sync::Arc;

/// See the module. Copies wake the same session.
#[derive(Clone)]
pub struct Waker(Arc<dyn Fn() + Send + Sync>);

impl Waker {
    /// Calls `wake`, which may happen before the session begins and after it has ended.
    pub fn new(wake: impl Fn() + Send + Sync + 'static) -> Self {
        Self(Arc::new(wake))
    }

    /// Makes the session look for news.
    pub fn wake(&self) {
        (self.0)();
    }
}
