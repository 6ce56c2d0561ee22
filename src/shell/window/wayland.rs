//! winit's connection to a Wayland compositor, shared because windows and surfaces must use the same one.

#![expect(unsafe_code, reason = "winit exposes its connection to a Wayland compositor as a pointer")]

use raw_window_handle::{HasDisplayHandle, RawDisplayHandle};
use wayland_client::Connection;
use wayland_client::backend::Backend;
use winit::event_loop::OwnedDisplayHandle;

use crate::session::SessionError;

/// Returns the connection behind `display`. The connection and everything created with it must be dropped first.
pub(crate) fn wayland_connection(display: &OwnedDisplayHandle) -> Result<Connection, SessionError> {
    let handle = display.display_handle().map(|handle| handle.as_raw());
    let Ok(RawDisplayHandle::Wayland(handle)) = handle else { return Err(SessionError::NoLayerShell) };
    // SAFETY: the pointer is a `wl_display` of the same libwayland, valid while its owner lives; the caller keeps
    // `display` until the connection is dropped.
    let backend = unsafe { Backend::from_foreign_display(handle.display.as_ptr().cast()) };
    Ok(Connection::from_backend(backend))
}
