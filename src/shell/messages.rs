//! Messages between the window's thread and the show's thread.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};

use egui::accesskit::TreeUpdate;
use winit::event::WindowEvent;

use crate::commands::Command;
use crate::input::{Input, Key, Modifiers};
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

/// A flag that the show's thread sets while keys type text, so that no letter ends the show. It also counts the keys on
/// their way to the show that may open a text.
#[derive(Debug, Clone, Default)]
pub(crate) struct Typing(Arc<(AtomicBool, AtomicUsize)>);

impl Typing {
    /// Sets the flag, after the show has taken `keys` of the counted keys.
    pub(crate) fn set(&self, on: bool, keys: usize) {
        self.0.0.store(on, Ordering::SeqCst);
        self.0.1.fetch_sub(keys, Ordering::SeqCst);
    }

    /// Counts a key that may open a text.
    pub(crate) fn send_key(&self) {
        self.0.1.fetch_add(1, Ordering::SeqCst);
    }

    /// True if the next key may type text.
    pub(crate) fn is_on(&self) -> bool {
        self.0.1.load(Ordering::SeqCst) > 0 || self.0.0.load(Ordering::SeqCst)
    }
}

/// True for a key that may open a text, to which the next keys belong.
pub(crate) fn may_open_text(input: &Input) -> bool {
    let Input::Key(press) = input else { return false };
    match Command::of_key(&press.key, Modifiers::empty(), press.repeat) {
        Some(Command::TogglePanel(_) | Command::ToggleHelp) => true,
        Some(_) => false,
        None => matches!(press.key, Key::Character(_)),
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
    /// A request of a screen reader or the like, which AccessKit sends to the event loop.
    Assistance(Assistance),
    /// The show's controls, for screen readers.
    Controls(Box<TreeUpdate>),
    OpenOutput(Monitor),
    CloseOutput,
    /// The screen must neither lock nor go dark.
    KeepAwake(bool),
    /// The show has called a window, which may have left events in a queue: see [`SharedWindow`].
    #[cfg_attr(any(windows, target_os = "macos"), expect(dead_code, reason = "only X11 has such a queue"))]
    CallsMade,
}

impl From<accesskit_winit::Event> for WindowMessage {
    fn from(event: accesskit_winit::Event) -> Self {
        use accesskit_winit::WindowEvent;
        Self::Assistance(match event.window_event {
            WindowEvent::InitialTreeRequested => Assistance::Begins,
            WindowEvent::ActionRequested(request) => Assistance::Act(request),
            WindowEvent::AccessibilityDeactivated => Assistance::Ends,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::{KeyPress, NamedKey};

    #[test]
    fn a_letter_right_after_the_key_that_opens_the_editor_ended_the_show() {
        let opens =
            |key: Key| may_open_text(&Input::Key(KeyPress { key, latin: None, text: None, repeat: false }));
        let letter = |text: &str| Key::Character(text.to_owned());
        for key in [letter("e"), letter("B"), letter("h"), letter("/"), Key::Named(NamedKey::F1)] {
            assert!(opens(key.clone()), "{key:?}");
        }
        // Q must end the show at once while a driver prepares the next scene.
        for key in [letter("n"), letter("q"), Key::Named(NamedKey::Space), Key::Other] {
            assert!(!opens(key.clone()), "{key:?}");
        }
        let typing = Typing::default();
        assert!(!typing.is_on());
        typing.0.1.fetch_add(1, Ordering::SeqCst);
        assert!(typing.is_on(), "the show has not taken the key yet");
        typing.set(true, 1);
        assert!(typing.is_on());
        typing.set(false, 0);
        assert!(!typing.is_on());
    }
}
