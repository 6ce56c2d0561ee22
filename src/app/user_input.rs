//! What the user asks for with the keys, the mouse and dropped files.

use std::path::PathBuf;
use std::time::Instant;

use winit::event::{ElementState, KeyEvent, WindowEvent};
use winit::keyboard::{Key, ModifiersState};

use super::keys::{Action, action_of};
use super::pointer::{Gesture, Pointer};

/// What the user asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Wish {
    /// What a key does.
    Act(Action),
    /// To turn the camera by a movement to the right and down, in pixels.
    TurnCamera((f64, f64)),
    /// To move the camera by notches of the wheel, positive nearer.
    ZoomCamera(f64),
    /// To know what is at a place of the window, in pixels.
    LookAt((f64, f64)),
}

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
    /// Takes an event and returns what the user asks for with it.
    pub(super) fn take(&mut self, event: &WindowEvent, now: Instant) -> Option<Wish> {
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
            } => action_of(logical_key, *repeat, self.held).map(Wish::Act),
            _ => self.pointer.take(event, now).map(|gesture| match gesture {
                Gesture::DoubleClick => Wish::Act(Action::ToggleFullscreen),
                Gesture::Drag(way) => Wish::TurnCamera(way),
                Gesture::Zoom(notches) => Wish::ZoomCamera(notches),
                Gesture::Click(place) => Wish::LookAt(place),
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
        assert_eq!(first, [None, Some(Wish::LookAt((0.0, 0.0)))]);
        assert_eq!(click(ElementState::Pressed), Some(Wish::Act(Action::ToggleFullscreen)));
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
