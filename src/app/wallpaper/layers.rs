//! The ground of a Wayland desktop: a surface on each output, by the protocol wlr-layer-shell.
//!
//! winit knows windows alone, so these surfaces have a queue of events of their own on winit's connection, and a thread
//! that obeys it. The show draws into them ([`super::wall`]); each asks the compositor when it wants the next picture. A
//! surface that nobody sees is never answered.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use raw_window_handle::{RawWindowHandle, WaylandWindowHandle};
use smithay_client_toolkit::compositor::{CompositorHandler, CompositorState, Region};
use smithay_client_toolkit::output::{OutputHandler, OutputInfo, OutputState};
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
use wayland_client::{Connection, EventQueue, Proxy, QueueHandle, delegate_noop};
use winit::event_loop::{EventLoop as Windows, OwnedDisplayHandle};

use crate::app::error::AppError;
use crate::app::window::wayland_connection;
use crate::app::window_thread::{Told, Waker};

/// A surface that waits longer than this for its next picture to be wanted is not seen. Slow monitors have 24 pictures
/// a second.
const UNSEEN: Duration = Duration::from_secs(1);

/// Whether windows of this session are Wayland's. winit decides by the same.
pub(in crate::app) fn is_wayland() -> bool {
    ["WAYLAND_DISPLAY", "WAYLAND_SOCKET"]
        .into_iter()
        .any(|name| std::env::var(name).is_ok_and(|value| !value.is_empty()))
}

/// How large a surface is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::app) struct Extent {
    /// Width and height of its pictures, in pixels.
    pub(in crate::app) pixels: (u32, u32),
    /// The same in the compositor's units.
    units: (u32, u32),
    /// Pixels in one of these, where the compositor stretches no pictures.
    scale: u32,
}

impl Extent {
    /// Of a surface of this many units on an output with a `mode` of so many pixels, where that is known, and whole
    /// pixels per unit. Whoever can be stretched has the output's own pixels, be they a fraction of a unit.
    fn of(units: (u32, u32), mode: Option<(u32, u32)>, scale: u32, is_stretched: bool) -> Self {
        let units = (units.0.max(1), units.1.max(1));
        let scale = scale.max(1);
        let whole = (units.0.saturating_mul(scale), units.1.saturating_mul(scale));
        let pixels = mode.filter(|mode| is_stretched && mode.0 > 0 && mode.1 > 0).unwrap_or(whole);
        Self { pixels, units, scale }
    }
}

/// A surface on an output. Drop what draws into it before.
#[derive(Debug)]
pub(in crate::app) struct Sheet {
    output: WlOutput,
    name: String,
    viewport: Option<wp_viewport::WpViewport>,
    layer: LayerSurface,
    queue: QueueHandle<Desk>,
    state: Mutex<State>,
    // Last: whatever stands above is nothing without it.
    _display: OwnedDisplayHandle,
}

#[derive(Debug, Default)]
struct State {
    /// Width and height that the compositor gives it, in its units; none before.
    units: Option<(u32, u32)>,
    extent: Option<Extent>,
    /// Since when it waits for the compositor to want another picture; none if it does.
    waits_since: Option<Instant>,
}

impl Sheet {
    /// What the compositor calls its output.
    pub(in crate::app) fn name(&self) -> &str {
        &self.name
    }

    /// How large it is; none before the compositor has said so.
    pub(in crate::app) fn extent(&self) -> Option<Extent> {
        self.state().extent
    }

    /// Whether the compositor wants another picture.
    pub(in crate::app) fn is_ready(&self) -> bool {
        let state = self.state();
        state.extent.is_some() && state.waits_since.is_none()
    }

    /// What drivers draw into.
    pub(in crate::app) fn handle(&self) -> Option<RawWindowHandle> {
        let surface = std::ptr::NonNull::new(self.surface().id().as_ptr().cast())?;
        Some(WaylandWindowHandle::new(surface).into())
    }

    /// Lets pictures of this extent fill it, from the next one on.
    pub(in crate::app) fn fit(&self, extent: Extent) {
        let units = |side: u32| i32::try_from(side).unwrap_or(i32::MAX);
        match &self.viewport {
            Some(viewport) => viewport.set_destination(units(extent.units.0), units(extent.units.1)),
            None => self.surface().set_buffer_scale(units(extent.scale)),
        }
    }

