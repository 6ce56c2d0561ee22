//! The wallpaper on Wayland: a surface on each output, by the protocol wlr-layer-shell.
//!
//! winit supports only windows, so these surfaces have their own event queue on winit's connection, and a thread
//! serves this queue. The show draws into them ([`super::wall`]). Each surface asks the compositor for a callback
//! when the next frame is wanted; a covered surface never gets this callback.

mod output_surface;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;
use std::time::Duration;

use smithay_client_toolkit::compositor::{CompositorHandler, CompositorState, Region};
use smithay_client_toolkit::output::{OutputHandler, OutputState};
use smithay_client_toolkit::reexports::calloop::{EventLoop, LoopSignal};
use smithay_client_toolkit::reexports::calloop_wayland_source::WaylandSource;
use smithay_client_toolkit::reexports::protocols::wp::viewporter::client::{wp_viewport, wp_viewporter};
use smithay_client_toolkit::registry::{ProvidesRegistryState, RegistryState};
use smithay_client_toolkit::shell::WaylandSurface;
use smithay_client_toolkit::shell::wlr_layer::{
    Anchor, KeyboardInteractivity, Layer, LayerShell, LayerShellHandler, LayerSurface, LayerSurfaceConfigure,
};
use smithay_client_toolkit::{
    delegate_compositor, delegate_layer, delegate_output, delegate_registry, registry_handlers,
};
use wayland_client::globals::registry_queue_init;
use wayland_client::protocol::wl_output::{Transform, WlOutput};
use wayland_client::protocol::wl_surface::WlSurface;
use wayland_client::{Connection, EventQueue, QueueHandle, delegate_noop};
use winit::event_loop::{EventLoop as Windows, OwnedDisplayHandle};

use mariana_work::Background;
use output_surface::Borne;
pub(crate) use output_surface::{Extent, OutputSurface, OutputSurfaces};

use crate::session::{SessionError, Waker};
use crate::shell::messages::WindowMessage;
use crate::shell::window::{refused, wayland_connection};

/// True if this session's windows use Wayland. winit decides in the same way.
pub(crate) fn is_wayland() -> bool {
    ["WAYLAND_DISPLAY", "WAYLAND_SOCKET"]
        .into_iter()
        .any(|name| std::env::var(name).is_ok_and(|value| !value.is_empty()))
}

/// Creates the surfaces, and serves their events until this value is dropped.
pub(crate) struct Layers {
    output_surfaces: OutputSurfaces,
    is_over: Arc<AtomicBool>,
    signal: LoopSignal,
    thread: Background,
}

impl Layers {
    /// Starts on the compositor of `windows`. Wakes the show after each change.
    ///
    /// # Errors
    /// Fails if the compositor has no layer shell, or there is no output.
    pub(crate) fn start(windows: &Windows<WindowMessage>, waker: &Waker) -> Result<Self, SessionError> {
        let display = windows.owned_display_handle();
        let connection = wayland_connection(&display)?;
        let (mut ui_state, mut queue) = LayersState::begin(&connection, display, waker)?;
        // The replies contain the outputs.
        queue.roundtrip(&mut ui_state).map_err(|error| refused("a wallpaper", &error))?;
        let output_surfaces = ui_state.output_surfaces.clone();
        if output_surfaces.present().is_empty() {
            return Err(SessionError::NoMonitor);
        }
        let (sender, signals) = channel();
        let is_over = Arc::new(AtomicBool::new(false));
        let ends = is_over.clone();
        let obey = move || {
            let run = || -> Result<(), Box<dyn std::error::Error>> {
                let mut events = EventLoop::<LayersState>::try_new()?;
                let source = WaylandSource::new(connection, queue).insert(events.handle());
                source.map_err(|error| error.to_string())?;
                sender.send(events.get_signal())?;
                while !ends.load(Ordering::Acquire) {
                    events.dispatch(None, &mut ui_state)?;
                }
                Ok(())
            };
            if let Err(error) = run() {
                // The window's thread gets the error too, and ends the show.
                tracing::info!("no more events of the compositor can be read: {error}");
            }
        };
        let thread = Background::start("layers", obey);
        let thread = thread.map_err(|error| SessionError::NoThread(error.to_string()))?;
        let signal = signals.recv().map_err(|error| refused("a wallpaper", &error))?;
        Ok(Self { output_surfaces, is_over, signal, thread })
    }

    pub(crate) fn output_surfaces(&self) -> OutputSurfaces {
        self.output_surfaces.clone()
    }
}

impl Drop for Layers {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::Release);
        self.signal.wakeup();
        self.thread.finish(Duration::MAX);
    }
}

struct LayersState {
    registry: RegistryState,
    outputs: OutputState,
    compositor: CompositorState,
    shell: LayerShell,
    viewporter: wp_viewporter::WpViewporter,
    output_surfaces: OutputSurfaces,
    display: OwnedDisplayHandle,
    waker: Waker,
}

