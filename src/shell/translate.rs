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

macro_rules! same_names {
    ($($name:ident)*) => { &[$((WinitNamed::$name, NamedKey::$name)),*] };
}

const NAMED: &[(WinitNamed, NamedKey)] = same_names!(
    Space Enter Escape Tab Backspace Delete Home End PageUp PageDown ArrowLeft ArrowRight ArrowUp ArrowDown
    F1 F2 F3 F4 F5 F6 F7 F8 F9 F10 F11 F12 MediaPlayPause MediaTrackNext MediaTrackPrevious
);

/// Returns the letter or digit at the key's position or `/` at the key's position on a Latin keyboard.
fn latin_at(key: PhysicalKey) -> Option<char> {
    let PhysicalKey::Code(code) = key else { return None };
    let name = format!("{code:?}");
    match name.strip_prefix("Key").or(name.strip_prefix("Digit")) {
        Some(sign) => sign.chars().next().map(|sign| sign.to_ascii_lowercase()),
        None => (code == KeyCode::Slash).then_some('/'),
    }
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
