//! The output on another monitor: when its window opens and closes, and what it shows.

use std::time::{Duration, Instant};

use winit::event::WindowEvent;

use super::Stage;
use crate::app::desk_picture::{AROUND, is_within, small_in};
use crate::app::error::AppError;
use crate::app::monitors::Monitor;
use crate::app::overlay::Painted;
use crate::app::wallpaper::{Panel, Wallpaper, filling};
use crate::app::window::{GlWindowContext, SharedWindow};
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

    /// Fills a part of the current window of `size` pixels with the picture.
    fn show_panel(&self, renderer: &mut Renderer, size: (u32, u32), panel: Panel) -> Result<(), GpuError> {
        let Panel { area, map, part } = panel;
        let part = if self.placement.is_plain() { part } else { self.placement.part() };
        let map = within(area, &product(&self.placement.map(), &map));
        renderer.show_in_part(size, area, &map, part)
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

/// What shows the picture first: the desktop's ground, or else the window.
pub(super) struct Canvas<'a> {
    pub(super) renderer: &'a mut Renderer,
    pub(super) wallpaper: Option<&'a mut Wallpaper>,
    pub(super) window: &'a GlWindowContext,
    /// The window's, in pixels.
    pub(super) size: (u32, u32),
    /// The part of the window in which the picture lies small, on a ground that is no part of it.
    pub(super) small: Option<Area>,
}

impl Canvas<'_> {
    /// Shows the picture, which looks different if `is_new`, with what `paint` paints over so many pixels. Returns what was
    /// painted, and how long it took until the window system was to show it.
    ///
    /// # Errors
    /// What the driver refuses.
    pub(super) fn show(
        self,
        lay: &Lay,
        is_new: bool,
        paint: impl FnOnce((u32, u32)) -> Result<Painted, AppError>,
    ) -> Result<(Painted, Duration), AppError> {
        let begun = Instant::now();
        let Self { renderer, wallpaper, window, size, small } = self;
        let mut painted = Painted::default();
        match wallpaper {
            Some(wallpaper) if wallpaper.hides_window() => {
                let mut paint = Some(paint);
                wallpaper.show(window, is_new, |pixels, has_words| {
                    if lay.screen == pixels {
                        lay.show(renderer, pixels, WHOLE)?;
                    } else {
                        lay.show_panel(renderer, pixels, filling(lay.screen, pixels, WHOLE))?;
                    }
                    if let Some(paint) = paint.take_if(|_| has_words) {
                        painted = paint(pixels)?;
                    }
                    Ok(())
                })?;
                return Ok((painted, begun.elapsed()));
            }
            Some(wallpaper) if !wallpaper.panels(lay.screen).is_empty() => {
                for panel in wallpaper.panels(lay.screen) {
                    lay.show_panel(renderer, size, panel)?;
                }
            }
            _ => match small {
                Some(area) => {
                    window.gl().clear_window(size, AROUND)?;
                    let map = lay.map(renderer, area);
                    renderer.show_in_part(size, area, &map, lay.placement.part())?;
                }
                None => lay.show(renderer, size, lay.area_in(size))?,
            },
        }
        painted = paint(size)?;
        let painting = begun.elapsed();
        window.swap()?;
        Ok((painted, painting))
    }
}

impl Stage {
    /// The size that pictures are drawn for, in pixels: of the output, else of the window.
    pub(super) fn screen_size(&self) -> Option<(u32, u32)> {
        let of_ground = self.wallpaper.as_ref().and_then(Wallpaper::screen);
        let of_window = self.window.size().filter(|_| !self.hides_window());
        self.output.size().or(of_ground).or(of_window)
    }

    /// Takes the monitors of a window system that tells them by itself.
    pub(in crate::app) fn note_monitors(&mut self, monitors: Vec<Monitor>) {
        self.output.note_monitors(monitors);
    }

    /// Takes the output's window.
    pub(in crate::app) fn take_output(&mut self, window: SharedWindow) {
        if let Err(error) = self.output.take(window, &self.window) {
            let sentence = format!("there is no output on another monitor: {error}");
            tell(&sentence);
            self.reports.say(sentence);
            self.output.want(None);
        }
        self.window.request_redraw();
    }

    /// Takes an event of the output's window.
    pub(in crate::app) fn take_output_event(&mut self, event: &WindowEvent) {
        if self.output.take_event(event, &self.window) {
            self.window.request_redraw();
        }
    }

    /// Whether the window shows nothing, because surfaces of a Wayland desktop do.
    pub(super) fn hides_window(&self) -> bool {
        self.wallpaper.as_ref().is_some_and(Wallpaper::hides_window)
    }

    /// Opens and closes the output as monitors come and go, and takes in where the desktop's ground is.
    pub(super) fn update_output(&mut self) {
        if let Some(wallpaper) = &mut self.wallpaper {
            wallpaper.update(&self.window);
        }
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
            self.window.request_redraw();
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

    /// Shows the picture on the output, if it shows another one.
    ///
    /// # Errors
    /// What the driver refuses.
    pub(super) fn show_on_output(&mut self, lay: &Lay, is_new: bool) -> Result<(), AppError> {
        let Some(surface) = self.output.due(is_new) else { return Ok(()) };
        let (renderer, size) = (&mut self.renderer, surface.size());
        self.window.draw_on(surface, || Ok(lay.show(renderer, size, WHOLE)?))
    }
}
