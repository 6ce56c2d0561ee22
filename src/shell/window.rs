//! A window with a context of OpenGL 3.3 core or of OpenGL ES 3.0: opening, binding, resizing and showing frames.

#![expect(unsafe_code, reason = "glutin's functions that create contexts from window handles are unsafe")]

mod gl_display;
mod second;
#[cfg(all(unix, not(target_os = "macos")))]
mod wayland;

use std::cell::Cell;
use std::num::NonZeroU32;
use std::sync::Arc;

use glutin::config::ConfigTemplateBuilder;
use glutin::context::{NotCurrentGlContext, PossiblyCurrentContext, PossiblyCurrentGlContext};
use glutin::display::{GetGlDisplay, GlDisplay};
use glutin::error::ErrorKind;
use glutin::surface::{GlSurface, Surface, WindowSurface};
use winit::dpi::{PhysicalPosition, PhysicalSize};
use winit::event_loop::{ActiveEventLoop, EventLoopProxy};
use winit::raw_window_handle::RawWindowHandle;
use winit::window::{Window, WindowAttributes};

use crate::gpu::api::Api;
use crate::gpu::{Gl, GpuError};
use crate::session::SessionError;
use crate::shell::identity;
use crate::shell::messages::WindowMessage;
use crate::shell::monitors::{Rect, overlap};
use crate::shell::shared_window::{SharedWindow, WindowCalls, surface_attributes};
use second::grounded;
pub(crate) use second::{DrawTarget, Ground, SecondSurface, open_output};
#[cfg(all(unix, not(target_os = "macos")))]
pub(crate) use wayland::wayland_connection;

pub(crate) struct WindowOptions {
    pub title: String,
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// Position of the window's frame on the desktop, in pixels; `None` lets the system choose.
    pub place: Option<(i32, i32)>,
    pub visible: bool,
    pub log_debug: bool,
    /// Where a wallpaper or screen saver, which takes no input, is drawn; `None` for a normal window.
    pub ground: Option<Ground>,
}

/// A window without a context. The show's thread, not the window's, binds the context, because drivers are slow.
pub(crate) struct OpenWindow {
    pub(crate) config: glutin::config::Config,
    window: SharedWindow,
    /// The size in the last event. A query would end the process if another program has closed the window.
    size: Cell<(u32, u32)>,
    /// The position in the last event; `None` if the window system does not report it.
    pub(crate) place: Cell<Option<(i32, i32)>>,
    pub(crate) refresh_rate: Option<f64>,
    log_debug: bool,
}

pub(crate) struct GlWindowContext {
    // Dropped in this order: context, surface, window.
    pub(crate) gl: Gl,
    context: PossiblyCurrentContext,
    surface: Surface<WindowSurface>,
    pub(crate) open: OpenWindow,
}

impl OpenWindow {
    /// Opens a window whose events arrive on the thread behind `events`. The second result is the window's handle for
    /// use on that thread.
    pub(crate) fn open(
        event_loop: &ActiveEventLoop,
        events: &EventLoopProxy<WindowMessage>,
        input_queue: &WindowOptions,
    ) -> Result<(Self, Arc<Window>), SessionError> {
        let no_context = |error: &dyn std::fmt::Display| SessionError::NoContext(error.to_string());
        let attributes = WindowAttributes::default()
            .with_title(&input_queue.title)
            .with_inner_size(PhysicalSize::new(input_queue.size.0, input_queue.size.1))
            // AccessKit must be set up before the window is visible.
            .with_visible(false);
        let monitors = event_loop.available_monitors();
        let monitors = monitors.map(|monitor| (monitor.position().into(), monitor.size().into()));
        let place = input_queue.place.filter(|place| can_be_grasped(*place, input_queue.size, monitors));
        let attributes = match place {
            Some((x, y)) => attributes.with_position(PhysicalPosition::new(x, y)),
            None => attributes,
        };
        let attributes = grounded(identity::reported_by(attributes), input_queue.ground);
        let template =
            ConfigTemplateBuilder::new().with_alpha_size(0).with_depth_size(0).with_stencil_size(0);
        let opened =
            gl_display::open(event_loop, attributes, template).map_err(|error| no_context(&error))?;
        let (window, config) =
            opened.ok_or_else(|| no_context(&"the driver has no pixel format for a window"))?;
        if input_queue.ground.is_some()
            && let Err(error) = window.set_cursor_hittest(false)
        {
            tracing::warn!("the wallpaper cannot let clicks through: {error}");
        }
        let size = Cell::new(window.inner_size().into());
        let place = Cell::new(window.outer_position().ok().map(Into::into));
        let millihertz = window.current_monitor().and_then(|monitor| monitor.refresh_rate_millihertz());
        let refresh_rate = millihertz.filter(|rate| *rate > 0).map(|rate| f64::from(rate) / 1000.0);
        let own = Arc::new(window);
        let window = shared(event_loop, events, own.clone())?;
        Ok((Self { config, window, size, place, refresh_rate, log_debug: input_queue.log_debug }, own))
    }

    pub(crate) fn handle(&self) -> RawWindowHandle {
        self.window.handle()
    }

