//! Messages between the window's thread and the show's thread.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};

use egui::accesskit::TreeUpdate;
use winit::event::WindowEvent;

use crate::session::waker::Waker;
use crate::shell::monitors::Monitor;
use crate::shell::shared_window::SharedWindow;
use crate::ui::overlay::Assistance;

pub(crate) enum Message {
    Window(WindowEvent),
    /// The connected monitors, on Wayland. On X11 [`super::monitors`] asks for the monitors.
    Monitors(Vec<Monitor>),
    Output(SharedWindow),
    OutputEvent(WindowEvent),
    Assistance(Assistance),
    Wake,
    End,
}

/// A flag that the show's thread sets while keys type text, so that no letter ends the show.
#[derive(Debug, Clone, Default)]
pub(crate) struct Typing(Arc<AtomicBool>);

impl Typing {
    pub(crate) fn set(&self, on: bool) {
        self.0.store(on, Ordering::Relaxed);
    }

    pub(crate) fn is_on(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

pub(crate) fn inbox() -> (Waker, Sender<Message>, Receiver<Message>) {
    let (sender, inbox) = channel();
    let of_waker = sender.clone();
    // After the end of the show, messages are dropped.
    (Waker::new(move || drop(of_waker.send(Message::Wake))), sender, inbox)
}

#[derive(Debug)]
pub(crate) enum WindowMessage {
    Ended,
    /// The show has saved everything and only drops its objects.
    Saved,
    /// A signal requests the end.
    End,
    Assistance(Assistance),
    Controls(Box<TreeUpdate>),
    OpenOutput(Monitor),
    CloseOutput,
    /// The screen must neither lock nor go dark.
    KeepAwake(bool),
    /// The show has called a window, which may have left events in a queue: see [`SharedWindow`].
    #[cfg_attr(any(windows, target_os = "macos"), expect(dead_code, reason = "only X11 has such a queue"))]
    CallsMade,
}
