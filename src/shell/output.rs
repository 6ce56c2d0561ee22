//! The output: a window without panels that fills a monitor, while the first window keeps the panels.
//!
//! The window's thread opens all windows. One context draws into both windows, so the frame is drawn once. A
//! disconnected monitor loses its window, and gets a new window when it is connected again.

use winit::event::WindowEvent;
use winit::event_loop::EventLoopProxy;

use crate::session::{SessionError, Waker};
use crate::shell::messages::WindowMessage;
use crate::shell::monitors::{Monitor, MonitorWatch, named, names};
use crate::shell::shared_window::SharedWindow;
use crate::shell::window::{GlWindowContext, SecondSurface};

pub(crate) struct Output {
    proxy: EventLoopProxy<WindowMessage>,
    waker: Waker,
    monitors: MonitorWatch,
    wanted: Option<String>,
    state: State,
    /// True if the output's window does not show the current frame.
    is_stale: bool,
    reported_missing: bool,
}

enum State {
    Off,
    Asked(Monitor),
    On(Monitor, SecondSurface),
}

impl Output {
    /// Creates an output on the monitor with the name or number `wanted`; `None` uses no monitor. Requests windows
    /// through `proxy`.
    pub(crate) fn new(wanted: Option<String>, proxy: EventLoopProxy<WindowMessage>, waker: &Waker) -> Self {
        let mut output = Self {
            proxy,
            waker: waker.clone(),
            monitors: MonitorWatch::default(),
            wanted: None,
            state: State::Off,
            is_stale: false,
            reported_missing: false,
        };
        output.request(wanted);
        output
    }

    pub(crate) fn request(&mut self, wanted: Option<String>) {
        if wanted.is_some() {
            self.update_monitors();
        }
        (self.wanted, self.reported_missing) = (wanted, false);
    }

    pub(crate) fn update_monitors(&mut self) {
        self.monitors.begin(self.waker.waking());
    }

    pub(crate) fn set_monitors(&mut self, monitors: Vec<Monitor>) {
        tracing::info!("monitors: {}", names(&monitors));
        self.monitors.set(monitors);
    }

    pub(crate) fn monitors(&self) -> Vec<Monitor> {
        self.monitors.known().unwrap_or_default()
    }

    /// Opens and closes the window when monitors change. Returns a message for the user, if any.
    pub(crate) fn update(&mut self, ui_state: &GlWindowContext) -> Option<String> {
        let monitors = match &self.wanted {
            Some(_) => self.monitors.known()?,
            None => Vec::new(),
        };
        let aim = self.wanted.as_deref().and_then(|wanted| named(&monitors, wanted)).cloned();
        match (&self.state, aim) {
            (State::Off, Some(monitor)) => {
                self.reported_missing = false;
                self.send(WindowMessage::OpenOutput(monitor.clone()));
                self.state = State::Asked(monitor);
                None
            }
            (State::Asked(present) | State::On(present, _), Some(monitor)) => {
                // If the monitor has a new position or size, its window must be replaced.
                if *present != monitor {
                    self.close(ui_state);
                    self.waker.wake();
                }
                None
            }
            (state, None) => {
                let was_on = !matches!(state, State::Off);
                if was_on {
                    self.close(ui_state);
                }
                let wanted = self.wanted.as_ref()?;
                if std::mem::replace(&mut self.reported_missing, true) {
                    return None;
                }
                Some(match was_on {
                    true => format!(
                        "the monitor {wanted} was disconnected: connect it again to show the image there"
                    ),
                    false => format!(
                        "there is no monitor {wanted}, only {}: connect {wanted} to show the image there",
                        names(&monitors)
                    ),
                })
            }
        }
    }

    pub(crate) fn open(
        &mut self,
        window: SharedWindow,
        ui_state: &GlWindowContext,
    ) -> Result<(), SessionError> {
        if let State::Asked(monitor) = &self.state {
            let (monitor, surface) = (monitor.clone(), ui_state.second_surface(window)?);
            tracing::info!("the output is on {monitor}");
            (self.state, self.is_stale) = (State::On(monitor, surface), true);
        }
        Ok(())
    }

    /// Handles an event of the window. Returns true if something must be redrawn.
    pub(crate) fn handle_event(&mut self, event: &WindowEvent, ui_state: &GlWindowContext) -> bool {
        let State::On(_, surface) = &mut self.state else { return false };
        match event {
            WindowEvent::Resized(size) => surface.resize(ui_state, (*size).into()),
            WindowEvent::RedrawRequested => {}
            WindowEvent::CloseRequested | WindowEvent::Destroyed => {
                self.wanted = None;
                self.close(ui_state);
                return true;
            }
            _ => return false,
        }
        self.is_stale = true;
        true
    }

    /// Closes the window; the next update opens a new window if a monitor is still wanted.
    pub(crate) fn close(&mut self, ui_state: &GlWindowContext) {
        if let State::On(..) = std::mem::replace(&mut self.state, State::Off) {
            ui_state.wait_for_monitor(true);
        }
        self.send(WindowMessage::CloseOutput);
    }

    /// Returns the size of the window in pixels; `None` while it shows nothing.
    pub(crate) fn size(&self) -> Option<(u32, u32)> {
        self.surface().map(SecondSurface::size)
    }

    fn surface(&self) -> Option<&SecondSurface> {
        match &self.state {
            State::On(_, surface) => Some(surface),
            State::Off | State::Asked(_) => None,
        }
    }

    /// Returns the surface if it must be drawn, because a frame is new (`is_new`) or the surface is stale.
    pub(crate) fn due(&mut self, is_new: bool) -> Option<&SecondSurface> {
        let is_stale = std::mem::take(&mut self.is_stale);
        self.surface().filter(|_| is_new || is_stale)
    }

    pub(crate) fn redraw(&mut self) {
        self.is_stale = true;
    }

    pub(crate) fn is_stale(&self) -> bool {
        self.is_stale && self.size().is_some()
    }

    pub(crate) fn send(&self, reported: WindowMessage) {
        // After the end of the event loop, requests are dropped.
        let _ = self.proxy.send_event(reported);
    }
}
