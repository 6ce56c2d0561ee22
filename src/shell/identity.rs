//! The program's identity on the desktop: one id for the desktop entry, the window and the media player, and the icon.

use winit::window::{Icon, Theme, WindowAttributes};

/// The id of the desktop entry, the metadata and the icon (`assets/desktop`); the window's class on X11 and its app id
/// on Wayland; the desktop entry in MPRIS.
pub const APP_ID: &str = "org.mariana.Mariana";

pub(crate) fn reported_by(attributes: WindowAttributes) -> WindowAttributes {
    #[cfg(all(unix, not(target_os = "macos")))]
    let attributes = {
        // The trait has the name of X11, but Wayland uses the same field.
        use winit::platform::x11::WindowAttributesExtX11;
        attributes.with_name(APP_ID, "mariana")
    };
    // Panels are dark on every system, so the title bar is too.
    attributes.with_window_icon(icon()).with_theme(Some(Theme::Dark))
}

/// The icon for window managers that ignore desktop entries.
fn icon() -> Option<Icon> {
    let pixels = image::load_from_memory(mariana_assets::ICON).ok()?.into_rgba8();
    let (width, height) = pixels.dimensions();
    Icon::from_rgba(pixels.into_raw(), width, height).ok()
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_icon_can_be_decoded() {
        assert!(super::icon().is_some());
    }
}
