//! The display ends, or breaks the connection, in the middle of the show: the end of it, with the reason.
//!
//! A Wayland compositor that goes ends winit's event loop. If an X server does, Xlib calls a handler,
//! on whichever thread used the connection, and ends the process if that returns. Its own one calls `exit`, whose handlers
//! take a driver away from its threads that still work.

#![cfg_attr(all(unix, not(target_os = "macos")), expect(unsafe_code, reason = "Xlib is a C library"))]

use super::AppError;
use crate::ending;
use crate::export::print::tell;

#[cfg(all(unix, not(target_os = "macos")))]
use x11_dl::xlib;

/// Has the process end with a sentence of ours and code 1 if the X server goes. Where there is no Xlib there is nothing to do.
#[cfg(all(unix, not(target_os = "macos")))]
pub(super) fn end_with_the_reason() {
    let Ok(library) = xlib::Xlib::open() else { return };
    // SAFETY: the handler is a function of this program, which is there as long as the process.
    unsafe { (library.XSetIOErrorHandler)(Some(on_lost_server)) };
    // It stays loaded: the handler is a setting of it.
    std::mem::forget(library);
}

/// No such library here.
#[cfg(not(all(unix, not(target_os = "macos"))))]
pub(super) fn end_with_the_reason() {}

#[cfg(all(unix, not(target_os = "macos")))]
unsafe extern "C" fn on_lost_server(_display: *mut xlib::Display) -> std::ffi::c_int {
    end()
}

/// Ends the process and says why.
pub(super) fn end() -> ! {
    let leaving = ending::begin_to_leave();
    tell(&AppError::DisplayLost.to_string());
    leaving.leave(1)
}