impl LayersState {
    /// Binds the compositor's globals.
    fn begin(
        connection: &Connection,
        display: OwnedDisplayHandle,
        waker: &Waker,
    ) -> Result<(Self, EventQueue<Self>), SessionError> {
        let (globals, queue) =
            registry_queue_init::<Self>(connection).map_err(|error| refused("a wallpaper", &error))?;
        let handle = queue.handle();
        let shell = LayerShell::bind(&globals, &handle).map_err(|_| SessionError::NoLayerShell)?;
        let compositor = CompositorState::bind(&globals, &handle);
        let ui_state = Self {
            registry: RegistryState::new(&globals),
            outputs: OutputState::new(&globals, &handle),
            compositor: compositor.map_err(|error| refused("a wallpaper", &error))?,
            shell,
            viewporter: globals.bind(&handle, 1..=1, ()).map_err(|error| refused("a wallpaper", &error))?,
            output_surfaces: OutputSurfaces::default(),
            display,
            waker: waker.clone(),
        };
        Ok((ui_state, queue))
    }

    /// Creates a surface on an output that has none.
    fn hang(&self, queue: &QueueHandle<Self>, output: WlOutput) {
        if self.output_surfaces.of_output(&output).is_some() {
            return;
        }
        let surface = self.compositor.create_surface(queue);
        match Region::new(&self.compositor) {
            // The surface takes no input and is opaque.
            Ok(empty) => surface.set_input_region(Some(empty.wl_region())),
            Err(error) => tracing::warn!("the wallpaper cannot let clicks through: {error}"),
        }
        if let Ok(all) = Region::new(&self.compositor) {
            all.add(0, 0, i32::MAX, i32::MAX);
            surface.set_opaque_region(Some(all.wl_region()));
        }
        let viewport = self.viewporter.get_viewport(&surface, queue, ());
        let layer = self.shell.create_layer_surface(
            queue,
            surface,
            Layer::Background,
            Some("wallpaper"),
            Some(&output),
        );
        layer.set_anchor(Anchor::TOP | Anchor::BOTTOM | Anchor::LEFT | Anchor::RIGHT);
        // Ignores the space that panels reserve.
        layer.set_exclusive_zone(-1);
        layer.set_keyboard_interactivity(KeyboardInteractivity::None);
        layer.commit();
        let name = self.outputs.info(&output).and_then(|info| info.name);
        let name = name.unwrap_or_else(|| "a monitor without a name".to_owned());
        let borne = Borne { output, layer, viewport, display: self.display.clone() };
        self.output_surfaces.add(OutputSurface::new(name, borne, queue.clone()));
    }

    /// Removes surfaces. A surface is destroyed when the show no longer draws into it.
    fn remove_surfaces(&self, is_gone: impl Fn(&OutputSurface) -> bool) {
        self.output_surfaces.remove(is_gone);
        self.waker.wake();
    }

    fn measure(&self, output_surface: &OutputSurface) {
        if output_surface.measure(self.outputs.info(output_surface.output()).as_ref()) {
            self.waker.wake();
        }
    }
}

impl CompositorHandler for LayersState {
    fn frame(&mut self, _: &Connection, _: &QueueHandle<Self>, surface: &WlSurface, _: u32) {
        if let Some(output_surface) = self.output_surfaces.of_surface(surface) {
            output_surface.answer();
            self.waker.wake();
        }
    }

    // Scale and transform are read from the surface's output instead.
    fn scale_factor_changed(&mut self, _: &Connection, _: &QueueHandle<Self>, _: &WlSurface, _: i32) {}
    fn transform_changed(&mut self, _: &Connection, _: &QueueHandle<Self>, _: &WlSurface, _: Transform) {}
    fn surface_enter(&mut self, _: &Connection, _: &QueueHandle<Self>, _: &WlSurface, _: &WlOutput) {}
    fn surface_leave(&mut self, _: &Connection, _: &QueueHandle<Self>, _: &WlSurface, _: &WlOutput) {}
}

impl OutputHandler for LayersState {
    fn output_state(&mut self) -> &mut OutputState {
        &mut self.outputs
    }

    fn new_output(&mut self, _: &Connection, queue: &QueueHandle<Self>, output: WlOutput) {
        self.hang(queue, output);
    }

    fn update_output(&mut self, _: &Connection, queue: &QueueHandle<Self>, output: WlOutput) {
        // Create the surface again if the compositor has closed it.
        self.hang(queue, output.clone());
        if let Some(output_surface) = self.output_surfaces.of_output(&output) {
            self.measure(&output_surface);
        }
    }

    fn output_destroyed(&mut self, _: &Connection, _: &QueueHandle<Self>, output: WlOutput) {
        self.remove_surfaces(|output_surface| *output_surface.output() == output);
    }
}

impl LayerShellHandler for LayersState {
    fn closed(&mut self, _: &Connection, _: &QueueHandle<Self>, layer: &LayerSurface) {
        self.remove_surfaces(|output_surface| output_surface.is_of(layer));
    }

    fn configure(
        &mut self,
        _: &Connection,
        _: &QueueHandle<Self>,
        layer: &LayerSurface,
        configure: LayerSurfaceConfigure,
        _: u32,
    ) {
        if let Some(output_surface) = self.output_surfaces.of_surface(layer.wl_surface()) {
            output_surface.give(configure.new_size);
            self.measure(&output_surface);
        }
    }
}

impl ProvidesRegistryState for LayersState {
    fn registry(&mut self) -> &mut RegistryState {
        &mut self.registry
    }

    registry_handlers![OutputState];
}

delegate_compositor!(LayersState);
delegate_layer!(LayersState);
delegate_output!(LayersState);
delegate_registry!(LayersState);
delegate_noop!(LayersState: wp_viewporter::WpViewporter);
delegate_noop!(LayersState: wp_viewport::WpViewport);