    /// Asks to be told when a picture after the next one is wanted. To be called before each is shown.
    pub(in crate::app) fn ask(&self) {
        self.state().waits_since = Some(Instant::now());
        self.surface().frame(&self.queue, self.surface().clone());
    }

    fn surface(&self) -> &WlSurface {
        self.layer.wl_surface()
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes what is known of its output, and the units that it has been given. Returns whether its extent is another.
    fn measure(&self, info: Option<&OutputInfo>) -> bool {
        let mut state = self.state();
        let Some(units) = state.units else { return false };
        let mode = info.and_then(|info| {
            let (width, height) = info.modes.iter().find(|mode| mode.current)?.dimensions;
            let turned = matches!(
                info.transform,
                Transform::_90 | Transform::_270 | Transform::Flipped90 | Transform::Flipped270
            );
            let (width, height) = (u32::try_from(width).ok()?, u32::try_from(height).ok()?);
            Some(if turned { (height, width) } else { (width, height) })
        });
        let scale = info.and_then(|info| u32::try_from(info.scale_factor).ok()).unwrap_or(1);
        let extent = Extent::of(units, mode, scale, self.viewport.is_some());
        let is_new = state.extent != Some(extent);
        if is_new {
            // Seen or not, it has to have a picture of that size.
            (state.extent, state.waits_since) = (Some(extent), None);
        }
        is_new
    }
}

impl Drop for Sheet {
    fn drop(&mut self) {
        // Of the surface that is dropped after this.
        if let Some(viewport) = &self.viewport {
            viewport.destroy();
        }
    }
}

/// The surfaces that there are.
#[derive(Debug, Clone, Default)]
pub(in crate::app) struct Sheets(Arc<Mutex<Vec<Arc<Sheet>>>>);

impl Sheets {
    /// All of them.
    pub(in crate::app) fn present(&self) -> Vec<Arc<Sheet>> {
        self.list().clone()
    }

    /// Whether none of them is seen at `now`, as far as the compositor tells.
    pub(in crate::app) fn are_unseen(&self, now: Instant) -> bool {
        let unseen = |sheet: &Arc<Sheet>| {
            let since = sheet.state().waits_since;
            since.is_some_and(|since| now.saturating_duration_since(since) >= UNSEEN)
        };
        self.list().iter().all(unseen)
    }

    fn list(&self) -> MutexGuard<'_, Vec<Arc<Sheet>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn of_surface(&self, surface: &WlSurface) -> Option<Arc<Sheet>> {
        self.list().iter().find(|sheet| sheet.surface() == surface).cloned()
    }

    fn of_output(&self, output: &WlOutput) -> Option<Arc<Sheet>> {
        self.list().iter().find(|sheet| sheet.output == *output).cloned()
    }
}

/// What makes the surfaces and hears of them, until it is dropped.
pub(in crate::app) struct Layers {
    sheets: Sheets,
    is_over: Arc<AtomicBool>,
    signal: LoopSignal,
    thread: Option<JoinHandle<()>>,
}

impl Layers {
    /// Begins on the compositor of `windows`, and wakes the show whenever something is new.
    ///
    /// # Errors
    /// The compositor has no layer shell, or there is no output.
    pub(in crate::app) fn start(windows: &Windows<Told>, waker: &Waker) -> Result<Self, AppError> {
        let display = windows.owned_display_handle();
        let connection = wayland_connection(&display)?;
        let (mut desk, mut queue) = Desk::begin(&connection, display, waker).map_err(refused)??;
        // What it answers are the outputs.
        queue.roundtrip(&mut desk).map_err(|error| refused(error.into()))?;
        let sheets = desk.sheets.clone();
        if sheets.present().is_empty() {
            return Err(AppError::NoMonitor);
        }
        let (sender, signals) = channel();
        let is_over = Arc::new(AtomicBool::new(false));
        let ends = is_over.clone();
        let obey = move || {
            let run = || -> Result<(), Box<dyn std::error::Error>> {
                let mut events = EventLoop::<Desk>::try_new()?;
                let source = WaylandSource::new(connection, queue).insert(events.handle());
                source.map_err(|error| error.to_string())?;
                sender.send(events.get_signal())?;
                while !ends.load(Ordering::Acquire) {
                    events.dispatch(None, &mut desk)?;
                }
                Ok(())
            };
            if let Err(error) = run() {
                // The thread of the windows hears of it, too, and ends the show.
                tracing::info!("the compositor tells no more: {error}");
            }
        };
        let thread = std::thread::Builder::new().name("layers".into());
        let thread = thread.spawn(obey).map_err(|error| AppError::NoThread(error.to_string()))?;
        let signal = signals.recv().map_err(|error| refused(error.into()))?;
        Ok(Self { sheets, is_over, signal, thread: Some(thread) })
    }

