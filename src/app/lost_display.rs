//! The X server ends, or breaks the connection, in the middle of the show: the end of it, with the reason.
//!
//! Xlib calls a handler then, on whichever thread used the connection, and ends the process if that returns. Its own one
//! calls `exit`, whose handlers take a driver away from its threads that still work.

#![expect(unsafe_code, reason = "Xlib is a C library")]

use std::ffi::c_int;

use x11_dl::xlib;

use super::window_thread::end_without_display;

/// Has the process end with a sentence of ours and code 1 if the X server goes. Where there is no Xlib there is nothing to do.
pub(super) fn end_with_the_reason() {
    let Ok(library) = xlib::Xlib::open() else { return };
    // SAFETY: the handler is a function of this program, which is there as long as the process.
    unsafe { (library.XSetIOErrorHandler)(Some(on_lost_server)) };
}

// SAFETY: it looks at nothing that it is given.
unsafe extern "C" fn on_lost_server(_display: *mut xlib::Display) -> c_int {
    end_without_display()
}
