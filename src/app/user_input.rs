//! Makes commands of keys, the mouse and dropped files.

use std::path::PathBuf;
use std::time::Instant;

use winit::event::{ElementState, KeyEvent, WindowEvent};
use winit::keyboard::{Key, ModifiersState};

use super::keys::command_of;
use super::pointer::{Gesture, Pointer};
use crate::commands::{Command, Switch};

/// The state of the keys and the mouse, from the events that are not the overlay's.
#[derive(Debug, Default)]
pub(super) struct UserInput {
    pointer: Pointer,
    /// The keys that are held and change what others do.
    held: ModifiersState,
    /// Files that were dropped onto the window. Each comes as an event of its own, and together they are a list.
    dropped: Vec<PathBuf>,
}

impl UserInput {
    /// Takes an event and returns the command that it makes, if any.
    pub(super) fn take(&mut self, event: &WindowEvent, now: Instant) -> Option<Command> {
        match event {
            WindowEvent::DroppedFile(path) => {
                self.dropped.push(path.clone());
                None
            }
            WindowEvent::ModifiersChanged(modifiers) => {
                self.held = modifiers.state();
                None
            }
            WindowEvent::KeyboardInput {
                event: KeyEvent { logical_key, state: ElementState::Pressed, repeat, .. },
                is_synthetic: false,
                ..
            } => command_of(logical_key, *repeat, self.held),
            _ => self.pointer.take(event, now).map(|gesture| match gesture {
                Gesture::DoubleClick => Command::Fullscreen(Switch::Toggle),
                Gesture::Drag(way) => Command::TurnCamera(way.into()),
                Gesture::Zoom(notches) => Command::ZoomCamera(notches),
                Gesture::Click(place) => Command::Inspect(place.into()),
            }),
        }
    }

    /// The key that an event presses, and what is held with it. A letter that is held counts once: it may be the key
    /// that opened what it would be typed into.
    pub(super) fn typed<'a>(&self, event: &'a WindowEvent) -> Option<(&'a Key, ModifiersState)> {
        match event {
            WindowEvent::KeyboardInput {
                event: KeyEvent { logical_key, state: ElementState::Pressed, repeat, .. },
                is_synthetic: false,
                ..
            } => (!repeat || matches!(logical_key, Key::Named(_))).then_some((logical_key, self.held)),
            _ => None,
        }
    }

    /// Takes out the files that were dropped since the last call.
    pub(super) fn take_dropped(&mut self) -> Vec<PathBuf> {
        std::mem::take(&mut self.dropped)
    }

    /// What is held and changes what other keys do.
    pub(super) fn held(&self) -> ModifiersState {
        self.held
    }

    /// Where the pointer began what it does, in pixels.
    pub(super) fn began(&self) -> (f64, f64) {
        self.pointer.began()
    }

    /// Whether a shift key is held.
    pub(super) fn shift_held(&self) -> bool {
        self.held.shift_key()
    }
}

#[cfg(test)]
mod tests {
    use winit::event::{DeviceId, MouseButton};

    use super::*;

    #[test]
    fn files_that_are_dropped_together_are_taken_together_and_once() {
        let mut input = UserInput::default();
        for name in ["a.wav", "b.wav"] {
            assert_eq!(input.take(&WindowEvent::DroppedFile(name.into()), Instant::now()), None);
        }
        assert_eq!(input.take_dropped(), [PathBuf::from("a.wav"), "b.wav".into()]);
        assert!(input.take_dropped().is_empty());
    }

    #[test]
    fn a_double_click_asks_for_full_screen() {
        let (mut input, now) = (UserInput::default(), Instant::now());
        let mut click = |state| {
            let device_id = DeviceId::dummy();
            input.take(&WindowEvent::MouseInput { device_id, state, button: MouseButton::Left }, now)
        };
        let first = [click(ElementState::Pressed), click(ElementState::Released)];
        assert_eq!(first, [None, Some(Command::Inspect([0.0, 0.0]))]);
        assert_eq!(click(ElementState::Pressed), Some(Command::Fullscreen(Switch::Toggle)));
    }

    #[test]
    fn shift_is_held_until_it_is_let_go() {
        let mut input = UserInput::default();
        for state in [ModifiersState::SHIFT, ModifiersState::SHIFT | ModifiersState::ALT] {
            let _ = input.take(&WindowEvent::ModifiersChanged(state.into()), Instant::now());
            assert!(input.held.shift_key(), "{state:?}");
        }
        let _ = input.take(&WindowEvent::ModifiersChanged(ModifiersState::ALT.into()), Instant::now());
        assert!(!input.held.shift_key());
    }
}
