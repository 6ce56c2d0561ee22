//! The console window that Windows opens for a program with a command line.

#![expect(unsafe_code, reason = "functions of Windows are C functions")]

use windows_sys::Win32::System::Console::{FreeConsole, GetConsoleProcessList};

/// Closes the console window if Windows opened it for this program alone, as after a double click. The console of a
/// terminal stays.
pub(super) fn close_if_own() {
    let mut processes = [0; 2];
    // SAFETY: the list has room for two numbers, and the second call has no arguments.
    unsafe {
        if GetConsoleProcessList(processes.as_mut_ptr(), 2) == 1 {
            FreeConsole();
        }
    }
}
