//! Keyboard focus of the editor, text that an input method is composing, and keys that wait for a text.

use mariana_commands::input::{KeyPress, Modifiers};

/// Input that arrived before the text was read.
pub(super) enum Early {
    Key(KeyPress, Modifiers),
    Text(String),
}

#[derive(Default)]
pub(super) struct Focus {
    pub(super) is_on: bool,
    /// True while the user holds a key that was pressed before the editor got the focus.
    pub(crate) ignores_repeats: bool,
    pub(super) preedit: String,
    pub(crate) early: Vec<Early>,
    /// True while the scene to edit does not exist yet.
    pub(super) awaits_scene: bool,
}

impl Focus {
    pub(super) fn set(&mut self, on: bool) {
        self.ignores_repeats |= on && !self.is_on;
        self.is_on = on;
        if !on {
            self.preedit.clear();
            self.early.clear();
        }
    }
}