    pub(crate) fn bind(self) -> Result<GlWindowContext, SessionError> {
        let Self { config, window, log_debug, .. } = &self;
        let no_context = |error: &dyn std::fmt::Display| SessionError::NoContext(error.to_string());
        let handle = window.handle();
        let display = config.display();
        let apis = Api::tried()?;
        // SAFETY: the handle belongs to `window`, which `GlWindowContext` keeps until after context and surface (order
        // of its fields).
        let (context, surface) = unsafe {
            let context = Api::create_context(apis, &display, config, Some(handle))
                .map_err(|error| no_context(&error))?;
            let surface = display
                .create_window_surface(
                    config,
                    &surface_attributes(handle, window.calls().inner_size().into()),
                )
                .map_err(|error| no_context(&error))?;
            (context, surface)
        };
        let context = context.make_current(&surface).map_err(|error| no_context(&error))?;
        let gl = Gl::load(|name| display.get_proc_address(name), *log_debug)?;
        tracing::info!("window context by {}", config.display().version_string());
        let bound = GlWindowContext { gl, context, surface, open: self };
        bound.wait_for_monitor(true);
        Ok(bound)
    }
}

impl GlWindowContext {
    /// Drops the context and its surface, but not the window. All objects in the context must have been dropped before.
    pub(crate) fn let_go(self) -> OpenWindow {
        let Self { gl, context, surface, open } = self;
        drop(gl);
        // A surface that is current would stay alive, and a window cannot have two surfaces.
        if let Err(error) = context.make_not_current() {
            tracing::warn!("the old context cannot be released: {error}");
        }
        drop(surface);
        OpenWindow { log_debug: false, ..open }
    }

    pub(crate) fn window(&self) -> WindowCalls<'_> {
        self.open.window.calls()
    }

    pub(crate) fn request_redraw(&self) {
        self.open.window.request_redraw();
    }

    pub(crate) fn size(&self) -> Option<(u32, u32)> {
        let (width, height) = self.open.size.get();
        (width > 0 && height > 0).then_some((width, height))
    }

    pub(crate) fn resize(&self, size: (u32, u32)) {
        self.open.size.set(size);
        if let (Some(width), Some(height)) = (NonZeroU32::new(size.0), NonZeroU32::new(size.1)) {
            self.surface.resize(&self.context, width, height);
        }
    }

    /// Shows the drawn frame. Waits for vertical sync, if it is on.
    pub(crate) fn swap(&self) -> Result<(), SessionError> {
        self.open.window.pre_present_notify();
        self.surface.swap_buffers(&self.context).map_err(not_shown)
    }

    pub(crate) fn is_fullscreen(&self) -> bool {
        self.open.window.is_fullscreen()
    }
}

/// The error of the window system, which refuses what it was asked for.
pub(crate) fn refused(doing: &'static str, error: &dyn std::fmt::Display) -> SessionError {
    SessionError::Window { doing, reason: error.to_string() }
}

/// The error of a frame that the driver did not show.
fn not_shown(error: glutin::error::Error) -> SessionError {
    match error.error_kind() {
        ErrorKind::ContextLost => GpuError::ContextLost("showing a frame").into(),
        _ => refused("to show a frame", &error),
    }
}

pub(crate) fn shared(
    event_loop: &ActiveEventLoop,
    events: &EventLoopProxy<WindowMessage>,
    window: Arc<Window>,
) -> Result<SharedWindow, SessionError> {
    #[cfg(all(unix, not(target_os = "macos")))]
    let events = winit::platform::x11::ActiveEventLoopExtX11::is_x11(event_loop).then(|| {
        let events = events.clone();
        // After the end of the event loop, waking does nothing.
        crate::session::waker::Waker::new(move || drop(events.send_event(WindowMessage::CallsMade)))
    });
    #[cfg(not(all(unix, not(target_os = "macos"))))]
    let events = (event_loop, events, None).2;
    SharedWindow::new(window, events).map_err(|error| refused("a window for drawing", &error))
}

/// Width and height of the smallest part of a window's upper edge by which the user can drag the window, in pixels.
const GRASP: (u32, u32) = (64, 24);

/// True if the user can reach the upper edge of a window's frame at `place` on a monitor (positions and sizes). The
/// monitor of a saved position may have been disconnected.
fn can_be_grasped(place: (i32, i32), size: (u32, u32), mut monitors: impl Iterator<Item = Rect>) -> bool {
    let upper_edge = (place, (size.0, 2 * GRASP.1));
    monitors.any(|monitor| {
        let [across, down] = overlap(&upper_edge, &monitor);
        across >= i64::from(GRASP.0) && down >= i64::from(GRASP.1)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_position_outside_all_monitors_is_not_used() {
        let two = [((0, 0), (1920, 1080)), ((1920, 200), (1280, 1024))];
        let is_there = |place| can_be_grasped(place, (640, 360), two.into_iter());
        for place in [(0, 0), (1800, 900), (-500, 10), (2500, 1100), (100, -20), (3100, 300)] {
            assert!(is_there(place), "{place:?}");
        }
        for place in [
            (-600, 10),
            (3190, 300),
            (100, 1070),
            (2500, 100),
            (100, -40),
            (i32::MAX, i32::MIN),
            (i32::MIN, i32::MAX),
        ] {
            assert!(!is_there(place), "{place:?}");
        }
        assert!(!can_be_grasped((0, 0), (640, 360), [].into_iter()));
    }
}
