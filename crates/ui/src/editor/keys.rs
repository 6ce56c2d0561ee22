//! What keys do while they are text: one table, from which the handling and the page about the editor are made.

use mariana_commands::input::{Key, Modifiers, NamedKey};

use mariana_editing::Move;

/// What a key or a click asks of the editor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EditAction {
    /// To save the text; a text without a file is copied to the user's folder.
    Save,
    /// To take the last change back.
    Undo,
    /// To do it again.
    Redo,
    /// To copy what is selected.
    Copy,
    /// To cut it out.
    Cut,
    /// To put in what was copied.
    Paste,
    /// To select all.
    SelectAll,
    /// To find something.
    Find,
    /// To go to the next place of what is looked for, or to the one before.
    FindNext {
        /// Whether it is the next.
        forward: bool,
    },
    /// To leave lines out as comments, or to bring them back.
    ToggleComment,
    /// To propose what may be written.
    Propose,
    /// To make a parameter of the number at the cursor.
    MakeParam,
    /// To turn the number at the cursor.
    TurnNumber {
        /// Whether it becomes more.
        up: bool,
    },
    /// To begin a new scene.
    New,
    /// To go to the next text of the scene: those that it includes.
    NextText,
    /// To go to the next mistake.
    NextMistake,
    /// To light up what the lines at the cursor make, or to stop.
    Light,
    /// To show what objects cost, or to stop.
    Profile,
    /// To answer what is asked about the text.
    Answer {
        /// Whether the first answer is given.
        first: bool,
    },
    /// To close what is open, and then the editor.
    Leave,
}

/// A row of the table.
pub struct Row {
    /// The key, letters in lower case.
    key: Key<&'static str>,
    /// What is held with it.
    held: Modifiers,
    /// The key as people write it.
    pub written: &'static str,
    /// What it does.
    pub action: EditAction,
    /// The same in words.
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

/// Every key with a meaning of its own. Shift turns finding around, and undoing into doing again.
pub const ROWS: &[Row] = &[
    letter("s", "Ctrl+S", EditAction::Save, "save; a shipped scene is copied to your folder"),
    letter("z", "Ctrl+Z", EditAction::Undo, "take back"),
    letter("y", "Ctrl+Y or Ctrl+Shift+Z", EditAction::Redo, "do again"),
    letter("c", "Ctrl+C", EditAction::Copy, "copy"),
    letter("x", "Ctrl+X", EditAction::Cut, "cut"),
    letter("v", "Ctrl+V", EditAction::Paste, "paste"),
    letter("a", "Ctrl+A", EditAction::SelectAll, "select all"),
    letter(
        "f",
        "Ctrl+F",
        EditAction::Find,
        "find; Enter goes to the next place, Shift+Enter to the one before",
    ),
    letter(
        "g",
        "Ctrl+G or F3",
        EditAction::FindNext { forward: true },
        "find the next one; with Shift the one before",
    ),
    named(NamedKey::F3, NONE, "", EditAction::FindNext { forward: true }, ""),
    letter("/", "Ctrl+/", EditAction::ToggleComment, "leave lines out as comments, or bring them back"),
    named(
        NamedKey::Space,
        CTRL,
        "Ctrl+Space",
        EditAction::Propose,
        "propose what may be written; Tab takes it",
    ),
    letter(
        "p",
        "Ctrl+P",
        EditAction::MakeParam,
        "make a parameter with a slider of the number at the cursor",
    ),
    named(
        NamedKey::ArrowUp,
        ALT,
        "Alt+Up, Alt+Down",
        EditAction::TurnNumber { up: true },
        "turn the number at the cursor; with Shift finely. Dragging its grip, or it with Alt, does the same",
    ),
    named(NamedKey::ArrowDown, ALT, "", EditAction::TurnNumber { up: false }, ""),
    letter("e", "Ctrl+E or F8", EditAction::NextMistake, "go to the next mistake"),
    named(NamedKey::F8, NONE, "", EditAction::NextMistake, ""),
    named(
        NamedKey::Tab,
        CTRL,
        "Ctrl+Tab",
        EditAction::NextText,
        "the next text of this scene: those that it includes",
    ),
    letter("l", "Ctrl+L", EditAction::Light, "light up in the picture what the line at the cursor makes"),
    letter("k", "Ctrl+K", EditAction::Profile, "show what each object costs"),
    letter(
        "1",
        "Ctrl+1",
        EditAction::Answer { first: true },
        "the first answer to what is asked above the text",
    ),
    letter("2", "Ctrl+2", EditAction::Answer { first: false }, "the second answer"),
    letter("n", "Ctrl+N", EditAction::New, "begin a new scene"),
    named(
        NamedKey::Escape,
        NONE,
        "Esc",
        EditAction::Leave,
        "close what is open, then the editor; nothing is lost",
    ),
];

/// The rows of the table that people read: the written key and its meaning.
pub fn written_rows() -> impl Iterator<Item = &'static Row> {
    ROWS.iter().filter(|row| !row.written.is_empty())
}

/// What a key asks for with what is held, if it has a meaning of its own. Where the keyboard has other letters, the
/// key's place counts: `latin` is the letter that it has elsewhere.
pub(super) fn action_of(key: &Key, latin: Option<char>, held: Modifiers) -> Option<EditAction> {
    let shift = held.shift_key();
    let mut held = held - Modifiers::SHIFT;
    // What Ctrl does elsewhere, Command does on a Mac.
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

/// Where a key moves the cursor; `rows` lines are a page.
pub(super) fn way_of(key: &Key, held: Modifiers, rows: usize) -> Option<Move> {
    let (Key::Named(named), word) = (key, held.control_key()) else { return None };
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

/// The table for the page about the editor.
pub fn markdown_table() -> String {
    let rows = written_rows().map(|row| format!("| {} | {} |\n", row.written, row.meaning));
    format!("| key | what it does |\n|---|---|\n{}", rows.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_key_has_two_meanings() {
        for (index, row) in ROWS.iter().enumerate() {
            let same = |other: &Row| (&other.key, other.held) == (&row.key, row.held);
            assert!(!ROWS[..index].iter().any(same), "{:?} stands twice", row.key);
        }
    }

    #[test]
    fn letters_of_other_keyboards_are_taken_by_their_place() {
        let key = |text: &str| Key::Character(text.into());
        assert_eq!(action_of(&key("s"), None, CTRL), Some(EditAction::Save));
        assert_eq!(action_of(&key("ы"), Some('s'), CTRL), Some(EditAction::Save));
        assert_eq!(action_of(&key("S"), Some('s'), NONE), None);
        let shift = CTRL | Modifiers::SHIFT;
        assert_eq!(action_of(&key("Z"), Some('z'), shift), Some(EditAction::Redo));
        assert_eq!(action_of(&key("s"), Some('s'), CTRL | ALT), None);
    }

    #[test]
    fn the_page_about_the_editor_has_the_table() {
        let page = include_str!("../../../../docs/editor.md").replace("\r\n", "\n");
        assert!(page.contains(&markdown_table()), "put this into docs/editor.md:\n{}", markdown_table());
    }
}
