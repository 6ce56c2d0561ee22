//! An OpenGL context without a visible window, drawing into framebuffers only.
//!
//! Stills, videos, tests and measurements draw with such a context. `Renderer` works the same with and without a
//! window. Each system has its own way to such a context:
//!
//! | system | context |
//! |---|---|
//! | Linux and other Unix systems | EGL on a device, without a window system (`egl`) |
//! | Windows | WGL with a hidden window (`wgl`); tried only under Wine |
//! | macOS | CGL without a view (`cgl`); not yet tried on hardware |
//!
//! Only one thread of a process at a time has such contexts; other threads wait. All contexts of a process share an EGL
//! display, and llvmpipe (up to Mesa 22.3) reads all contexts of a display without a lock before it allocates a buffer
//! (`lp_scene_is_resource_referenced`), so a thread that draws meanwhile could crash the process.

#[cfg(target_os = "macos")]
mod cgl;
#[cfg(all(unix, not(target_os = "macos")))]
mod egl;
#[cfg(windows)]
mod wgl;

#[cfg(target_os = "macos")]
use cgl as system;
#[cfg(all(unix, not(target_os = "macos")))]
use egl as system;
#[cfg(windows)]
use wgl as system;

#[cfg(target_os = "linux")]
pub(super) use egl::default_context;
#[cfg(all(unix, not(target_os = "macos")))]
pub(super) use egl::software_context;

use std::sync::{Condvar, Mutex, PoisonError};
use std::thread::ThreadId;

use super::api::Api;
use super::error::{GpuError, Result};
use super::gl::Gl;

/// The thread that has contexts, and their number.
static OWNER: Mutex<Option<(ThreadId, usize)>> = Mutex::new(None);
static FREED: Condvar = Condvar::new();

/// The right of a thread to have a context.
struct Turn(());

impl Turn {
    /// Waits until no other thread has a context.
    fn wait() -> Self {
        let own = std::thread::current().id();
        let owner = OWNER.lock().unwrap_or_else(PoisonError::into_inner);
        let is_taken = |owner: &mut Option<(ThreadId, usize)>| owner.is_some_and(|(thread, _)| thread != own);
        let mut owner = FREED.wait_while(owner, is_taken).unwrap_or_else(PoisonError::into_inner);
        let count = owner.map_or(0, |(_, count)| count);
        *owner = Some((own, count + 1));
        Self(())
    }
}

impl Drop for Turn {
    fn drop(&mut self) {
        let mut owner = OWNER.lock().unwrap_or_else(PoisonError::into_inner);
        *owner = owner.and_then(|(thread, count)| (count > 1).then(|| (thread, count - 1)));
        FREED.notify_all();
    }
}

/// A current context without a visible window. Drop everything made from [`Headless::gl`] before the context.
pub struct Headless {
    gl: Gl,
    _context: system::Current,
    // The last field: the context is dropped before another thread may have one.
    _turn: Turn,
}

impl Headless {
    /// The kind of context on this system.
    pub const KIND: &str = system::KIND;

    /// The functions of the context.
    pub fn gl(&self) -> &Gl {
        &self.gl
    }

    /// Creates a context of OpenGL 3.3 or else of OpenGL ES 3.0, and makes it current. Waits until no other thread has a
    /// context without a window. If there are several devices, takes the first suitable one, hardware first.
    ///
    /// # Errors
    /// [`GpuError::NoHeadlessContext`] with the system's errors, or [`GpuError::TooOld`] if all contexts are too old.
    pub fn new(log_debug: bool) -> Result<Self> {
        Self::with(Api::tried()?, log_debug)
    }

    /// Like [`Headless::new`], with the first of these interfaces that the system has.
    ///
    /// # Errors
    /// Same errors as [`Headless::new`].
    pub fn with(apis: &[Api], log_debug: bool) -> Result<Self> {
        let turn = Turn::wait();
        let (gl, context) = system::open(apis, log_debug)?;
        Ok(Self { gl, _context: context, _turn: turn })
    }
}

fn no_context(reason: &dyn std::fmt::Display) -> GpuError {
    GpuError::NoHeadlessContext(reason.to_string())
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::time::Duration;

    use super::*;

    /// Two threads that drew at the same time crashed in llvmpipe.
    #[test]
    fn only_one_thread_at_a_time_has_contexts() {
        let having = AtomicUsize::new(0);
        let open = || {
            let first = Headless::new(false).unwrap();
            assert_eq!(having.fetch_add(1, Ordering::SeqCst), 0, "another thread has a context");
            let second = Headless::new(false).unwrap();
            std::thread::sleep(Duration::from_millis(5));
            drop(first);
            having.fetch_sub(1, Ordering::SeqCst);
            drop(second);
        };
        std::thread::scope(|scope| (0..4).for_each(|_| drop(scope.spawn(open))));
    }
}
