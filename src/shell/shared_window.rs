//! Access to a window from the show's thread.
//!
//! winit lets any thread call a window. On X11 such a call may wait for a reply, which reads the connection, and events
//! that arrive with the reply are queued in Xlib. The event thread would notice these events only when the socket
//! becomes readable again, so each call must wake the event thread. Therefore the window is reached only through a
//! guard that wakes this thread.
//!
//! Windows and macOS give a window's handle only to the thread that opened the window, so the handle is taken there.

#![expect(unsafe_code, reason = "the handle of a window moves to another thread")]

use std::num::NonZeroU32;
use std::ops::Deref;
use std::sync::Arc;

use glutin::surface::{SurfaceAttributes, SurfaceAttributesBuilder, WindowSurface};
use raw_window_handle::{HandleError, HasWindowHandle, RawWindowHandle};
use winit::window::Window;

use crate::session::waker::Waker;

#[derive(Clone)]
pub(crate) struct SharedWindow {
    window: Arc<Window>,
    handle: Handle,
    /// Wakes the event thread. `None` where calls never queue events.
    events: Option<Waker>,
}

#[derive(Clone, Copy)]
struct Handle(RawWindowHandle);

// SAFETY: the handle is a name of the window. Only the driver uses it, on the thread of the context.
unsafe impl Send for Handle {}
// SAFETY: as above.
unsafe impl Sync for Handle {}

/// Access to a window. Dropping it wakes the event thread.
pub(crate) struct WindowCalls<'a>(&'a SharedWindow);

impl SharedWindow {
    /// Wraps a window whose events arrive on the thread that `events` wakes; `None` if calls never queue events. Must be
    /// called on the thread that opened the window.
    ///
    /// # Errors
    /// Fails with winit's error if the window has no handle here.
    pub(crate) fn new(window: Arc<Window>, events: Option<Waker>) -> Result<Self, HandleError> {
        let handle = Handle(window.window_handle()?.as_raw());
        Ok(Self { window, handle, events })
    }

    /// The handle for drivers. It is valid as long as this value.
    pub(crate) fn handle(&self) -> RawWindowHandle {
        self.handle.0
    }

    pub(crate) fn calls(&self) -> WindowCalls<'_> {
        WindowCalls(self)
    }

    // These methods do not call the X server, so they need no wake-up.

    pub(crate) fn request_redraw(&self) {
        self.window.request_redraw();
    }

    pub(crate) fn pre_present_notify(&self) {
        self.window.pre_present_notify();
    }

    pub(crate) fn is_fullscreen(&self) -> bool {
        self.window.fullscreen().is_some()
    }
}

/// The attributes of a surface of `size` pixels on a window.
pub(crate) fn surface_attributes(
    window: RawWindowHandle,
    size: (u32, u32),
) -> SurfaceAttributes<WindowSurface> {
    let side = |side: u32| NonZeroU32::new(side).unwrap_or(NonZeroU32::MIN);
    SurfaceAttributesBuilder::<WindowSurface>::new().build(window, side(size.0), side(size.1))
}

impl Deref for WindowCalls<'_> {
    type Target = Window;

    fn deref(&self) -> &Window {
        &self.0.window
    }
}

impl Drop for WindowCalls<'_> {
    fn drop(&mut self) {
        if let Some(events) = &self.0.events {
            events.wake();
        }
    }
}
