//! Translates winit's events into the input of the session.

use winit::event::{ElementState, Ime, KeyEvent, MouseButton, MouseScrollDelta, TouchPhase, WindowEvent};
use winit::keyboard::{Key as WinitKey, KeyCode, ModifiersState, NamedKey as WinitNamed, PhysicalKey};

use crate::input::{self, Input, Key, KeyPress, Modifiers, NamedKey, PointerButton, Wheel};

pub(crate) fn input_of(event: &WindowEvent) -> Option<Input> {
    Some(match event {
        WindowEvent::KeyboardInput { event, is_synthetic: false, .. } => Input::Key(key_press(event)?),
        WindowEvent::ModifiersChanged(held) => Input::Modifiers(modifiers(held.state())),
        WindowEvent::Ime(Ime::Commit(text)) => Input::Text(text.clone()),
        WindowEvent::Ime(Ime::Preedit(letters, _)) => Input::Composing(letters.clone()),
        WindowEvent::CursorMoved { position, .. } => Input::PointerMoved((*position).into()),
        WindowEvent::CursorLeft { .. } => Input::PointerLeft,
        WindowEvent::MouseInput { state, button, .. } => Input::PointerButton {
            button: match button {
                MouseButton::Left => PointerButton::Primary,
                MouseButton::Right => PointerButton::Secondary,
                MouseButton::Middle => PointerButton::Middle,
                _ => PointerButton::Other,
            },
            pressed: *state == ElementState::Pressed,
        },
        WindowEvent::MouseWheel { delta, .. } => Input::Wheel(match delta {
            MouseScrollDelta::LineDelta(x, y) => Wheel::Notches([*x, *y].map(f64::from)),
            MouseScrollDelta::PixelDelta(pixels) => Wheel::Pixels((*pixels).into()),
        }),
        WindowEvent::Touch(touch) => Input::Touch {
            finger: touch.id,
            phase: match touch.phase {
                TouchPhase::Started => input::TouchPhase::Started,
                TouchPhase::Moved => input::TouchPhase::Moved,
                TouchPhase::Ended => input::TouchPhase::Ended,
                TouchPhase::Cancelled => input::TouchPhase::Cancelled,
            },
            place: touch.location.into(),
        },
        WindowEvent::Focused(focused) => Input::Focused(*focused),
        WindowEvent::DroppedFile(path) => Input::Dropped(path.clone()),
        _ => return None,
    })
}

/// Returns the pressed key; `None` for a released key.
pub(crate) fn key_press(event: &KeyEvent) -> Option<KeyPress> {
    (event.state == ElementState::Pressed).then(|| KeyPress {
        key: key_of(&event.logical_key),
        latin: latin_at(event.physical_key),
        text: event.text.as_ref().map(ToString::to_string),
        repeat: event.repeat,
    })
}

pub(crate) fn modifiers(state: ModifiersState) -> Modifiers {
    let all = [
        (state.shift_key(), Modifiers::SHIFT),
        (state.control_key(), Modifiers::CONTROL),
        (state.alt_key(), Modifiers::ALT),
        (state.super_key(), Modifiers::SUPER),
    ];
    all.into_iter().filter(|(held, _)| *held).map(|(_, modifier)| modifier).collect()
}

fn key_of(key: &WinitKey) -> Key {
    match key {
        WinitKey::Character(text) => Key::Character(text.to_string()),
        WinitKey::Named(named) => NAMED
            .iter()
            .find(|(theirs, _)| theirs == named)
            .map_or(Key::Other, |(_, named)| Key::Named(*named)),
        WinitKey::Unidentified(_) | WinitKey::Dead(_) => Key::Other,
    }
}

