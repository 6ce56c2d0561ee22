//! Replaces the module `layers` on systems without Wayland, with types that have no values.

use std::convert::Infallible;
use std::sync::Arc;
use std::time::Instant;

use raw_window_handle::RawWindowHandle;
use winit::event_loop::EventLoop;

use crate::session::{SessionError, Waker};
use crate::shell::messages::WindowMessage;
use crate::shell::window::DrawTarget;

pub(crate) fn is_wayland() -> bool {
    false
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Extent {
    pub(crate) pixels: (u32, u32),
}

#[derive(Debug)]
pub(crate) struct OutputSurface(Infallible);

impl OutputSurface {
    pub(crate) fn name(&self) -> &str {
        match self.0 {}
    }

    pub(crate) fn extent(&self) -> Option<Extent> {
        match self.0 {}
    }

    pub(crate) fn is_ready(&self) -> bool {
        match self.0 {}
    }

    pub(crate) fn fit(&self, _: Extent) {
        match self.0 {}
    }
}

impl DrawTarget for OutputSurface {
    fn handle(&self) -> Option<RawWindowHandle> {
        match self.0 {}
    }

    fn is_about_to_show(&self) {
        match self.0 {}
    }
}

#[derive(Debug, Clone)]
pub(crate) struct OutputSurfaces(Infallible);

impl OutputSurfaces {
    pub(crate) fn present(&self) -> Vec<Arc<OutputSurface>> {
        match self.0 {}
    }

    pub(crate) fn are_unseen(&self, _: Instant) -> bool {
        match self.0 {}
    }
}

pub(crate) struct Layers(Infallible);

impl Layers {
    pub(crate) fn start(_: &EventLoop<WindowMessage>, _: &Waker) -> Result<Self, SessionError> {
        Err(SessionError::NoLayerShell)
    }

    pub(crate) fn output_surfaces(&self) -> OutputSurfaces {
        match self.0 {}
    }
}
