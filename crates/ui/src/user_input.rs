//! Makes commands from keys, the mouse and dropped files.

use std::path::PathBuf;
use std::time::Instant;

use crate::pointer::Pointer;
use mariana_commands::Command;
use mariana_commands::input::{Input, Key, Modifiers};

/// The state of keys and mouse, from input that does not belong to the overlay.
#[derive(Debug, Default)]
pub struct UserInput {
    /// The mouse.
    pub pointer: Pointer,
    /// The held modifier keys.
    pub held: Modifiers,
    /// Files dropped onto the window. Files of one drop arrive one by one.
    pub dropped: Vec<PathBuf>,
}

impl UserInput {
    /// Handles input and returns its command, if any.
    pub fn handle(&mut self, input: &Input, now: Instant) -> Option<Command> {
        match input {
            Input::Dropped(path) => {
                self.dropped.push(path.clone());
                None
            }
            Input::Modifiers(held) => {
                self.held = *held;
                None
            }
            Input::Key(press) => Command::of_press(press, self.held),
            _ => self.pointer.handle(input, now),
        }
    }

    /// Returns the pressed key and its modifiers. Skips repeats of a held letter, which may have opened the text field.
    pub fn typed<'a>(&self, input: &'a Input) -> Option<(&'a Key, Modifiers)> {
        match input {
            Input::Key(press) => {
                (!press.repeat || matches!(press.key, Key::Named(_))).then_some((&press.key, self.held))
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_commands::Switch;
    use mariana_commands::input::PointerButton;

    #[test]
    fn files_that_are_dropped_together_stay_together() {
        let mut input = UserInput::default();
        for name in ["a.wav", "b.wav"] {
            assert_eq!(input.handle(&Input::Dropped(name.into()), Instant::now()), None);
        }
        assert_eq!(input.dropped, [PathBuf::from("a.wav"), "b.wav".into()]);
    }

    #[test]
    fn a_double_click_asks_for_full_screen() {
        let (mut input, now) = (UserInput::default(), Instant::now());
        let mut click =
            |pressed| input.handle(&Input::PointerButton { button: PointerButton::Primary, pressed }, now);
        assert_eq!([click(true), click(false)], [None, Some(Command::Inspect([0.0, 0.0]))]);
        assert_eq!(click(true), Some(Command::Fullscreen(Switch::Toggle)));
    }

    #[test]
    fn shift_is_held_until_it_is_let_go() {
        let mut input = UserInput::default();
        for held in [Modifiers::SHIFT, Modifiers::SHIFT | Modifiers::ALT] {
            let _ = input.handle(&Input::Modifiers(held), Instant::now());
            assert!(input.held.contains(Modifiers::SHIFT), "{held:?}");
        }
        let _ = input.handle(&Input::Modifiers(Modifiers::ALT), Instant::now());
        assert!(!input.held.contains(Modifiers::SHIFT));
    }
}
