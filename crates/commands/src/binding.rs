//! The keys of a command.

use crate::input::Key;
use crate::{Command, Group};

/// One or several keys for a command, with texts for the help and `docs/reference.md`.
#[derive(Debug)]
pub struct Binding {
    /// The keys, each with the command that it sends.
    pub keys: &'static [(Key<&'static str>, Command)],
    /// The command of the first key while Shift is held, if Shift changes the command.
    pub shifted: Option<Command>,
    /// The keys as the help names them, such as "F, F11 or double click".
    pub written: &'static str,
    /// The help text, such as "enter or leave full screen".
    pub help: &'static str,
    /// Returns the command of a digit key, by its digit, while Shift is held.
    pub digits: Option<fn(usize) -> Command>,
    /// True if a held key repeats the command.
    pub repeats: bool,
    /// The group in the help, if it differs from the row's group.
    pub group: Option<Group>,
}

impl Binding {
    /// A binding without keys, which does not repeat.
    pub(crate) const ONCE: Self =
        Self { keys: &[], shifted: None, written: "", help: "", digits: None, repeats: false, group: None };

    /// The single keys: "F, F11 or double click" has three.
    pub fn caps(&self) -> impl Iterator<Item = &'static str> + use<> {
        self.written.split(", ").flat_map(|part| part.split(" or "))
    }

    /// The command of the first key.
    pub fn command(&self) -> Option<Command> {
        let first = self.keys.first().map(|(_, command)| command.clone());
        first.or_else(|| self.digits.map(|command| command(1)))
    }
}

#[cfg(test)]
mod tests {
    use crate::bindings;

    #[test]
    fn every_key_of_a_binding_has_a_keycap() {
        let full_screen = bindings().find(|binding| binding.written.contains("F11")).unwrap();
        assert_eq!(full_screen.caps().collect::<Vec<_>>(), ["F", "F11", "double click"]);
        for binding in bindings() {
            // Every named key has a keycap. Media keys have no names.
            assert!(binding.caps().count() <= binding.keys.len() + 1, "{}", binding.written);
        }
    }
}
