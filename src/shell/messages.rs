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

/// Messages to the show.
pub(crate) enum Message {
    /// An event of the window.
    Window(WindowEvent),
    /// The connected monitors, on Wayland. On X11 [`super::monitors`] asks for them.
    Monitors(Vec<Monitor>),
    /// The requested window of the output.
    Output(SharedWindow),
    /// An event of the output's window.
    OutputEvent(WindowEvent),
    /// A request of assistive technology.
    Assistance(Assistance),
    /// Another thread has work for the show.
    Wake,
    End,
}

/// A shared flag: while keys are text, no letter ends the show. The show's thread sets it.
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

/// Creates the show's inbox, with its sender and a waker for other threads.
pub(crate) fn inbox() -> (Waker, Sender<Message>, Receiver<Message>) {
    let (sender, inbox) = channel();
    let of_waker = sender.clone();
    // After the end of the show, messages are dropped.
    (Waker::new(move || drop(of_waker.send(Message::Wake))), sender, inbox)
}

/// Messages to the window's thread.
#[derive(Debug)]
pub(crate) enum WindowMessage {
    Ended,
    /// A signal requests the end.
    End,
    /// A request of assistive technology.
    Assistance(Assistance),
    /// The show's current controls.
    Controls(Box<TreeUpdate>),
    /// Requests a window for the output on this monitor.
    OpenOutput(Monitor),
    CloseOutput,
    /// The show has called a window and may have queued events: see [`SharedWindow`].
    CallsMade,
}
