//! How a picture lies on its screen, and the copies of it that show there.

use crate::gpu::error::GpuError;
use crate::gpu::renderer::Renderer;
use crate::placement::{Area, Map, Placement, WHOLE, fitted, product, within};

/// How a picture lies on its screen.
pub(crate) struct Lay {
    /// What it loses, and where its corners are.
    pub(crate) placement: Placement,
    /// Width and height of the screen that it is drawn for, in pixels.
    pub(crate) screen: (u32, u32),
    /// Whether it is one that is held: it keeps its shape on a screen of another one.
    pub(crate) is_held: bool,
}

/// A part of a window, and the part of the picture that fills it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Panel {
    /// Where it is in the window, as shares of it.
    pub(crate) area: Area,
    /// From places in the area to places in the picture.
    pub(crate) map: Map,
    /// The part of the picture that shows.
    pub(crate) part: Area,
}

impl Lay {
    /// Copies the picture to the current window of `size` pixels, whose part `area` is the screen.
    ///
    /// # Errors
    /// What the driver refuses.
    pub(crate) fn show(&self, renderer: &mut Renderer, size: (u32, u32), area: Area) -> Result<(), GpuError> {
        let inner = self.inner(renderer);
        if self.placement.is_plain() && inner == WHOLE && area == WHOLE {
            return renderer.show(size);
        }
        renderer.show_placed(size, &self.map(renderer, area), self.placement.part())
    }

    /// The part of the screen that the picture fills.
    fn inner(&self, renderer: &Renderer) -> Area {
        let shape = renderer.shape().filter(|_| self.is_held);
        shape.map_or(WHOLE, |shape| fitted(self.placement.rest_of(shape), self.screen))
    }

    /// Fills a part of the current window of `size` pixels with the picture.
    ///
    /// # Errors
    /// What the driver refuses.
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

    /// Copies the picture into a part of the current window of `size` pixels, on a ground that is no part of it.
    ///
    /// # Errors
    /// What the driver refuses.
    pub(crate) fn show_small(
        &self,
        renderer: &mut Renderer,
        size: (u32, u32),
        area: Area,
    ) -> Result<(), GpuError> {
        let map = self.map(renderer, area);
        renderer.show_in_part(size, area, &map, self.placement.part())
    }

    /// Leads from a place in a window, of which `area` is the screen, to the place in the picture, both as shares.
    pub(crate) fn map(&self, renderer: &Renderer, area: Area) -> Map {
        within(area, &within(self.inner(renderer), &self.placement.map()))
    }

    /// The part of a window of `size` pixels that shows what the screen does.
    pub(crate) fn area_in(&self, size: (u32, u32)) -> Area {
        fitted(self.screen, size)
    }
}
