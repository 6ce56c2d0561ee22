//! The state of the thread that asks Windows to keep the screen on.

#![expect(unsafe_code, reason = "functions of Windows are C functions")]

use windows_sys::Win32::System::Power::{
    ES_CONTINUOUS, ES_DISPLAY_REQUIRED, ES_SYSTEM_REQUIRED, SetThreadExecutionState,
};

/// The state of the thread, which lives as long as the request.
pub(super) struct Asked;

impl Asked {
    pub(super) fn begin() -> Self {
        // SAFETY: the function takes a number and changes only the state of this thread.
        unsafe { SetThreadExecutionState(ES_CONTINUOUS | ES_DISPLAY_REQUIRED | ES_SYSTEM_REQUIRED) };
        Self
    }
}

impl Drop for Asked {
    fn drop(&mut self) {
        // SAFETY: as above.
        unsafe { SetThreadExecutionState(ES_CONTINUOUS) };
    }
}
