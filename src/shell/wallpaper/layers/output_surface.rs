//! A wallpaper surface on a Wayland output: its size, and the compositor's requests for frames.

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use mariana_work::lock;
use raw_window_handle::{RawWindowHandle, WaylandWindowHandle};
use smithay_client_toolkit::output::OutputInfo;
use smithay_client_toolkit::reexports::protocols::wp::viewporter::client::wp_viewport::WpViewport;
use smithay_client_toolkit::shell::WaylandSurface;
use smithay_client_toolkit::shell::wlr_layer::LayerSurface;
use wayland_client::protocol::wl_output::{Transform, WlOutput};
use wayland_client::protocol::wl_surface::WlSurface;
use wayland_client::{Proxy, QueueHandle};
use winit::event_loop::OwnedDisplayHandle;

use super::LayersState;
use crate::shell::window::DrawTarget;

/// A surface counts as covered after this time without a request for a frame. Slow monitors show 24 frames a second.
const UNSEEN: Duration = Duration::from_secs(1);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Extent {
    /// Size of the surface's frames, in pixels.
    pub(crate) pixels: (u32, u32),
    /// Size in the compositor's logical units.
    units: (u32, u32),
}

impl Extent {
    /// Returns the extent of a surface of `units` on an output with the integer `scale`. Frames have the output's
    /// pixels (`mode`), if they are known, so that fractional scales are exact.
    fn of(units: (u32, u32), mode: Option<(u32, u32)>, scale: u32) -> Self {
        let units = (units.0.max(1), units.1.max(1));
        let scale = scale.max(1);
        let whole = (units.0.saturating_mul(scale), units.1.saturating_mul(scale));
        let pixels = mode.filter(|mode| mode.0 > 0 && mode.1 > 0).unwrap_or(whole);
        Self { pixels, units }
    }
}

/// A surface on an output. Must be dropped after everything that draws into it.
#[derive(Debug)]
pub(crate) struct OutputSurface {
    name: String,
    state: Mutex<State>,
    queue: QueueHandle<LayersState>,
    borne: Borne,
}

#[derive(Debug)]
pub(super) struct Borne {
    pub(super) output: WlOutput,
    pub(super) layer: LayerSurface,
    /// Scales the surface's frames.
    pub(super) viewport: WpViewport,
    /// The last field: the objects above are invalid without it.
    #[expect(dead_code, reason = "keeps the display alive")]
    pub(super) display: OwnedDisplayHandle,
}

#[derive(Debug, Default)]
struct State {
    /// Size from the compositor, in units; `None` before it was sent.
    units: Option<(u32, u32)>,
    extent: Option<Extent>,
    /// Time of the last request for a frame callback; `None` once the compositor has answered.
    waits_since: Option<Instant>,
}

impl OutputSurface {
    pub(super) fn new(name: String, borne: Borne, queue: QueueHandle<LayersState>) -> Self {
        Self { name, state: Mutex::default(), queue, borne }
    }

    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    pub(crate) fn extent(&self) -> Option<Extent> {
        lock(&self.state).extent
    }

    /// True if the compositor wants another frame.
    pub(crate) fn is_ready(&self) -> bool {
        let state = lock(&self.state);
        state.extent.is_some() && state.waits_since.is_none()
    }

    pub(crate) fn fit(&self, extent: Extent) {
        let units = |side: u32| i32::try_from(side).unwrap_or(i32::MAX);
        self.borne.viewport.set_destination(units(extent.units.0), units(extent.units.1));
    }

    pub(super) fn output(&self) -> &WlOutput {
        &self.borne.output
    }

    pub(super) fn is_of(&self, layer: &LayerSurface) -> bool {
        self.borne.layer == *layer
    }

    pub(super) fn answer(&self) {
        lock(&self.state).waits_since = None;
    }

    pub(super) fn give(&self, units: (u32, u32)) {
        lock(&self.state).units = Some(units);
    }

