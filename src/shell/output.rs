//! The output: a window that fills a monitor with nothing but the picture, while the first window is the desk.
//!
//! It is opened on the thread of the window's events, like every window. One context draws into both windows, one after
//! the other: the picture is drawn once. A monitor that is pulled out takes its window along, and gets another one when it
//! is back.

use winit::event::WindowEvent;
use winit::event_loop::EventLoopProxy;

use crate::session::SessionError;
use crate::session::waker::Waker;
use crate::shell::messages::WindowMessage;
use crate::shell::monitors::{Monitor, MonitorWatch, named, names};
use crate::shell::shared_window::SharedWindow;
use crate::shell::window::{GlWindowContext, SecondSurface};

/// See the module.
pub(crate) struct Output {
    proxy: EventLoopProxy<WindowMessage>,
    waker: Waker,
    monitors: MonitorWatch,
    /// The monitor that it is to be on, by name or number.
    wanted: Option<String>,
    state: State,
    /// Whether it shows something else than it should.
    is_stale: bool,
    /// Whether it was told that the monitor is not there.
    reported_missing: bool,
}

enum State {
    Off,
    /// Its window is being opened.
    Asked(Monitor),
    On(Monitor, SecondSurface),
}

impl Output {
    /// On the monitor with this name or number, once it is there; none is on no monitor. Windows are asked for through
    /// `proxy`.
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
        output.want(wanted);
        output
    }

    /// Goes to another monitor, or to none.
    pub(crate) fn want(&mut self, wanted: Option<String>) {
        if wanted.is_some() {
            self.look_at_monitors();
        }
        (self.wanted, self.reported_missing) = (wanted, false);
    }

    /// Looks at the monitors from now on.
    pub(crate) fn look_at_monitors(&mut self) {
        let waker = self.waker.clone();
        self.monitors.begin(move || waker.wake());
    }

    /// Takes the monitors of a window system that tells them by itself.
    pub(crate) fn note_monitors(&mut self, monitors: Vec<Monitor>) {
        tracing::info!("monitors: {}", names(&monitors));
        self.monitors.note(monitors);
    }

    /// The monitors that are there.
    pub(crate) fn monitors(&self) -> Vec<Monitor> {
        self.monitors.known().unwrap_or_default()
    }

    /// Opens and closes its window as monitors come and go. Returns what there is to say.
    pub(crate) fn update(&mut self, ui_state: &GlWindowContext) -> Option<String> {
        let monitors = match &self.wanted {
            Some(_) => self.monitors.known()?,
            None => Vec::new(),
        };
        let aim = self.wanted.as_deref().and_then(|wanted| named(&monitors, wanted)).cloned();
        match (&self.state, aim) {
            (State::Off, Some(monitor)) => {
                self.reported_missing = false;
                self.ask(WindowMessage::OpenOutput(monitor.clone()));
                self.state = State::Asked(monitor);
                None
            }
            (State::Asked(present) | State::On(present, _), Some(monitor)) => {
                // Elsewhere, or of another size: a new window.
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
                    true => format!("the monitor {wanted} is gone: its picture comes back with it"),
                    false => format!(
                        "there is no monitor {wanted}, but {}: the picture comes onto it when it is there",
                        names(&monitors)
                    ),
                })
            }
        }
    }

    /// Takes its window, which was asked for.
    ///
    /// # Errors
    /// The driver refuses a second surface.
    pub(crate) fn take(
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

    /// Takes an event of its window. Returns whether something is to be shown anew.
    pub(crate) fn take_event(&mut self, event: &WindowEvent, ui_state: &GlWindowContext) -> bool {
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

    /// Closes its window; the next update opens one anew, if one is wanted.
    pub(crate) fn close(&mut self, ui_state: &GlWindowContext) {
        if let State::On(..) = std::mem::replace(&mut self.state, State::Off) {
            ui_state.wait_for_monitor(true);
        }
        self.ask(WindowMessage::CloseOutput);
    }

    /// Width and height of its window, in pixels, while it shows the picture.
    pub(crate) fn size(&self) -> Option<(u32, u32)> {
        match &self.state {
            State::On(_, surface) => Some(surface.size()),
            State::Off | State::Asked(_) => None,
        }
    }

    /// Its surface, if something else is to be shown there than is: another picture (`is_new`), or the same one.
    pub(crate) fn due(&mut self, is_new: bool) -> Option<&SecondSurface> {
        let is_stale = std::mem::take(&mut self.is_stale);
        match &self.state {
            State::On(_, surface) => Some(surface).filter(|_| is_new || is_stale),
            State::Off | State::Asked(_) => None,
        }
    }

    /// What it shows is to be shown anew.
    pub(crate) fn look_different(&mut self) {
        self.is_stale = true;
    }

    /// Whether it shows something else than it should.
    pub(crate) fn is_stale(&self) -> bool {
        self.is_stale && self.size().is_some()
    }

    fn ask(&self, reported: WindowMessage) {
        // After the end there is nobody to ask.
        let _ = self.proxy.send_event(reported);
    }
}
