//! Draws the wallpaper on the surfaces of a Wayland desktop, and knows which surfaces need a frame.

use std::sync::Arc;

use raw_window_handle::RawWindowHandle;

use super::layers::{Extent, OutputSurface, OutputSurfaces};
use crate::export::print::print_message;
use crate::session::SessionError;
use crate::shell::window::{DrawTarget, GlWindowContext, SecondSurface};

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

impl DrawTarget for OutputSurface {
    fn handle(&self) -> Option<RawWindowHandle> {
        self.handle()
    }

    fn is_about_to_show(&self) {
        self.request_frame();
    }
}

impl Hung {
    fn is_ready(&self) -> bool {
        self.surface.is_some() && self.output_surface.is_ready()
    }
}

impl Wall {
    pub(super) fn new(output_surfaces: OutputSurfaces) -> Self {
        Self { output_surfaces, hung: Vec::new() }
    }

    pub(super) fn update(&mut self, window: &GlWindowContext) {
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

    pub(super) fn let_go(&mut self) {
        self.hung.clear();
    }

    pub(super) fn screen(&self) -> Option<(u32, u32)> {
        let pixels = |size: &(u32, u32)| u64::from(size.0) * u64::from(size.1);
        self.hung.iter().map(|hung| hung.extent.pixels).max_by_key(pixels)
    }

    pub(super) fn is_due(&self) -> bool {
        self.hung.iter().any(|hung| hung.is_stale && hung.is_ready())
    }

    pub(super) fn has_blank(&self) -> bool {
        self.hung.iter().any(|hung| hung.is_blank && hung.is_ready())
    }

    pub(super) fn is_ready(&self) -> bool {
        self.hung.iter().any(Hung::is_ready)
    }

    /// True if the compositor wants a frame on the first surface, which also shows text.
    pub(super) fn shows_words(&self) -> bool {
        self.hung.first().is_some_and(Hung::is_ready)
    }

    pub(super) fn redraw(&mut self) {
        self.hung.iter_mut().for_each(|hung| hung.is_stale = true);
    }

    /// Draws stale surfaces that want a frame: `draw` gets the size in pixels, and true if the surface shows text.
    pub(super) fn show(
        &mut self,
        window: &GlWindowContext,
        mut draw: impl FnMut((u32, u32), bool) -> Result<(), SessionError>,
    ) -> Result<(), SessionError> {
        for (place, hung) in self.hung.iter_mut().enumerate() {
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
    let surface = window.wayland_surface_of(output_surface.clone(), extent.pixels);
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
