//! OpenGL contexts in the test process. Only one thread at a time may use contexts.
//!
//! Tests run in parallel threads, and all their contexts share an EGL display. Before llvmpipe (up to Mesa 22.3)
//! allocates a buffer, it reads all contexts of a display (`lp_scene_is_resource_referenced`). llvmpipe does not lock
//! the contexts, so a thread that draws meanwhile could crash the process.

use std::ops::Deref;
use std::sync::{Condvar, Mutex, PoisonError};
use std::thread::ThreadId;

use mariana::gpu::api::Api;
use mariana::gpu::error::GpuError;
use mariana::gpu::headless::Headless;

/// The thread that draws, and the number of its contexts.
static DRAWING: Mutex<Option<(ThreadId, usize)>> = Mutex::new(None);
static DONE: Condvar = Condvar::new();

/// While this guard exists, no other thread draws.
pub(crate) struct DrawsAlone(());

impl DrawsAlone {
    pub(crate) fn wait() -> Self {
        let own = std::thread::current().id();
        let mut drawing = DRAWING.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            match &mut *drawing {
                Some((thread, count)) if *thread == own => {
                    *count += 1;
                    return Self(());
                }
                Some(_) => drawing = DONE.wait(drawing).unwrap_or_else(PoisonError::into_inner),
                free => {
                    *free = Some((own, 1));
                    return Self(());
                }
            }
        }
    }
}

impl Drop for DrawsAlone {
    fn drop(&mut self) {
        let mut drawing = DRAWING.lock().unwrap_or_else(PoisonError::into_inner);
        *drawing = drawing.take().and_then(|(thread, count)| (count > 1).then(|| (thread, count - 1)));
        DONE.notify_all();
    }
}

/// A context without a window. The guard keeps other threads from drawing.
pub(crate) struct Context {
    // This field is the first, so that the context is dropped before the guard.
    headless: Headless,
    _alone: DrawsAlone,
}

impl Context {
    pub(crate) fn new() -> Self {
        Self::made(|| Headless::new(false))
    }

    /// A context of OpenGL ES.
    pub(crate) fn embedded() -> Self {
        Self::made(|| Headless::with(&[Api::Embedded], false))
    }

    fn made(make: impl FnOnce() -> Result<Headless, GpuError>) -> Self {
        let alone = DrawsAlone::wait();
        Self { headless: make().unwrap_or_else(|error| panic!("{error}")), _alone: alone }
    }
}

impl Deref for Context {
    type Target = Headless;

    fn deref(&self) -> &Headless {
        &self.headless
    }
}
