//! Ends the process with a message if the X server ends or closes the connection during a show. Xlib calls a handler on
//! the thread that used the connection, and exits the process if the handler returns. The default handler calls `exit`,
//! whose exit handlers unload the driver while the driver's threads still run.

#![expect(unsafe_code, reason = "Xlib is a C library")]

use std::ffi::c_int;

use x11_dl::xlib;

use crate::shell::window_thread::end_without_display;

/// Installs a handler that ends the process with our message and code 1 when the X server is lost, if there is Xlib.
pub(crate) fn end_with_the_reason() {
    let Ok(library) = xlib::Xlib::open() else { return };
    // SAFETY: the handler is a static function, valid for the life of the process, and it never returns to Xlib.
    unsafe { (library.XSetIOErrorHandler)(Some(on_lost_server)) };
}

// SAFETY: Xlib may pass any pointer, because the function does not use its argument.
unsafe extern "C" fn on_lost_server(_display: *mut xlib::Display) -> c_int {
    end_without_display()
}
