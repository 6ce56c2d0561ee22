//! The X server ends, or breaks the connection, in the middle of the show: the process ends and says why.
//!
//! In that case Xlib calls a handler, on whichever thread used the connection, and ends the process if the handler
//! returns. Xlib's own handler calls `exit`, whose exit handlers unload a driver while its threads still work.

#![expect(unsafe_code, reason = "Xlib is a C library")]

use std::ffi::c_int;

use x11_dl::xlib;

use crate::shell::window_thread::end_without_display;

/// Ends the process with a sentence of ours and code 1 if the X server goes. Without Xlib there is nothing to do.
pub(crate) fn end_with_the_reason() {
    let Ok(library) = xlib::Xlib::open() else { return };
    // SAFETY: the handler is a function of this program, which lives as long as the process.
    unsafe { (library.XSetIOErrorHandler)(Some(on_lost_server)) };
}

// SAFETY: it reads nothing that it is given.
unsafe extern "C" fn on_lost_server(_display: *mut xlib::Display) -> c_int {
    end_without_display()
}