const NAMED: [(WinitNamed, NamedKey); 29] = [
    (WinitNamed::Space, NamedKey::Space),
    (WinitNamed::Enter, NamedKey::Enter),
    (WinitNamed::Escape, NamedKey::Escape),
    (WinitNamed::Tab, NamedKey::Tab),
    (WinitNamed::Backspace, NamedKey::Backspace),
    (WinitNamed::Delete, NamedKey::Delete),
    (WinitNamed::Home, NamedKey::Home),
    (WinitNamed::End, NamedKey::End),
    (WinitNamed::PageUp, NamedKey::PageUp),
    (WinitNamed::PageDown, NamedKey::PageDown),
    (WinitNamed::ArrowLeft, NamedKey::ArrowLeft),
    (WinitNamed::ArrowRight, NamedKey::ArrowRight),
    (WinitNamed::ArrowUp, NamedKey::ArrowUp),
    (WinitNamed::ArrowDown, NamedKey::ArrowDown),
    (WinitNamed::F1, NamedKey::F1),
    (WinitNamed::F2, NamedKey::F2),
    (WinitNamed::F3, NamedKey::F3),
    (WinitNamed::F4, NamedKey::F4),
    (WinitNamed::F5, NamedKey::F5),
    (WinitNamed::F6, NamedKey::F6),
    (WinitNamed::F7, NamedKey::F7),
    (WinitNamed::F8, NamedKey::F8),
    (WinitNamed::F9, NamedKey::F9),
    (WinitNamed::F10, NamedKey::F10),
    (WinitNamed::F11, NamedKey::F11),
    (WinitNamed::F12, NamedKey::F12),
    (WinitNamed::MediaPlayPause, NamedKey::MediaPlayPause),
    (WinitNamed::MediaTrackNext, NamedKey::MediaTrackNext),
    (WinitNamed::MediaTrackPrevious, NamedKey::MediaTrackPrevious),
];

/// Returns the letter or digit at the key's position on a Latin keyboard, if a command uses it.
fn latin_at(key: PhysicalKey) -> Option<char> {
    let PhysicalKey::Code(code) = key else { return None };
    Some(match code {
        KeyCode::Digit0 => '0',
        KeyCode::Digit1 => '1',
        KeyCode::Digit2 => '2',
        KeyCode::Digit3 => '3',
        KeyCode::Digit4 => '4',
        KeyCode::Digit5 => '5',
        KeyCode::Digit6 => '6',
        KeyCode::Digit7 => '7',
        KeyCode::Digit8 => '8',
        KeyCode::Digit9 => '9',
        KeyCode::KeyA => 'a',
        KeyCode::KeyC => 'c',
        KeyCode::KeyE => 'e',
        KeyCode::KeyF => 'f',
        KeyCode::KeyG => 'g',
        KeyCode::KeyK => 'k',
        KeyCode::KeyL => 'l',
        KeyCode::KeyN => 'n',
        KeyCode::KeyP => 'p',
        KeyCode::KeyS => 's',
        KeyCode::KeyV => 'v',
        KeyCode::KeyX => 'x',
        KeyCode::KeyY => 'y',
        KeyCode::KeyZ => 'z',
        KeyCode::Slash => '/',
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use winit::event::DeviceId;

    use super::*;
    use crate::commands::bindings;

    #[test]
    fn every_bound_key_can_be_pressed() {
        for (key, _) in bindings().flat_map(|binding| binding.keys) {
            if let Key::Named(named) = key {
                assert!(NAMED.iter().any(|(_, known)| known == named), "{named:?} is not translated");
            }
        }
    }

    #[test]
    fn the_pointer_the_wheel_and_held_keys_are_translated() {
        let device_id = DeviceId::dummy();
        let position = winit::dpi::PhysicalPosition { x: 3.0, y: 4.0 };
        assert_eq!(
            input_of(&WindowEvent::CursorMoved { device_id, position }),
            Some(Input::PointerMoved([3.0, 4.0]))
        );
        let phase = TouchPhase::Moved;
        let delta = MouseScrollDelta::LineDelta(0.0, -2.0);
        assert_eq!(
            input_of(&WindowEvent::MouseWheel { device_id, delta, phase }),
            Some(Input::Wheel(Wheel::Notches([0.0, -2.0])))
        );
        let held = ModifiersState::SHIFT | ModifiersState::ALT;
        assert_eq!(modifiers(held), Modifiers::SHIFT | Modifiers::ALT);
        assert_eq!(modifiers(ModifiersState::empty()), Modifiers::empty());
        assert_eq!(input_of(&WindowEvent::RedrawRequested), None);
    }
}