    fn surface(&self) -> &WlSurface {
        self.borne.layer.wl_surface()
    }

    /// Updates the extent from the output's state and the stored units. Returns true if it has changed.
    pub(super) fn measure(&self, info: Option<&OutputInfo>) -> bool {
        let mut state = lock(&self.state);
        let Some(units) = state.units else { return false };
        let mode = info.and_then(|info| {
            let (width, height) = info.modes.iter().find(|mode| mode.current)?.dimensions;
            let turned = matches!(
                info.transform,
                Transform::_90 | Transform::_270 | Transform::Flipped90 | Transform::Flipped270
            );
            let (width, height) = (u32::try_from(width).ok()?, u32::try_from(height).ok()?);
            Some(if turned { (height, width) } else { (width, height) })
        });
        let scale = info.and_then(|info| u32::try_from(info.scale_factor).ok()).unwrap_or(1);
        let extent = Extent::of(units, mode, scale);
        let is_new = state.extent != Some(extent);
        if is_new {
            // A frame of the new size is needed even if the surface is covered.
            (state.extent, state.waits_since) = (Some(extent), None);
        }
        is_new
    }
}

impl DrawTarget for OutputSurface {
    fn handle(&self) -> Option<RawWindowHandle> {
        let surface = std::ptr::NonNull::new(self.surface().id().as_ptr().cast())?;
        Some(WaylandWindowHandle::new(surface).into())
    }

    /// Requests a callback for the next frame.
    fn is_about_to_show(&self) {
        lock(&self.state).waits_since = Some(Instant::now());
        self.surface().frame(&self.queue, self.surface().clone());
    }
}

impl Drop for Borne {
    fn drop(&mut self) {
        // The viewport must be destroyed before its surface, which is dropped next.
        self.viewport.destroy();
    }
}

#[derive(Debug, Clone, Default)]
pub(crate) struct OutputSurfaces(Arc<Mutex<Vec<Arc<OutputSurface>>>>);

impl OutputSurfaces {
    pub(crate) fn present(&self) -> Vec<Arc<OutputSurface>> {
        lock(&self.0).clone()
    }

    /// True if all surfaces are covered at `now`, judged by missing frame callbacks.
    pub(crate) fn are_unseen(&self, now: Instant) -> bool {
        let unseen = |output_surface: &Arc<OutputSurface>| {
            let since = lock(&output_surface.state).waits_since;
            since.is_some_and(|since| now.saturating_duration_since(since) >= UNSEEN)
        };
        lock(&self.0).iter().all(unseen)
    }

    pub(super) fn add(&self, output_surface: OutputSurface) {
        lock(&self.0).push(Arc::new(output_surface));
    }

    pub(super) fn remove(&self, is_gone: impl Fn(&OutputSurface) -> bool) {
        lock(&self.0).retain(|output_surface| !is_gone(output_surface));
    }

    pub(super) fn of_surface(&self, surface: &WlSurface) -> Option<Arc<OutputSurface>> {
        lock(&self.0).iter().find(|output_surface| output_surface.surface() == surface).cloned()
    }

    pub(super) fn of_output(&self, output: &WlOutput) -> Option<Arc<OutputSurface>> {
        lock(&self.0).iter().find(|output_surface| output_surface.borne.output == *output).cloned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_has_the_pixels_of_its_output() {
        let pixels = |units, mode, scale| Extent::of(units, mode, scale).pixels;
        // One and a half pixels per unit, which the compositor rounds to 2.
        assert_eq!(pixels((1280, 720), Some((1920, 1080)), 2), (1920, 1080));
        assert_eq!(pixels((1280, 720), None, 2), (2560, 1440));
        assert_eq!(pixels((1280, 720), Some((0, 9)), 1), (1280, 720));
        assert_eq!(pixels((0, 0), None, 0), (1, 1), "a size is never 0");
        assert_eq!(pixels((u32::MAX, 1), None, 3), (u32::MAX, 3));
    }
}
