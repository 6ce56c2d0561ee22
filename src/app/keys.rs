//! Translates the keys of the window system into those that commands are bound to.

use winit::keyboard::{Key, ModifiersState, NamedKey};

use crate::commands::{Command, Key as BoundKey};

/// Returns the command that `key` sends, if any; `repeated` while it is held. With Ctrl, Alt or the system's key it
/// sends none: those belong to the desktop and to later keys.
pub fn command_of(key: &Key, repeated: bool, held: ModifiersState) -> Option<Command> {
    if held.intersects(ModifiersState::CONTROL | ModifiersState::ALT | ModifiersState::SUPER) {
        return None;
    }
    Command::of_key(bound_key(key)?, held.shift_key(), repeated)
}

fn bound_key(key: &Key) -> Option<BoundKey> {
    Some(match key {
        Key::Character(text) => {
            let lower = text.to_lowercase();
            let mut letters = lower.chars();
            let letter = letters.next()?;
            letters.next().is_none().then_some(BoundKey::Char(letter))?
        }
        Key::Named(named) => match named {
            NamedKey::Space => BoundKey::Space,
            NamedKey::Enter => BoundKey::Enter,
            NamedKey::Escape => BoundKey::Escape,
            NamedKey::Tab => BoundKey::Tab,
            NamedKey::Home => BoundKey::Home,
            NamedKey::PageUp => BoundKey::PageUp,
            NamedKey::PageDown => BoundKey::PageDown,
            NamedKey::ArrowLeft => BoundKey::Left,
            NamedKey::ArrowRight => BoundKey::Right,
            NamedKey::ArrowUp => BoundKey::Up,
            NamedKey::ArrowDown => BoundKey::Down,
            NamedKey::F1 => BoundKey::Function(1),
            NamedKey::F9 => BoundKey::Function(9),
            NamedKey::F11 => BoundKey::Function(11),
            NamedKey::MediaPlayPause => BoundKey::MediaPlayPause,
            NamedKey::MediaTrackNext => BoundKey::MediaNextTrack,
            NamedKey::MediaTrackPrevious => BoundKey::MediaPreviousTrack,
            _ => return None,
        },
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::{Switch, bindings};

    const NO_KEYS: ModifiersState = ModifiersState::empty();

    #[test]
    fn letters_work_with_caps_lock() {
        let command = |key: &str, held| command_of(&Key::Character(key.into()), false, held);
        assert_eq!(command("M", NO_KEYS), Some(Command::Mute(Switch::Toggle)));
        // With caps lock on, V is typed as with Shift.
        assert_eq!(command("V", NO_KEYS), Some(Command::NextView));
        assert_eq!(command("V", ModifiersState::SHIFT), Some(Command::PreviousView));
        assert_eq!(command("ab", NO_KEYS), None);
    }

    #[test]
    fn keys_with_ctrl_or_alt_are_no_letters() {
        let key = Key::Character("s".into());
        assert_eq!(command_of(&key, false, NO_KEYS), Some(Command::Shuffle(Switch::Toggle)));
        for held in
            [ModifiersState::CONTROL, ModifiersState::ALT, ModifiersState::SUPER | ModifiersState::SHIFT]
        {
            assert_eq!(command_of(&key, false, held), None, "{held:?}");
        }
    }

    #[test]
    fn every_bound_function_key_can_be_pressed() {
        let named = [NamedKey::F1, NamedKey::F9, NamedKey::F11].map(|key| bound_key(&Key::Named(key)));
        for (key, _) in bindings().flat_map(|binding| binding.keys) {
            if matches!(key, BoundKey::Function(_)) {
                assert!(named.contains(&Some(*key)), "{key:?} is not translated");
            }
        }
    }
}
