//! Places a frame on its screen, and copies the frame there.

use crate::gpu::{GpuError, Renderer};
use crate::placement::{Area, Map, Placement, WHOLE, fitted, product, within};

/// How a screen shows a frame.
pub struct Lay {
    pub(crate) placement: Placement,
    /// Width and height of the target screen in pixels.
    pub(crate) screen: (u32, u32),
    /// True for a frozen frame, which keeps its aspect ratio on a screen with another aspect ratio.
    pub(crate) is_held: bool,
}

/// A part of a window, and the part of the frame that fills it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Panel {
    /// The part of the window, as fractions.
    pub(crate) area: Area,
    pub(crate) map: Map,
    /// The visible part of the frame.
    pub(crate) part: Area,
}

impl Lay {
    /// Copies the frame to the current window of `size` pixels; `area` of the window represents the screen.
    ///
    /// # Errors
    /// Fails if the driver reports an error.
    pub fn show(&self, renderer: &mut Renderer, size: (u32, u32), area: Area) -> Result<(), GpuError> {
        let inner = self.inner(renderer);
        if self.placement.is_plain() && inner == WHOLE && area == WHOLE {
            return renderer.show(size);
        }
        renderer.show_in_part(size, WHOLE, &self.map(renderer, area), self.placement.part())
    }

    fn inner(&self, renderer: &Renderer) -> Area {
        let shape = renderer.shape().filter(|_| self.is_held);
        shape.map_or(WHOLE, |shape| fitted(self.placement.rest_of(shape), self.screen))
    }

    pub(crate) fn show_panel(
        &self,
        renderer: &mut Renderer,
        size: (u32, u32),
        panel: Panel,
    ) -> Result<(), GpuError> {
        let Panel { area, map, part } = panel;
        let part = if self.placement.is_plain() { part } else { self.placement.part() };
        let map = within(area, &product(&self.placement.map(), &map));
        renderer.show_in_part(size, area, &map, part)
    }

    /// Copies the frame into the part `area` of the current window of `size` pixels, without changing the rest.
    ///
    /// # Errors
    /// Fails if the driver reports an error.
    pub fn show_small(&self, renderer: &mut Renderer, size: (u32, u32), area: Area) -> Result<(), GpuError> {
        let map = self.map(renderer, area);
        renderer.show_in_part(size, area, &map, self.placement.part())
    }

    /// Maps positions in a window to positions in the frame, as fractions; `area` of the window represents the screen.
    pub(crate) fn map(&self, renderer: &Renderer, area: Area) -> Map {
        within(area, &within(self.inner(renderer), &self.placement.map()))
    }

    /// The part of a window of `size` pixels that represents the whole screen.
    pub fn area_in(&self, size: (u32, u32)) -> Area {
        fitted(self.screen, size)
    }
}
