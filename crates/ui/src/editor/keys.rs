//! The editor's keys. Key handling and the manual page use the same table.

use mariana_commands::input::{Key, Modifiers, NamedKey};

use self::EditAction as A;
use mariana_editing::Move;

/// An action of a key or a button.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EditAction {
    /// Saves the text; copies a shipped scene to the user's folder.
    Save,
    /// Undoes the last change.
    Undo,
    /// Redoes the last undone change.
    Redo,
    /// Copies the selection.
    Copy,
    /// Cuts the selection.
    Cut,
    /// Pastes the clipboard's text.
    Paste,
    /// Selects everything.
    SelectAll,
    /// Opens the search line.
    Find,
    /// Goes to the next or previous match.
    FindNext {
        /// True for the next match.
        forward: bool,
    },
    /// Comments lines out, or uncomments them.
    ToggleComment,
    /// Formats the text.
    Format,
    /// Opens the completion list.
    Propose,
    /// Replaces the number at the cursor by a parameter.
    MakeParam,
    /// Increases or decreases the number at the cursor.
    TurnNumber {
        /// True to increase it.
        up: bool,
    },
    /// Creates a new scene.
    New,
    /// Shows the next text of the scene, including its include files.
    NextText,
    /// Goes to the next mistake.
    NextMistake,
    /// Highlights the parts of the frame that the lines at the cursor draw, or stops highlighting them.
    Light,
    /// Shows or hides the cost of each object.
    Profile,
    /// Answers the question above the text.
    Answer {
        /// True for the first answer.
        first: bool,
    },
    /// Closes an open list or card, or else the editor.
    Leave,
}

/// A key binding.
pub struct Row {
    /// The key; letters in lower case.
    key: Key<&'static str>,
    held: Modifiers,
    /// The displayed key. Empty for an alternative key that a different row mentions.
    pub written: &'static str,
    /// The action.
    pub action: EditAction,
    /// A description of the action.
    pub meaning: &'static str,
}

const CTRL: Modifiers = Modifiers::CONTROL;
const ALT: Modifiers = Modifiers::ALT;
const NONE: Modifiers = Modifiers::empty();

const fn letter(
    letter: &'static str,
    written: &'static str,
    action: EditAction,
    meaning: &'static str,
) -> Row {
    Row { key: Key::Character(letter), held: CTRL, written, action, meaning }
}

const fn named(
    key: NamedKey,
    held: Modifiers,
    written: &'static str,
    action: EditAction,
    meaning: &'static str,
) -> Row {
    Row { key: Key::Named(key), held, written, action, meaning }
}

/// All key bindings. With Shift, the key for the next match finds the previous match, and the key for Undo redoes.
pub const ROWS: &[Row] = &[
    letter("s", "Ctrl+S", A::Save, "save; a shipped scene is copied to your folder"),
    letter("z", "Ctrl+Z", A::Undo, "undo"),
    letter("y", "Ctrl+Y or Ctrl+Shift+Z", A::Redo, "redo"),
    letter("c", "Ctrl+C", A::Copy, "copy"),
    letter("x", "Ctrl+X", A::Cut, "cut"),
    letter("v", "Ctrl+V", A::Paste, "paste"),
    letter("a", "Ctrl+A", A::SelectAll, "select all"),
    letter("f", "Ctrl+F", A::Find, "find; Enter goes to the next match, Shift+Enter to the previous one"),
    letter(
        "g",
        "Ctrl+G or F3",
        A::FindNext { forward: true },
        "find the next match; with Shift the previous one",
    ),
    named(NamedKey::F3, NONE, "", A::FindNext { forward: true }, ""),
    letter("/", "Ctrl+/", A::ToggleComment, "comment lines out, or uncomment them"),
    letter("r", "Ctrl+R", A::Format, "format the text: indentation, blanks and columns"),
    named(NamedKey::Space, CTRL, "Ctrl+Space", A::Propose, "complete the name at the cursor; Tab accepts"),
    letter("p", "Ctrl+P", A::MakeParam, "turn the number at the cursor into a parameter with a slider"),
    named(
        NamedKey::ArrowUp,
        ALT,
        "Alt+Up, Alt+Down",
        A::TurnNumber { up: true },
        "change the number at the cursor; with Shift in fine steps. Or drag its grip, or Alt+drag the number",
    ),
    named(NamedKey::ArrowDown, ALT, "", A::TurnNumber { up: false }, ""),
    letter("e", "Ctrl+E or F8", A::NextMistake, "go to the next mistake"),
    named(NamedKey::F8, NONE, "", A::NextMistake, ""),
    named(NamedKey::Tab, CTRL, "Ctrl+Tab", A::NextText, "go to the next file of this scene"),
    letter("l", "Ctrl+L", A::Light, "highlight in the image what the line at the cursor draws"),
    letter("k", "Ctrl+K", A::Profile, "show what each object costs"),
    letter("1", "Ctrl+1", A::Answer { first: true }, "the first answer to the question above the text"),
    letter("2", "Ctrl+2", A::Answer { first: false }, "the second answer"),
    letter("n", "Ctrl+N", A::New, "create a new scene"),
    named(
        NamedKey::Escape,
        NONE,
        "Esc",
        A::Leave,
        "close the open list or card, then the editor; your text is kept",
    ),
];

