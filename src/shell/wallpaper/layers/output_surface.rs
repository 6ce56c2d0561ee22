//! A surface of the ground: how large it is, and whether the compositor wants a picture on it.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

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

/// A surface that waits longer than this for its next picture to be wanted is not seen. Slow monitors have 24 pictures
/// a second.
const UNSEEN: Duration = Duration::from_secs(1);

/// How large a surface is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Extent {
    /// Width and height of its pictures, in pixels.
    pub(crate) pixels: (u32, u32),
    /// The same in the compositor's units.
    units: (u32, u32),
    /// Pixels in one of these, where the compositor stretches no pictures.
    scale: u32,
}

impl Extent {
    /// Of a surface of this many units on an output with a `mode` of so many pixels, where that is known, and whole
    /// pixels per unit. Whoever can be stretched has the output's own pixels, be they a fraction of a unit.
    fn of(units: (u32, u32), mode: Option<(u32, u32)>, scale: u32, is_stretched: bool) -> Self {
        let units = (units.0.max(1), units.1.max(1));
        let scale = scale.max(1);
        let whole = (units.0.saturating_mul(scale), units.1.saturating_mul(scale));
        let pixels = mode.filter(|mode| is_stretched && mode.0 > 0 && mode.1 > 0).unwrap_or(whole);
        Self { pixels, units, scale }
    }
}

/// A surface on an output. Drop what draws into it before.
#[derive(Debug)]
pub(crate) struct OutputSurface {
    name: String,
    state: Mutex<State>,
    queue: QueueHandle<LayersState>,
    borne: Borne,
}

/// What a surface is made of.
#[derive(Debug)]
pub(super) struct Borne {
    pub(super) output: WlOutput,
    pub(super) layer: LayerSurface,
    /// What stretches its pictures, where the compositor can.
    pub(super) viewport: Option<WpViewport>,
    /// Last: whatever stands above is nothing without it.
    #[expect(dead_code, reason = "it is kept, not used")]
    pub(super) display: OwnedDisplayHandle,
}

#[derive(Debug, Default)]
struct State {
    /// Width and height that the compositor gives it, in its units; none before.
    units: Option<(u32, u32)>,
    extent: Option<Extent>,
    /// Since when it waits for the compositor to want another picture; none if it does.
    waits_since: Option<Instant>,
}

impl OutputSurface {
    /// Of which nobody has told how large it is.
    pub(super) fn new(name: String, borne: Borne, queue: QueueHandle<LayersState>) -> Self {
        Self { name, state: Mutex::default(), queue, borne }
    }

    /// What the compositor calls its output.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// How large it is; none before the compositor has said so.
    pub(crate) fn extent(&self) -> Option<Extent> {
        self.state().extent
    }

    /// Whether the compositor wants another picture.
    pub(crate) fn is_ready(&self) -> bool {
        let state = self.state();
        state.extent.is_some() && state.waits_since.is_none()
    }

    /// What drivers draw into.
    pub(crate) fn handle(&self) -> Option<RawWindowHandle> {
        let surface = std::ptr::NonNull::new(self.surface().id().as_ptr().cast())?;
        Some(WaylandWindowHandle::new(surface).into())
    }

    /// Lets pictures of this extent fill it, from the next one on.
    pub(crate) fn fit(&self, extent: Extent) {
        let units = |side: u32| i32::try_from(side).unwrap_or(i32::MAX);
        match &self.borne.viewport {
            Some(viewport) => viewport.set_destination(units(extent.units.0), units(extent.units.1)),
            None => self.surface().set_buffer_scale(units(extent.scale)),
        }
    }

    /// Asks to be told when a picture after the next one is wanted. To be called before each is shown.
    pub(crate) fn ask(&self) {
        self.state().waits_since = Some(Instant::now());
        self.surface().frame(&self.queue, self.surface().clone());
    }

    /// Its output.
    pub(super) fn output(&self) -> &WlOutput {
        &self.borne.output
    }

    /// Whether it is this one.
    pub(super) fn is_of(&self, layer: &LayerSurface) -> bool {
        self.borne.layer == *layer
    }

    /// The compositor wants another picture.
    pub(super) fn answer(&self) {
        self.state().waits_since = None;
    }

    /// The compositor gives it this width and height, in its units.
    pub(super) fn give(&self, units: (u32, u32)) {
        self.state().units = Some(units);
    }

    fn surface(&self) -> &WlSurface {
        self.borne.layer.wl_surface()
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes what is known of its output, and the units that it has been given. Returns whether its extent is another.
    pub(super) fn measure(&self, info: Option<&OutputInfo>) -> bool {
        let mut state = self.state();
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
        let extent = Extent::of(units, mode, scale, self.borne.viewport.is_some());
        let is_new = state.extent != Some(extent);
        if is_new {
            // Seen or not, it has to have a picture of that size.
            (state.extent, state.waits_since) = (Some(extent), None);
        }
        is_new
    }
}

impl Drop for Borne {
    fn drop(&mut self) {
        // Of the surface that is dropped after this.
        if let Some(viewport) = &self.viewport {
            viewport.destroy();
        }
    }
}

/// The surfaces that there are.
#[derive(Debug, Clone, Default)]
pub(crate) struct OutputSurfaces(Arc<Mutex<Vec<Arc<OutputSurface>>>>);

impl OutputSurfaces {
    /// All of them.
    pub(crate) fn present(&self) -> Vec<Arc<OutputSurface>> {
        self.list().clone()
    }

    /// Whether none of them is seen at `now`, as far as the compositor tells.
    pub(crate) fn are_unseen(&self, now: Instant) -> bool {
        let unseen = |output_surface: &Arc<OutputSurface>| {
            let since = output_surface.state().waits_since;
            since.is_some_and(|since| now.saturating_duration_since(since) >= UNSEEN)
        };
        self.list().iter().all(unseen)
    }

    /// Takes another one.
    pub(super) fn add(&self, output_surface: OutputSurface) {
        self.list().push(Arc::new(output_surface));
    }

    /// Takes those away of which `is_gone` says so.
    pub(super) fn remove(&self, is_gone: impl Fn(&OutputSurface) -> bool) {
        self.list().retain(|output_surface| !is_gone(output_surface));
    }

    fn list(&self) -> MutexGuard<'_, Vec<Arc<OutputSurface>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The one that is this surface.
    pub(super) fn of_surface(&self, surface: &WlSurface) -> Option<Arc<OutputSurface>> {
        self.list().iter().find(|output_surface| output_surface.surface() == surface).cloned()
    }

    /// The one on this output.
    pub(super) fn of_output(&self, output: &WlOutput) -> Option<Arc<OutputSurface>> {
        self.list().iter().find(|output_surface| output_surface.borne.output == *output).cloned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_has_the_pixels_of_its_output_where_it_can_be_stretched() {
        let pixels = |units, mode, scale, stretched| Extent::of(units, mode, scale, stretched).pixels;
        // One and a half pixels for each unit, of which the compositor tells 2.
        assert_eq!(pixels((1280, 720), Some((1920, 1080)), 2, true), (1920, 1080));
        assert_eq!(pixels((1280, 720), Some((1920, 1080)), 2, false), (2560, 1440));
        assert_eq!(pixels((1280, 720), None, 2, true), (2560, 1440));
        assert_eq!(pixels((1280, 720), Some((0, 9)), 1, true), (1280, 720));
        assert_eq!(pixels((0, 0), None, 0, false), (1, 1), "nothing has no pixels");
        assert_eq!(pixels((u32::MAX, 1), None, 3, false), (u32::MAX, 3));
    }
}
