//! The search text of a list.

use mariana_commands::input::{Key, NamedKey};

/// Maximum length, in characters.
const LENGTH_MAX: usize = 60;

/// A search text. It matches a text that contains all its words, in any order.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct TextQuery(String);

impl TextQuery {
    pub(crate) fn text(&self) -> &str {
        &self.0
    }

    /// Handles a key that types or deletes. With `command` held, letters are ignored. Returns true if the text changed.
    pub(crate) fn handle_key(&mut self, key: &Key, command: bool) -> bool {
        match key {
            Key::Named(NamedKey::Escape) => !std::mem::take(&mut self.0).is_empty(),
            Key::Named(NamedKey::Backspace) => self.0.pop().is_some(),
            Key::Named(NamedKey::Space) => self.add(" "),
            Key::Character(text) if !command => self.add(text),
            _ => false,
        }
    }

    pub(crate) fn fits(&self, text: &str) -> bool {
        let text = text.to_lowercase();
        self.0.to_lowercase().split_whitespace().all(|word| text.contains(word))
    }

    pub(crate) fn begins(&self, text: &str) -> bool {
        let typed = self.0.trim().to_lowercase();
        !typed.is_empty() && text.to_lowercase().starts_with(&typed)
    }

    fn add(&mut self, text: &str) -> bool {
        let before = self.0.len();
        let room = LENGTH_MAX.saturating_sub(self.0.chars().count());
        self.0.extend(text.chars().filter(|c| !c.is_control()).take(room));
        self.0.len() != before
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_found_in_any_order_and_length_is_bounded() {
        let mut query = TextQuery::default();
        assert!(query.fits("anything") && !query.begins("anything"));
        for letter in ["S", "e", "a"] {
            assert!(query.handle_key(&Key::Character(letter.into()), false));
        }
        assert!(!query.handle_key(&Key::Character("x".into()), true), "Ctrl+X is not a letter");
        assert!(query.handle_key(&Key::Named(NamedKey::Space), false));
        assert!(query.handle_key(&Key::Character("d".into()), false));
        assert!(query.fits("deep sea") && query.fits("Seaside") && !query.fits("sea"));
        assert!(!query.begins("deep sea"));
        assert!(query.handle_key(&Key::Character("a".repeat(500)), false));
        assert_eq!(query.text().chars().count(), LENGTH_MAX);
        assert!(!query.handle_key(&Key::Character("a".into()), false));
        assert!(query.handle_key(&Key::Named(NamedKey::Escape), false) && query.text().is_empty());
        assert!(!query.handle_key(&Key::Named(NamedKey::Backspace), false));
    }
}
