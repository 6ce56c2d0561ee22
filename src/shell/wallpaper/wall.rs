//! Draws the wallpaper on the surfaces of a Wayland desktop, and knows which surfaces need a frame.

use std::sync::Arc;

use glutin::surface::SwapInterval;

use super::layers::{Extent, OutputSurface, OutputSurfaces};
use crate::export::print::print_message;
use crate::session::SessionError;
use crate::shell::window::{GlWindowContext, SecondSurface};

pub(crate) struct Wall {
    output_surfaces: OutputSurfaces,
    hung: Vec<Hung>,
}

struct Hung {
    output_surface: Arc<OutputSurface>,
    extent: Extent,
    /// `None` if the driver refused the surface.
    surface: Option<SecondSurface>,
    /// True if the surface does not show the current frame.
    is_stale: bool,
    /// True if the surface has no frame of its size yet.
    is_blank: bool,
}

impl Hung {
    fn is_ready(&self) -> bool {
        self.surface.is_some() && self.output_surface.is_ready()
    }
}

impl Wall {
    pub(crate) fn new(output_surfaces: OutputSurfaces) -> Self {
        Self { output_surfaces, hung: Vec::new() }
    }

    pub(crate) fn update(&mut self, window: &GlWindowContext) {
        let present = self.output_surfaces.present();
        self.hung.retain(|hung| {
            let stays =
                present.iter().any(|output_surface| Arc::ptr_eq(output_surface, &hung.output_surface));
            if !stays {
                tracing::info!("the wallpaper leaves {}", hung.output_surface.name());
            }
            stays
        });
        for output_surface in present {
            let Some(extent) = output_surface.extent() else { continue };
            let hung = self.hung.iter_mut().find(|hung| Arc::ptr_eq(&hung.output_surface, &output_surface));
            let before = hung.as_ref().map(|hung| hung.extent);
            match hung {
                Some(hung) if hung.extent == extent => continue,
                Some(hung) => {
                    (hung.extent, hung.is_stale, hung.is_blank) = (extent, true, true);
                    if let Some(surface) = &mut hung.surface {
                        surface.resize(window, extent.pixels);
                    }
                }
                None => self.hung.push(hang(&output_surface, extent, window)),
            }
            output_surface.fit(extent);
            if before.is_none_or(|before| before.pixels != extent.pixels) {
                let (width, height) = extent.pixels;
                tracing::info!("the wallpaper is on {} ({width}x{height})", output_surface.name());
            }
        }
    }

    /// Drops everything that belongs to the OpenGL context.
    pub(crate) fn let_go(&mut self) {
        self.hung.clear();
    }

    /// Returns the size of the frame, which is the size of the largest surface.
    pub(crate) fn screen(&self) -> Option<(u32, u32)> {
        let pixels = |size: &(u32, u32)| u64::from(size.0) * u64::from(size.1);
        self.hung.iter().map(|hung| hung.extent.pixels).max_by_key(pixels)
    }

    /// True if a visible surface is stale.
    pub(crate) fn is_due(&self) -> bool {
        self.hung.iter().any(|hung| hung.is_stale && hung.is_ready())
    }

    /// True if no surface wants a frame, or if the wallpaper `is_paused`. A surface without a frame is drawn first.
    pub(crate) fn rests(&self, is_paused: bool) -> bool {
        let has_blank = self.hung.iter().any(|hung| hung.is_blank && hung.is_ready());
        !has_blank && (is_paused || !self.hung.iter().any(Hung::is_ready))
    }

    /// True if the compositor wants a frame on the first surface, which also shows text.
    pub(crate) fn shows_words(&self) -> bool {
        self.hung.first().is_some_and(Hung::is_ready)
    }

    /// Draws the stale surfaces that want a frame, or all of them if `is_new`. `draw` gets the size in pixels, and true
    /// if the surface shows text.
    pub(crate) fn show(
        &mut self,
        window: &GlWindowContext,
        is_new: bool,
        mut draw: impl FnMut((u32, u32), bool) -> Result<(), SessionError>,
    ) -> Result<(), SessionError> {
        for (place, hung) in self.hung.iter_mut().enumerate() {
            hung.is_stale |= is_new;
            let is_due = hung.is_stale && hung.is_ready();
            let Some(surface) = hung.surface.as_ref().filter(|_| is_due) else { continue };
            window.draw_on(surface, || draw(hung.extent.pixels, place == 0))?;
            (hung.is_stale, hung.is_blank) = (false, false);
        }
        Ok(())
    }
}

/// Creates the OpenGL surface. If the driver refuses, the output has no wallpaper.
fn hang(output_surface: &Arc<OutputSurface>, extent: Extent, window: &GlWindowContext) -> Hung {
    // Showing a frame never waits: the compositor requests each frame.
    let surface = window.surface_on(output_surface.clone(), extent.pixels, SwapInterval::DontWait);
    let surface = surface
        .inspect_err(|error| print_message(&format!("no wallpaper on {}: {error}", output_surface.name())));
    Hung {
        output_surface: output_surface.clone(),
        extent,
        surface: surface.ok(),
        is_stale: true,
        is_blank: true,
    }
}
