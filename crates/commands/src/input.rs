//! Keyboard, pointer and touch input, independent of the window system: the shell translates its events.

use std::path::PathBuf;

use bitflags::bitflags;

/// A key, given by the text that the key types or by a name. Key bindings use `Key<&'static str>` with lower-case
/// letters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Key<Text = String> {
    /// A key that types text.
    Character(Text),
    /// A key with a name.
    Named(NamedKey),
    /// Any other key.
    Other,
}

/// The named keys that have a binding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the names say it")]
pub enum NamedKey {
    Space,
    Enter,
    Escape,
    Tab,
    Backspace,
    Delete,
    Home,
    End,
    PageUp,
    PageDown,
    ArrowLeft,
    ArrowRight,
    ArrowUp,
    ArrowDown,
    F1,
    F2,
    F3,
    F4,
    F5,
    F6,
    F7,
    F8,
    F9,
    F10,
    F11,
    F12,
    MediaPlayPause,
    MediaTrackNext,
    MediaTrackPrevious,
}

bitflags! {
    /// Modifier keys that are held down.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub struct Modifiers: u8 {
        /// Shift.
        const SHIFT = 1;
        /// Ctrl.
        const CONTROL = 2;
        /// Alt, or Option on a Mac.
        const ALT = 4;
        /// The Super (Windows) key, or Command on a Mac.
        const SUPER = 8;
    }
}

/// A key press, or a repeat while the key is held.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeyPress {
    /// The key.
    pub key: Key,
    /// The letter of this key on a Latin keyboard, in lower case, if known.
    pub latin: Option<char>,
    /// The text that the key types, if any.
    pub text: Option<String>,
    /// True if this is a repeat because the key is held.
    pub repeat: bool,
}

/// A user's input to the window. Positions are in window pixels.
#[derive(Debug, Clone, PartialEq)]
pub enum Input {
    /// A key is pressed.
    Key(KeyPress),
    /// The set of held modifier keys has changed.
    Modifiers(Modifiers),
    /// An input method commits text.
    Text(String),
    /// An input method's text that is not committed yet.
    Composing(String),
    /// The pointer moves to this position.
    PointerMoved([f64; 2]),
    /// The pointer has left the window.
    PointerLeft,
    /// A pointer button is pressed or released.
    PointerButton {
        /// The button.
        button: PointerButton,
        /// True if the button is pressed, false if it is released.
        pressed: bool,
    },
    /// The wheel turns.
    Wheel(Wheel),
    /// A finger touches the screen, moves, or is lifted.
    Touch {
        /// The finger's number.
        finger: u64,
        /// The phase of the touch.
        phase: TouchPhase,
        /// The finger's position.
        place: [f64; 2],
    },
    /// The window gains (`true`) or loses keyboard focus.
    Focused(bool),
    /// A file is dropped on the window. Several files arrive as one event each.
    Dropped(PathBuf),
}

/// A button of the pointer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PointerButton {
    /// The left button.
    Primary,
    /// Any other button.
    Other,
}

/// A scroll distance, horizontal and vertical. Positive values move the content right and down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Wheel {
    /// In notches.
    Notches([f64; 2]),
    /// In pixels, as touchpads do.
    Pixels([f64; 2]),
}

/// The phase of a touch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TouchPhase {
    /// The finger touches the screen.
    Started,
    /// The finger moves.
    Moved,
    /// The finger is lifted.
    Ended,
    /// The system takes over the touch.
    Cancelled,
}