    /// What it makes.
    pub(in crate::app) fn sheets(&self) -> Sheets {
        self.sheets.clone()
    }
}

impl Drop for Layers {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::Release);
        self.signal.wakeup();
        if let Some(thread) = self.thread.take()
            && thread.join().is_err()
        {
            tracing::warn!("the thread of the layers ended with a panic");
        }
    }
}

type Trouble = Box<dyn std::error::Error>;

fn refused(error: Trouble) -> AppError {
    AppError::Window { doing: "a wallpaper", reason: error.to_string() }
}

/// What the thread of the layers knows.
struct Desk {
    registry: RegistryState,
    outputs: OutputState,
    compositor: CompositorState,
    shell: LayerShell,
    viewporter: Option<wp_viewporter::WpViewporter>,
    sheets: Sheets,
    display: OwnedDisplayHandle,
    waker: Waker,
}

impl Desk {
    /// Asks the compositor what it has. The inner error is that it has no layer shell.
    fn begin(
        connection: &Connection,
        display: OwnedDisplayHandle,
        waker: &Waker,
    ) -> Result<Result<(Self, EventQueue<Self>), AppError>, Trouble> {
        let (globals, queue) = registry_queue_init::<Self>(connection)?;
        let handle = queue.handle();
        let Ok(shell) = LayerShell::bind(&globals, &handle) else { return Ok(Err(AppError::NoLayerShell)) };
        let desk = Self {
            registry: RegistryState::new(&globals),
            outputs: OutputState::new(&globals, &handle),
            compositor: CompositorState::bind(&globals, &handle)?,
            shell,
            viewporter: globals.bind(&handle, 1..=1, ()).ok(),
            sheets: Sheets::default(),
            display,
            waker: waker.clone(),
        };
        Ok(Ok((desk, queue)))
    }

    /// Makes a surface on an output that has none.
    fn hang(&self, queue: &QueueHandle<Self>, output: WlOutput) {
        if self.sheets.of_output(&output).is_some() {
            return;
        }
        let surface = self.compositor.create_surface(queue);
        match Region::new(&self.compositor) {
            // It takes no input, and nothing shows through it.
            Ok(empty) => surface.set_input_region(Some(empty.wl_region())),
            Err(error) => tracing::warn!("clicks do not go through the wallpaper: {error}"),
        }
        if let Ok(all) = Region::new(&self.compositor) {
            all.add(0, 0, i32::MAX, i32::MAX);
            surface.set_opaque_region(Some(all.wl_region()));
        }
        let viewport = self.viewporter.as_ref().map(|it| it.get_viewport(&surface, queue, ()));
        let layer = self.shell.create_layer_surface(
            queue,
            surface,
            Layer::Background,
            Some("wallpaper"),
            Some(&output),
        );
        layer.set_anchor(Anchor::TOP | Anchor::BOTTOM | Anchor::LEFT | Anchor::RIGHT);
        // Not moved aside by bars.
        layer.set_exclusive_zone(-1);
        layer.set_keyboard_interactivity(KeyboardInteractivity::None);
        layer.commit();
        let name = self.outputs.info(&output).and_then(|info| info.name);
        let sheet = Sheet {
            output,
            name: name.unwrap_or_else(|| "a monitor without a name".to_owned()),
            viewport,
            layer,
            queue: queue.clone(),
            state: Mutex::default(),
            _display: self.display.clone(),
        };
        self.sheets.list().push(Arc::new(sheet));
    }

