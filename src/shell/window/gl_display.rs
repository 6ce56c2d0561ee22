//! The OpenGL display of a window, from which contexts and surfaces are created.
//!
//! **On X11, OpenGL has its own connection.** A thread that waits for a reply reads everything that has arrived on
//! the connection and queues the events. If OpenGL shared winit's connection, drawing would take events off the
//! socket, and the event thread, which waits for that socket, would not wake. While the frame is unchanged, nothing
//! else wakes that thread, so keys and pings would wait for up to 30 s.

use std::error::Error;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

use glutin::config::{Config, ConfigTemplateBuilder, GlConfig};
use glutin_winit::{ApiPreference, DisplayBuilder};
use winit::event_loop::ActiveEventLoop;
use winit::window::{Window, WindowAttributes};

/// Opens a window with a pixel format for OpenGL. `None` if the driver has no suitable format.
pub(super) fn open(
    event_loop: &ActiveEventLoop,
    attributes: WindowAttributes,
    template: ConfigTemplateBuilder,
) -> Result<Option<(Window, Config)>, Box<dyn Error>> {
    #[cfg(all(unix, not(target_os = "macos")))]
    if winit::platform::x11::ActiveEventLoopExtX11::is_x11(event_loop) {
        return x11::open(event_loop, attributes, template);
    }
    let builder = DisplayBuilder::new()
        .with_preference(ApiPreference::PreferEgl)
        .with_window_attributes(Some(attributes));
    let built = unless_nothing_fits(|| {
        builder.build(event_loop, template, |configs| best(configs).unwrap_or_else(|| nothing_fits()))
    });
    let Some(built) = built else { return Ok(None) };
    let (window, config) = built?;
    Ok(Some((window.ok_or("the system opened no window")?, config)))
}

/// Returns the config with the least multisampling, because the renderer antialiases by itself.
fn best<'a>(configs: Box<dyn Iterator<Item = Config> + 'a>) -> Option<Config> {
    configs.min_by_key(GlConfig::num_samples)
}

#[cfg(all(unix, not(target_os = "macos")))]
mod x11 {
    #![expect(unsafe_code, reason = "glutin's displays and Xlib are C interfaces")]

    use super::*;

    use std::ptr::{NonNull, null};

    use glutin::display::{Display, DisplayApiPreference, GlDisplay};
    use winit::platform::x11::register_xlib_error_hook;
    use winit::raw_window_handle::{RawDisplayHandle, XlibDisplayHandle};
    use x11_dl::xlib::Xlib;

    pub(super) fn open(
        event_loop: &ActiveEventLoop,
        attributes: WindowAttributes,
        template: ConfigTemplateBuilder,
    ) -> Result<Option<(Window, Config)>, Box<dyn Error>> {
        let preference = DisplayApiPreference::EglThenGlx(Box::new(register_xlib_error_hook));
        // SAFETY: `own_connection` opens the handle's connection, and nothing ever closes it.
        let display = unsafe { Display::new(own_connection()?, preference)? };
        // SAFETY: the template contains no native window.
        let Some(config) = best(unsafe { display.find_configs(template.build())? }) else { return Ok(None) };
        let window = glutin_winit::finalize_window(event_loop, attributes, &config)?;
        Ok(Some((window, config)))
    }

    /// Opens a second connection to winit's X server. It is never closed, because drivers keep using the connection.
    fn own_connection() -> Result<RawDisplayHandle, Box<dyn Error>> {
        let library = Xlib::open()?;
        // SAFETY: a null name is allowed and means the environment's server; the display was checked to be non-null.
        let (display, screen) = unsafe {
            let display = (library.XOpenDisplay)(null());
            let display = NonNull::new(display).ok_or("the X server refuses a second connection")?;
            (display, (library.XDefaultScreen)(display.as_ptr()))
        };
        Ok(XlibDisplayHandle::new(Some(display.cast()), screen).into())
    }
}

/// The payload of an unwind for a driver without suitable pixel formats. glutin-winit requires a choice, so the picker
/// unwinds without printing anything, and [`unless_nothing_fits`] returns `None`.
struct NothingFits;

fn nothing_fits() -> ! {
    resume_unwind(Box::new(NothingFits))
}

/// Runs `work`; returns `None` if [`nothing_fits`] was called.
fn unless_nothing_fits<T>(work: impl FnOnce() -> T) -> Option<T> {
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(made) => Some(made),
        Err(reason) if reason.is::<NothingFits>() => None,
        Err(reason) => resume_unwind(reason),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_driver_without_any_pixel_format_was_a_panic() {
        assert!(unless_nothing_fits(|| nothing_fits()).is_none());
        assert_eq!(unless_nothing_fits(|| 7), Some(7));
    }
}
