//! Names of keys, independent of the window system.

/// A key that a command can be bound to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Key {
    /// A key that types a character, in lower case.
    Char(char),
    /// The space bar.
    Space,
    /// Enter, on the letters or on the number pad.
    Enter,
    /// Escape.
    Escape,
    /// Tab.
    Tab,
    /// Home.
    Home,
    /// Page up.
    PageUp,
    /// Page down.
    PageDown,
    /// The arrow to the left.
    Left,
    /// The arrow to the right.
    Right,
    /// The arrow up.
    Up,
    /// The arrow down.
    Down,
    /// A function key, by its number.
    Function(u8),
    /// The media key that pauses and plays.
    MediaPlayPause,
    /// The media key for the next track.
    MediaNextTrack,
    /// The media key for the previous track.
    MediaPreviousTrack,
}

/// One or several keys that send a command, with their words in the help and in README.
#[derive(Debug)]
pub struct Binding {
    /// The keys, each with the command that it sends.
    pub keys: &'static [(Key, Command)],
    /// The command that the first key sends while Shift is held, where it differs.
    pub shifted: Option<Command>,
    /// The keys as people write them, such as "F, F11 or double click".
    pub written: &'static str,
    /// The effect in words, such as "full screen, or back".
    pub help: &'static str,
    /// Whether a key that is held down sends the command again and again.
    pub repeats: bool,
}

use super::Command;