/// The bindings for display, without unnamed alternatives.
pub fn written_rows() -> impl Iterator<Item = &'static Row> {
    ROWS.iter().filter(|row| !row.written.is_empty())
}

/// Returns the action of `key` with the modifiers `held`. On non-Latin keyboards the key's position decides: `latin` is
/// the letter of this key on a Latin keyboard.
pub(super) fn action_of(key: &Key, latin: Option<char>, held: Modifiers) -> Option<EditAction> {
    let shift = held.contains(Modifiers::SHIFT);
    let mut held = held - Modifiers::SHIFT;
    // On a Mac, Command replaces Ctrl.
    if held == Modifiers::SUPER && cfg!(target_os = "macos") {
        held = CTRL;
    }
    let lower = match key {
        Key::Character(text) => text.to_lowercase(),
        _ => String::new(),
    };
    let latin = latin.filter(|_| !lower.is_ascii()).map(String::from);
    let letter = latin.unwrap_or(lower);
    let row = ROWS.iter().find(|row| {
        row.held == held
            && match (&row.key, key) {
                (Key::Character(wanted), Key::Character(_)) => *wanted == letter,
                (Key::Named(wanted), Key::Named(pressed)) => wanted == pressed,
                _ => false,
            }
    })?;
    Some(match (row.action, shift) {
        (EditAction::Undo, true) => EditAction::Redo,
        (EditAction::FindNext { .. }, true) => EditAction::FindNext { forward: false },
        (action, _) => action,
    })
}

pub(super) fn way_of(key: &Key, held: Modifiers, rows: usize) -> Option<Move> {
    let (Key::Named(named), word) = (key, held.contains(Modifiers::CONTROL)) else { return None };
    Some(match named {
        NamedKey::ArrowLeft if word => Move::WordLeft,
        NamedKey::ArrowRight if word => Move::WordRight,
        NamedKey::ArrowLeft => Move::Left,
        NamedKey::ArrowRight => Move::Right,
        NamedKey::ArrowUp => Move::Up(1),
        NamedKey::ArrowDown => Move::Down(1),
        NamedKey::PageUp => Move::Up(rows.max(2) - 1),
        NamedKey::PageDown => Move::Down(rows.max(2) - 1),
        NamedKey::Home if word => Move::Start,
        NamedKey::End if word => Move::End,
        NamedKey::Home => Move::LineStart,
        NamedKey::End => Move::LineEnd,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_key_has_two_meanings() {
        for (index, row) in ROWS.iter().enumerate() {
            let same = |other: &Row| (&other.key, other.held) == (&row.key, row.held);
            assert!(!ROWS[..index].iter().any(same), "{:?} has two meanings", row.key);
        }
    }

    #[test]
    fn letters_of_other_keyboards_are_recognized_by_position() {
        let key = |text: &str| Key::Character(text.into());
        assert_eq!(action_of(&key("s"), None, CTRL), Some(EditAction::Save));
        assert_eq!(action_of(&key("ы"), Some('s'), CTRL), Some(EditAction::Save));
        assert_eq!(action_of(&key("S"), Some('s'), NONE), None);
        let shift = CTRL | Modifiers::SHIFT;
        assert_eq!(action_of(&key("Z"), Some('z'), shift), Some(EditAction::Redo));
        assert_eq!(action_of(&key("s"), Some('s'), CTRL | ALT), None);
    }

    /// The keys as a Markdown table.
    fn markdown_table() -> String {
        let rows = written_rows().map(|row| format!("| {} | {} |\n", row.written, row.meaning));
        format!("| key | what it does |\n|---|---|\n{}", rows.collect::<String>())
    }

    #[test]
    fn the_page_about_the_editor_has_the_table() {
        let page = include_str!("../../../../docs/editor.md").replace("\r\n", "\n");
        assert!(page.contains(&markdown_table()), "put this into docs/editor.md:\n{}", markdown_table());
    }
}
