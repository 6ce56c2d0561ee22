//! Access to a window from the show's thread.
//!
//! winit lets any thread call a window. On X11 such a call may wait for a reply, which reads the connection, and events
//! that arrive with the reply are queued in Xlib. The event thread would notice these events only when the socket
//! becomes readable again, so each call must wake the event thread. Therefore the window is reached only through a
//! guard that wakes this thread.

use std::ops::Deref;
use std::sync::Arc;

use winit::window::Window;

use crate::session::waker::Waker;

#[derive(Clone)]
pub(crate) struct SharedWindow {
    window: Arc<Window>,
    /// Wakes the event thread. `None` where calls never queue events.
    events: Option<Waker>,
}

/// Access to a window. Dropping it wakes the event thread.
pub(crate) struct WindowCalls<'a>(&'a SharedWindow);

impl SharedWindow {
    /// Wraps a window whose events arrive on the thread that `events` wakes; `None` if calls never queue events.
    pub(crate) fn new(window: Arc<Window>, events: Option<Waker>) -> Self {
        Self { window, events }
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
