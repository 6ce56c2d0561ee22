//! What the window's thread and the show's thread send each other.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};

use egui::accesskit::TreeUpdate;
use winit::event::WindowEvent;

use crate::session::waker::Waker;
use crate::shell::monitors::Monitor;
use crate::shell::shared_window::SharedWindow;
use crate::ui::overlay::Assistance;

/// What the show receives.
pub(crate) enum Message {
    /// Something happened to the window.
    Window(WindowEvent),
    /// These monitors are there, where X11 does not tell.
    Monitors(Vec<Monitor>),
    /// The window of the output, which was asked for.
    Output(SharedWindow),
    /// Something happened to it.
    OutputEvent(WindowEvent),
    /// Assistive technology asks for something.
    Assistance(Assistance),
    /// Another thread has something for the show.
    Wake,
    /// The window is closed, or is to be.
    End,
}

/// Whether keys are text at present, which the show knows: then no letter ends it.
#[derive(Debug, Clone, Default)]
pub(crate) struct Typing(Arc<AtomicBool>);

impl Typing {
    /// Notes whether keys are text from now on.
    pub(crate) fn set(&self, on: bool) {
        self.0.store(on, Ordering::Relaxed);
    }

    /// Whether they are.
    pub(crate) fn is_on(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// What wakes a show, where its messages are sent, and where it gets them.
pub(crate) fn inbox() -> (Waker, Sender<Message>, Receiver<Message>) {
    let (sender, inbox) = channel();
    let of_waker = sender.clone();
    // After the end there is nobody to wake.
    (Waker::new(move || drop(of_waker.send(Message::Wake))), sender, inbox)
}

/// What the window's thread receives.
#[derive(Debug)]
pub(crate) enum WindowMessage {
    /// The show has ended.
    Ended,
    /// A signal asks for the end.
    End,
    /// Assistive technology asks the show for something.
    Assistance(Assistance),
    /// The show has these controls now.
    Controls(Box<TreeUpdate>),
    /// The show wants a window for its output on this monitor.
    OpenOutput(Monitor),
    /// It needs that no longer.
    CloseOutput,
    /// The show has called a window, which may have queued events: see [`SharedWindow`].
    CallsMade,
}
