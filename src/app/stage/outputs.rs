//! The output on another monitor: when its window opens and closes, and what it shows.

use std::sync::Arc;

use winit::event::WindowEvent;
use winit::window::Window;

use super::Stage;
use crate::app::desk_picture::{AROUND, is_within, small_in};
use crate::app::error::AppError;
use crate::app::monitors::Monitor;
use crate::app::wallpaper::{Panel, Wallpaper};
use crate::app::window::GlWindowContext;
use crate::export::print::tell;
use crate::gpu::error::GpuError;
use crate::gpu::renderer::Renderer;
use crate::placement::{Area, Map, Placement, WHOLE, fitted, product, within};

/// How a picture lies on its screen.
pub(super) struct Lay {
    pub(super) placement: Placement,
    /// Width and height of the screen that it is drawn for, in pixels.
    pub(super) screen: (u32, u32),
    /// Whether it is one that is held: it keeps its shape on a screen of another one.
    pub(super) is_held: bool,
}

impl Lay {
    /// Copies the picture to the current window of `size` pixels, whose part `area` is the screen.
    pub(super) fn show(&self, renderer: &mut Renderer, size: (u32, u32), area: Area) -> Result<(), GpuError> {
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

    /// Leads from a place in a window, of which `area` is the screen, to the place in the picture, both as shares.
    pub(super) fn map(&self, renderer: &Renderer, area: Area) -> Map {
        within(area, &within(self.inner(renderer), &self.placement.map()))
    }

    /// The part of a window of `size` pixels that shows what the screen does.
    pub(super) fn area_in(&self, size: (u32, u32)) -> Area {
        fitted(self.screen, size)
    }
}

impl Stage {
    /// The size that pictures are drawn for, in pixels: of the output, else of the window.
    pub(super) fn screen_size(&self) -> Option<(u32, u32)> {
        let of_ground = self.wallpaper.as_ref().and_then(Wallpaper::screen);
        self.output.size().or(of_ground).or(self.window.size())
    }

    /// Takes the monitors of a window system that tells them by itself.
    pub(in crate::app) fn note_monitors(&mut self, monitors: Vec<Monitor>) {
        self.output.note_monitors(monitors);
    }

    /// Takes the output's window.
    pub(in crate::app) fn take_output(&mut self, window: Arc<Window>) {
        if let Err(error) = self.output.take(window, &self.window) {
            let sentence = format!("there is no output on another monitor: {error}");
            tell(&sentence);
            self.reports.say(sentence);
            self.output.want(None);
        }
        self.window.window().request_redraw();
    }

    /// Takes an event of the output's window.
    pub(in crate::app) fn take_output_event(&mut self, event: &WindowEvent) {
        if self.output.take_event(event, &self.window) {
            self.window.window().request_redraw();
        }
    }

    /// Opens and closes the output as monitors come and go.
    pub(super) fn update_output(&mut self) {
        if let Some(place) = self.wallpaper.as_ref().and_then(Wallpaper::place)
            && self.grounded_at != Some(place)
        {
            self.grounded_at = Some(place);
            self.window.fill(place);
        }
        let was = self.output.size();
        if let Some(sentence) = self.output.update(&self.window) {
            tell(&sentence);
            self.reports.say(sentence);
        }
        if self.output.size() != was {
            self.window.window().request_redraw();
        }
    }

    /// Where in the window of `size` pixels the picture lies: as large as it can, or small beside the panels while an output
    /// shows it. It is large there, too, while its corners are moved, and where nothing else is to be seen.
    pub(super) fn note_area(&mut self, lay: &Lay, size: (u32, u32)) -> Area {
        let is_small = self.output.size().is_some() && !self.desk.bare && self.desk.corners.is_none();
        self.desk.picture = is_small.then(|| small_in(size, lay.screen));
        self.desk.picture.unwrap_or_else(|| lay.area_in(size))
    }

    /// Whether what the pointer does at a place of the window, in pixels, is meant for the picture.
    pub(super) fn is_for_picture(&self, place: (f64, f64)) -> bool {
        let size = self.window.size().unwrap_or_default();
        self.desk.picture.is_none_or(|area| is_within(area, size, place))
    }

    /// Shows the picture on every monitor, if it is the desktop's ground, and otherwise in a part of the window, with its size
    /// in pixels, as `lay` says; if it is small there, on a ground that is no part of it.
    ///
    /// # Errors
    /// What the driver refuses.
    pub(super) fn show_picture(
        renderer: &mut Renderer,
        (window, ground): (&GlWindowContext, Option<&Wallpaper>),
        lay: &Lay,
        (size, area, is_small): ((u32, u32), Area, bool),
    ) -> Result<(), GpuError> {
        if is_small {
            window.gl().clear_window(size, AROUND)?;
            return renderer.show_in_part(size, area, &lay.map(renderer, area), lay.placement.part());
        }
        let panels = ground.map(|ground| ground.panels(lay.screen)).unwrap_or_default();
        if panels.is_empty() {
            return lay.show(renderer, size, area);
        }
        let map = lay.placement.map();
        for Panel { area, map: of_panel, part } in panels {
            let part = if lay.placement.is_plain() { part } else { lay.placement.part() };
            let map = within(area, &product(&map, &of_panel));
            renderer.show_in_part(size, area, &map, part)?;
        }
        Ok(())
    }

    /// Moves the output to another monitor, or to none.
    pub(super) fn choose_output_monitor(&mut self, name: Option<String>) {
        self.output.want(name.clone());
        self.choose(move |choices| choices.stage.output.clone_from(&name));
    }

    /// Shows the picture on the output, if it shows another one.
    ///
    /// # Errors
    /// What the driver refuses.
    pub(super) fn show_on_output(&mut self, lay: &Lay, is_new: bool) -> Result<(), AppError> {
        let Some(surface) = self.output.due(is_new) else { return Ok(()) };
        let (renderer, size) = (&mut self.renderer, surface.size());
        self.window.draw_on(surface, || lay.show(renderer, size, WHOLE))
    }
}
