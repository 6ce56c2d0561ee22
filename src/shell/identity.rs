//! By what a desktop knows the program: one name for its entry, its window and its player, and its icon.

use winit::window::{Icon, WindowAttributes};

/// The name of the desktop entry, the metadata and the icon (`assets/desktop`); the class of the window on X11 and its
/// application on Wayland; the entry that MPRIS tells.
pub const APP_ID: &str = "org.mariana.Mariana";

/// The icon for window managers that look for no desktop entry. Made by `cargo xtask desktop`.
const ICON: &[u8] = include_bytes!("../../assets/desktop/icons/128x128/apps/org.mariana.Mariana.png");

/// The attributes of a window that tells whose it is.
pub(crate) fn reported_by(attributes: WindowAttributes) -> WindowAttributes {
    #[cfg(all(unix, not(target_os = "macos")))]
    let attributes = {
        // Of X11 by its name, but Wayland reads the same field.
        use winit::platform::x11::WindowAttributesExtX11;
        attributes.with_name(APP_ID, "mariana")
    };
    attributes.with_window_icon(icon())
}

fn icon() -> Option<Icon> {
    let pixels = image::load_from_memory(ICON).ok()?.into_rgba8();
    let (width, height) = pixels.dimensions();
    Icon::from_rgba(pixels.into_raw(), width, height).ok()
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_icon_can_be_shown() {
        assert!(super::icon().is_some());
    }
}
