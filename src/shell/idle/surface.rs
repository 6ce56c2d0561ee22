//! Wayland's protocol idle-inhibit: the screen stays on while a surface with an inhibitor is visible.

#![expect(unsafe_code, reason = "winit exposes the surfaces of its windows as pointers")]

use raw_window_handle::{HasWindowHandle as _, RawWindowHandle};
use smithay_client_toolkit::reexports::protocols::wp::idle_inhibit::zv1::client::{
    zwp_idle_inhibit_manager_v1::ZwpIdleInhibitManagerV1, zwp_idle_inhibitor_v1::ZwpIdleInhibitorV1,
};
use wayland_client::backend::ObjectId;
use wayland_client::globals::{GlobalListContents, registry_queue_init};
use wayland_client::protocol::wl_registry::{self, WlRegistry};
use wayland_client::protocol::wl_surface::WlSurface;
use wayland_client::{Connection, Dispatch, Proxy as _, QueueHandle, delegate_noop};
use winit::event_loop::ActiveEventLoop;
use winit::window::Window;

use crate::shell::window::wayland_connection;

/// The inhibitor of a window. Drop it before the window.
pub(crate) struct SurfaceInhibitor {
    connection: Connection,
    handle: QueueHandle<Ignored>,
    manager: ZwpIdleInhibitManagerV1,
    surface: WlSurface,
    inhibitor: Option<ZwpIdleInhibitorV1>,
}

impl SurfaceInhibitor {
    /// Returns `None` on other window systems, and if the compositor does not have the protocol.
    pub(crate) fn of(event_loop: &ActiveEventLoop, window: &Window) -> Option<Self> {
        let RawWindowHandle::Wayland(pointer) = window.window_handle().ok()?.as_raw() else { return None };
        let connection = wayland_connection(&event_loop.owned_display_handle()).ok()?;
        let (globals, queue) = registry_queue_init::<Ignored>(&connection).ok()?;
        let handle = queue.handle();
        let manager = globals.bind(&handle, 1..=1, ()).ok()?;
        // SAFETY: the pointer is a `wl_surface` of the same libwayland, and the window outlives this value.
        let id = unsafe { ObjectId::from_ptr(WlSurface::interface(), pointer.surface.as_ptr().cast()) };
        let surface = WlSurface::from_id(&connection, id.ok()?).ok()?;
        Some(Self { connection, handle, manager, surface, inhibitor: None })
    }

    pub(crate) fn set(&mut self, on: bool) {
        if let Some(inhibitor) = self.inhibitor.take() {
            inhibitor.destroy();
        }
        self.inhibitor = on.then(|| self.manager.create_inhibitor(&self.surface, &self.handle, ()));
        // winit reports a lost connection.
        let _ = self.connection.flush();
    }
}

/// Receives the events, which only the registry sends.
struct Ignored;

impl Dispatch<WlRegistry, GlobalListContents> for Ignored {
    fn event(
        _: &mut Self,
        _: &WlRegistry,
        _: wl_registry::Event,
        _: &GlobalListContents,
        _: &Connection,
        _: &QueueHandle<Self>,
    ) {
    }
}

delegate_noop!(Ignored: ZwpIdleInhibitManagerV1);
delegate_noop!(Ignored: ZwpIdleInhibitorV1);