    /// Takes surfaces away. Each is gone when nothing draws into it any more.
    fn take_down(&self, is_gone: impl Fn(&Sheet) -> bool) {
        self.sheets.list().retain(|sheet| !is_gone(sheet));
        self.waker.wake();
    }

    fn measure(&self, sheet: &Sheet) {
        if sheet.measure(self.outputs.info(&sheet.output).as_ref()) {
            self.waker.wake();
        }
    }
}

impl CompositorHandler for Desk {
    fn frame(&mut self, _: &Connection, _: &QueueHandle<Self>, surface: &WlSurface, _: u32) {
        if let Some(sheet) = self.sheets.of_surface(surface) {
            sheet.state().waits_since = None;
            self.waker.wake();
        }
    }

    // The output that a surface is made for tells scale and turn.
    fn scale_factor_changed(&mut self, _: &Connection, _: &QueueHandle<Self>, _: &WlSurface, _: i32) {}
    fn transform_changed(&mut self, _: &Connection, _: &QueueHandle<Self>, _: &WlSurface, _: Transform) {}
    fn surface_enter(&mut self, _: &Connection, _: &QueueHandle<Self>, _: &WlSurface, _: &WlOutput) {}
    fn surface_leave(&mut self, _: &Connection, _: &QueueHandle<Self>, _: &WlSurface, _: &WlOutput) {}
}

impl OutputHandler for Desk {
    fn output_state(&mut self) -> &mut OutputState {
        &mut self.outputs
    }

    fn new_output(&mut self, _: &Connection, queue: &QueueHandle<Self>, output: WlOutput) {
        self.hang(queue, output);
    }

    fn update_output(&mut self, _: &Connection, queue: &QueueHandle<Self>, output: WlOutput) {
        // The compositor may have closed its surface.
        self.hang(queue, output.clone());
        if let Some(sheet) = self.sheets.of_output(&output) {
            self.measure(&sheet);
        }
    }

    fn output_destroyed(&mut self, _: &Connection, _: &QueueHandle<Self>, output: WlOutput) {
        self.take_down(|sheet| sheet.output == output);
    }
}

impl LayerShellHandler for Desk {
    fn closed(&mut self, _: &Connection, _: &QueueHandle<Self>, layer: &LayerSurface) {
        self.take_down(|sheet| sheet.layer == *layer);
    }

    fn configure(
        &mut self,
        _: &Connection,
        _: &QueueHandle<Self>,
        layer: &LayerSurface,
        configure: LayerSurfaceConfigure,
        _: u32,
    ) {
        if let Some(sheet) = self.sheets.of_surface(layer.wl_surface()) {
            sheet.state().units = Some(configure.new_size);
            self.measure(&sheet);
        }
    }
}

impl ProvidesRegistryState for Desk {
    fn registry(&mut self) -> &mut RegistryState {
        &mut self.registry
    }

    registry_handlers![OutputState];
}

delegate_compositor!(Desk);
delegate_layer!(Desk);
delegate_output!(Desk);
delegate_registry!(Desk);
delegate_noop!(Desk: wp_viewporter::WpViewporter);
delegate_noop!(Desk: wp_viewport::WpViewport);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_has_the_pixels_of_its_output_where_it_can_be_stretched() {
        let pixels = |units, mode, scale, stretched| Extent::of(units, mode, scale, stretched).pixels;
        // One and a half pixels for each unit, of which the compositor tells 2.
        assert_eq!(pixels((1280, 720), Some((1920, 1080)), 2, true), (1920, 1080));
        assert_eq!(pixels((1280, 720), Some((1920, 1080)), 2, false), (2560, 1440));
        assert_eq!(pixels((1280, 720), None, 2, true), (2560, 1440));
        assert_eq!(pixels((1280, 720), Some((0, 9)), 1, true), (1280, 720));
        assert_eq!(pixels((0, 0), None, 0, false), (1, 1), "nothing has no pixels");
        assert_eq!(pixels((u32::MAX, 1), None, 3, false), (u32::MAX, 3));
    }
}
