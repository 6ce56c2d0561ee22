//! The pictures on the ground of a Wayland desktop: what draws into its surfaces, and which of them are due.

use std::sync::Arc;

use raw_window_handle::RawWindowHandle;

use super::layers::{Extent, Sheet, Sheets};
use crate::export::print::tell;
use crate::session::SessionError;
use crate::shell::window::{Bearer, GlWindowContext, SecondSurface};

/// See the module.
pub(crate) struct Wall {
    sheets: Sheets,
    hung: Vec<Hung>,
}

/// A surface of the compositor's, and what draws into it.
struct Hung {
    sheet: Arc<Sheet>,
    extent: Extent,
    /// None if the driver refuses.
    surface: Option<SecondSurface>,
    /// Whether it shows something else than it should.
    is_stale: bool,
    /// Whether it shows nothing of its size.
    is_blank: bool,
}

impl Bearer for Sheet {
    fn handle(&self) -> Option<RawWindowHandle> {
        self.handle()
    }

    fn is_about_to_show(&self) {
        self.ask();
    }
}

impl Hung {
    fn is_ready(&self) -> bool {
        self.surface.is_some() && self.sheet.is_ready()
    }
}

impl Wall {
    /// With nothing on it yet.
    pub(super) fn new(sheets: Sheets) -> Self {
        Self { sheets, hung: Vec::new() }
    }

    /// Takes in which surfaces there are, and how large.
    pub(super) fn update(&mut self, window: &GlWindowContext) {
        let present = self.sheets.present();
        self.hung.retain(|hung| {
            let stays = present.iter().any(|sheet| Arc::ptr_eq(sheet, &hung.sheet));
            if !stays {
                tracing::info!("the wallpaper leaves {}", hung.sheet.name());
            }
            stays
        });
        for sheet in present {
            let Some(extent) = sheet.extent() else { continue };
            let hung = self.hung.iter_mut().find(|hung| Arc::ptr_eq(&hung.sheet, &sheet));
            let before = hung.as_ref().map(|hung| hung.extent);
            match hung {
                Some(hung) if hung.extent == extent => continue,
                Some(hung) => {
                    (hung.extent, hung.is_stale, hung.is_blank) = (extent, true, true);
                    if let Some(surface) = &mut hung.surface {
                        surface.resize(window, extent.pixels);
                    }
                }
                None => self.hung.push(hang(&sheet, extent, window)),
            }
            sheet.fit(extent);
            if before.is_none_or(|before| before.pixels != extent.pixels) {
                let (width, height) = extent.pixels;
                tracing::info!("the wallpaper is on {} ({width}x{height})", sheet.name());
            }
        }
    }

    /// Lets everything go that belongs to the context; [`Self::update`] makes it anew.
    pub(super) fn let_go(&mut self) {
        self.hung.clear();
    }

    /// The size of the largest surface, in pixels.
    pub(super) fn screen(&self) -> Option<(u32, u32)> {
        let pixels = |size: &(u32, u32)| u64::from(size.0) * u64::from(size.1);
        self.hung.iter().map(|hung| hung.extent.pixels).max_by_key(pixels)
    }

    /// Whether a surface that is seen shows something else than it should.
    pub(super) fn is_due(&self) -> bool {
        self.hung.iter().any(|hung| hung.is_stale && hung.is_ready())
    }

    /// Whether a surface has no picture of its size yet.
    pub(super) fn has_blank(&self) -> bool {
        self.hung.iter().any(|hung| hung.is_blank && hung.is_ready())
    }

    /// Whether the compositor wants a picture on any.
    pub(super) fn is_ready(&self) -> bool {
        self.hung.iter().any(Hung::is_ready)
    }

    /// Whether it wants one where words stand: on the first.
    pub(super) fn shows_words(&self) -> bool {
        self.hung.first().is_some_and(Hung::is_ready)
    }

    /// All are to show something else.
    pub(super) fn look_different(&mut self) {
        self.hung.iter_mut().for_each(|hung| hung.is_stale = true);
    }

    /// Shows what is to be shown where the compositor wants it. `draw` gets the size in pixels, and whether words belong
    /// over it.
    ///
    /// # Errors
    /// What `draw` reports, or a lost surface.
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

/// A surface that shows nothing yet. If the driver refuses, that monitor goes without.
fn hang(sheet: &Arc<Sheet>, extent: Extent, window: &GlWindowContext) -> Hung {
    let surface = window.surface_of_sheet(sheet.clone(), extent.pixels);
    let surface = surface.inspect_err(|error| tell(&format!("no wallpaper on {}: {error}", sheet.name())));
    Hung { sheet: sheet.clone(), extent, surface: surface.ok(), is_stale: true, is_blank: true }
}
