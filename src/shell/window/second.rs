//! Additional windows and surfaces of one context: the output, wallpapers on Wayland, and windows without input.

#![expect(unsafe_code, reason = "glutin's functions that create surfaces from window handles are unsafe")]

use std::num::NonZeroU32;
use std::sync::Arc;

use glutin::context::PossiblyCurrentGlContext;
use glutin::display::{GetGlDisplay, GlDisplay};
use glutin::surface::{GlSurface, Surface, SwapInterval, WindowSurface};
use raw_window_handle::RawWindowHandle;
use winit::dpi::{PhysicalPosition, PhysicalSize};
use winit::event_loop::ActiveEventLoop;
use winit::window::{Window, WindowAttributes};

use super::{GlWindowContext, not_shown, refused};
use crate::session::SessionError;
use crate::shell::identity;
use crate::shell::monitors::{Monitor, Rect};
use crate::shell::shared_window::{SharedWindow, surface_attributes};

#[derive(Debug, Clone, Copy)]
pub(crate) enum Ground {
    /// Surfaces below all windows of a Wayland desktop; the window itself is invisible.
    Layers,
    /// Below all windows of an X11 desktop, on this rectangle.
    Desktop(Rect),
    /// Inside another program's X11 window of this size in pixels.
    #[cfg_attr(any(windows, target_os = "macos"), expect(dead_code, reason = "other systems have no X11"))]
    Within(u32, (u32, u32)),
}

pub(crate) struct SecondSurface {
    // Declared before its target, so that it is dropped first.
    surface: Surface<WindowSurface>,
    lies_on: Arc<dyn DrawTarget>,
    size: (u32, u32),
}

pub(crate) trait DrawTarget {
    /// Returns the handle for the driver; `None` if the target is closed.
    fn handle(&self) -> Option<RawWindowHandle>;

    fn is_about_to_show(&self);
}

impl DrawTarget for SharedWindow {
    fn handle(&self) -> Option<RawWindowHandle> {
        Some(SharedWindow::handle(self))
    }

    fn is_about_to_show(&self) {
        self.pre_present_notify();
    }
}

impl SecondSurface {
    pub(crate) fn size(&self) -> (u32, u32) {
        self.size
    }

    /// Resizes the surface; ignores an empty size.
    pub(crate) fn resize(&mut self, first: &GlWindowContext, size: (u32, u32)) {
        if let (Some(width), Some(height)) = (NonZeroU32::new(size.0), NonZeroU32::new(size.1)) {
            self.size = size;
            self.surface.resize(&first.context, width, height);
        }
    }
}

impl GlWindowContext {
    /// Creates a surface on another window of the same config. Only that surface waits for vertical sync from now on.
    pub(crate) fn second_surface(&self, window: SharedWindow) -> Result<SecondSurface, SessionError> {
        let size = window.calls().inner_size().into();
        let vertical_sync = SwapInterval::Wait(NonZeroU32::MIN);
        let second = self.surface_on(Arc::new(window), size, vertical_sync)?;
        self.wait_for_monitor(false);
        Ok(second)
    }

    /// Creates a surface of `size` pixels on a target.
    pub(crate) fn surface_on(
        &self,
        lies_on: Arc<dyn DrawTarget>,
        size: (u32, u32),
        interval: SwapInterval,
    ) -> Result<SecondSurface, SessionError> {
        let handle = lies_on.handle().ok_or_else(|| refused("a wallpaper", &"the surface was closed"))?;
        let (config, attributes) = (&self.open.config, surface_attributes(handle, size));
        let refused = |error: glutin::error::Error| refused("a second surface", &error);
        // SAFETY: the handle in `attributes` belongs to `lies_on`, which `SecondSurface` keeps until after the surface
        // (order of its fields).
        let surface = unsafe { config.display().create_window_surface(config, &attributes) };
        let second = SecondSurface { surface: surface.map_err(refused)?, lies_on, size };
        self.context.make_current(&second.surface).map_err(refused)?;
        if let Err(error) = second.surface.set_swap_interval(&self.context, interval) {
            tracing::info!("the vertical sync of a second surface cannot be set ({error})");
        }
        self.context.make_current(&self.surface).map_err(refused)?;
        Ok(second)
    }

    pub(crate) fn wait_for_monitor(&self, waits: bool) {
        let interval = if waits { SwapInterval::Wait(NonZeroU32::MIN) } else { SwapInterval::DontWait };
        if let Err(error) = self.surface.set_swap_interval(&self.context, interval) {
            tracing::info!("no vertical sync ({error}); only the frame cap limits the rate");
        }
    }

    /// Makes another surface current as the default framebuffer, calls `draw`, and shows the result.
    pub(crate) fn draw_on<T>(
        &self,
        second: &SecondSurface,
        draw: impl FnOnce() -> Result<T, SessionError>,
    ) -> Result<T, SessionError> {
        self.context.make_current(&second.surface).map_err(not_shown)?;
        let drawn = draw();
        second.lies_on.is_about_to_show();
        let shown = second.surface.swap_buffers(&self.context).map_err(not_shown);
        self.context.make_current(&self.surface).map_err(not_shown)?;
        drawn.and_then(|drawn| shown.map(|()| drawn))
    }
}

pub(super) fn grounded(attributes: WindowAttributes, ground: Option<Ground>) -> WindowAttributes {
    let Some(ground) = ground else { return attributes };
    let attributes = attributes.with_decorations(false).with_active(false);
    #[cfg(all(unix, not(target_os = "macos")))]
    {
        use winit::platform::x11::{WindowAttributesExtX11, WindowType};
        match ground {
            Ground::Layers => attributes,
            Ground::Desktop(((x, y), _)) => attributes
                .with_position(PhysicalPosition::new(x, y))
                .with_x11_window_type(vec![WindowType::Desktop]),
            Ground::Within(window, _) => {
                attributes.with_position(PhysicalPosition::new(0, 0)).with_embed_parent_window(window)
            }
        }
    }
    #[cfg(not(all(unix, not(target_os = "macos"))))]
    {
        let _ = ground;
        attributes
    }
}

/// Opens a window without decorations or pointer that fills a monitor.
pub(crate) fn open_output(
    event_loop: &ActiveEventLoop,
    config: &glutin::config::Config,
    monitor: &Monitor,
) -> Result<Arc<Window>, SessionError> {
    let (place, size) = (monitor.place, monitor.size);
    let attributes = WindowAttributes::default()
        .with_title("Mariana's output")
        .with_decorations(false)
        .with_position(PhysicalPosition::new(place.0, place.1))
        .with_inner_size(PhysicalSize::new(size.0, size.1));
    let attributes = identity::reported_by(attributes);
    #[cfg(all(unix, not(target_os = "macos")))]
    let attributes = {
        use winit::platform::x11::{ActiveEventLoopExtX11, WindowAttributesExtX11};
        if event_loop.is_x11() {
            // Override redirect: window managers neither move nor cover the window.
            attributes.with_override_redirect(true)
        } else {
            let mut known = event_loop.available_monitors();
            let found = known.find(|known| known.name().as_deref() == Some(&*monitor.name));
            attributes.with_fullscreen(Some(winit::window::Fullscreen::Borderless(found)))
        }
    };
    let window = glutin_winit::finalize_window(event_loop, attributes, config)
        .map_err(|error| refused("a window for the output", &error))?;
    window.set_cursor_visible(false);
    Ok(Arc::new(window))
}
