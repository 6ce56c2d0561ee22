//! The connection to a Wayland compositor, which is shared with winit: pictures and windows must come by the same one.

#![expect(unsafe_code, reason = "winit gives its connection to a Wayland compositor as a pointer")]

use raw_window_handle::{HasDisplayHandle, RawDisplayHandle};
use wayland_client::Connection;
use wayland_client::backend::Backend;
use winit::event_loop::OwnedDisplayHandle;

use crate::session::SessionError;

/// The connection that `display` stands for. It, and all that is made by it, must not outlive `display`.
///
/// # Errors
/// It is none to a Wayland compositor.
pub(crate) fn wayland_connection(display: &OwnedDisplayHandle) -> Result<Connection, SessionError> {
    let handle = display.display_handle().map(|handle| handle.as_raw());
    let Ok(RawDisplayHandle::Wayland(handle)) = handle else { return Err(SessionError::NoLayerShell) };
    // SAFETY: it is a display of the same library of Wayland, alive as long as its owner, which whoever calls this keeps.
    let backend = unsafe { Backend::from_foreign_display(handle.display.as_ptr().cast()) };
    Ok(Connection::from_backend(backend))
}
