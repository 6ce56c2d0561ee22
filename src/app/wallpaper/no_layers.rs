//! Systems without Wayland have no layers on it.

use std::convert::Infallible;
use std::sync::Arc;
use std::time::Instant;

use raw_window_handle::RawWindowHandle;
use winit::event_loop::EventLoop;

use crate::app::window_thread::Told;
use crate::session::SessionError;
use crate::session::waker::Waker;

/// Never.
pub(in crate::app) fn is_wayland() -> bool {
    false
}

/// There is none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::app) struct Extent {
    /// None.
    pub(in crate::app) pixels: (u32, u32),
}

/// There is none.
#[derive(Debug)]
pub(in crate::app) struct Sheet(Infallible);

impl Sheet {
    pub(in crate::app) fn name(&self) -> &str {
        match self.0 {}
    }

    pub(in crate::app) fn extent(&self) -> Option<Extent> {
        match self.0 {}
    }

    pub(in crate::app) fn is_ready(&self) -> bool {
        match self.0 {}
    }

    pub(in crate::app) fn handle(&self) -> Option<RawWindowHandle> {
        match self.0 {}
    }

    pub(in crate::app) fn fit(&self, _: Extent) {
        match self.0 {}
    }

    pub(in crate::app) fn ask(&self) {
        match self.0 {}
    }
}

/// There are none.
#[derive(Debug, Clone)]
pub(in crate::app) struct Sheets(Infallible);

impl Sheets {
    pub(in crate::app) fn present(&self) -> Vec<Arc<Sheet>> {
        match self.0 {}
    }

    pub(in crate::app) fn are_unseen(&self, _: Instant) -> bool {
        match self.0 {}
    }
}

/// There are none.
pub(in crate::app) struct Layers(Infallible);

impl Layers {
    pub(in crate::app) fn start(_: &EventLoop<Told>, _: &Waker) -> Result<Self, SessionError> {
        Err(SessionError::NoLayerShell)
    }

    pub(in crate::app) fn sheets(&self) -> Sheets {
        match self.0 {}
    }
}
