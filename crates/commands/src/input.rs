//! Keys and pointers as the show knows them, independent of the window system. The shell translates the window's events
//! into these; tests make them directly.

use std::path::PathBuf;

use bitflags::bitflags;

/// A key by what it types or is called. Tables write their letters as `Key<&'static str>`, in lower case.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Key<Text = String> {
    /// A key that types text.
    Character(Text),
    /// A key with a name.
    Named(NamedKey),
    /// Any other.
    Other,
}

/// The keys with names that something is bound to.
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
    F3,
    F8,
    F9,
    F11,
    MediaPlayPause,
    MediaTrackNext,
    MediaTrackPrevious,
}

bitflags! {
    /// The keys that are held and change what others do.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub struct Modifiers: u8 {
        /// Shift.
        const SHIFT = 1;
        /// Ctrl.
        const CONTROL = 2;
        /// Alt, or Option on a Mac.
        const ALT = 4;
        /// The system's key, or Command on a Mac.
        const SUPER = 8;
    }
}

impl Modifiers {
    /// Whether Shift is held.
    pub fn shift_key(self) -> bool {
        self.contains(Self::SHIFT)
    }

    /// Whether Ctrl is held.
    pub fn control_key(self) -> bool {
        self.contains(Self::CONTROL)
    }

    /// Whether Alt is held.
    pub fn alt_key(self) -> bool {
        self.contains(Self::ALT)
    }

    /// Whether the system's key is held.
    pub fn super_key(self) -> bool {
        self.contains(Self::SUPER)
    }
}

/// A key that goes down, or is held and repeats.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeyPress {
    /// The key.
    pub key: Key,
    /// The letter in its place on a keyboard with Latin letters, in lower case, where that is known.
    pub latin: Option<char>,
    /// The text that it types, if any.
    pub text: Option<String>,
    /// Whether it is held.
    pub repeat: bool,
}

/// Something that a user does in the window. Places are pixels of the window.
#[derive(Debug, Clone, PartialEq)]
pub enum Input {
    /// A key goes down.
    Key(KeyPress),
    /// The keys that are held are others than before.
    Modifiers(Modifiers),
    /// An input method has put letters together.
    Text(String),
    /// An input method shows letters that it is putting together.
    Composing(String),
    /// The pointer is at a place.
    PointerMoved([f64; 2]),
    /// The pointer has left the window.
    PointerLeft,
    /// A button of the pointer goes down or up.
    PointerButton {
        /// Which.
        button: PointerButton,
        /// Whether it goes down.
        pressed: bool,
    },
    /// The wheel turns.
    Wheel(Wheel),
    /// A finger touches a place, moves to it, or is lifted there.
    Touch {
        /// The number of the finger.
        finger: u64,
        /// What it does.
        phase: TouchPhase,
        /// The place.
        place: [f64; 2],
    },
    /// The window gets the keyboard, or loses it.
    Focused(bool),
    /// A file was dropped on the window. Each of several comes as an event of its own.
    Dropped(PathBuf),
}

/// A button of the pointer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PointerButton {
    /// The left one.
    Primary,
    /// The right one.
    Secondary,
    /// The wheel.
    Middle,
    /// Any other.
    Other,
}

/// How far a wheel turns, to the right and down or, as systems count, positive for content that moves to the right and
/// down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Wheel {
    /// In notches.
    Notches([f64; 2]),
    /// In pixels, as touchpads do.
    Pixels([f64; 2]),
}

/// What a finger does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TouchPhase {
    /// It touches.
    Started,
    /// It moves.
    Moved,
    /// It is lifted.
    Ended,
    /// The system takes the touch for something else.
    Cancelled,
}
