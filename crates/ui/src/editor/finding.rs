//! What is looked for in the text.

use std::ops::Range;

use mariana_commands::input::{Key, Modifiers, NamedKey};
use mariana_editing::{Editing, find};

/// What is looked for.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default)]
pub(crate) struct Find {
    /// The words.
    pub query: String,
    /// Whether keys go there.
    pub typing: bool,
}

/// What a key means for the line of what is looked for.
pub(super) enum QueryKey {
    /// To go to the next place, or to the one before.
    Next { forward: bool },
    /// The words are others.
    Changed,
    /// Nothing.
    Other,
}

/// See the module.
#[derive(Default)]
pub(super) struct Finding {
    line: Option<Find>,
}

impl Finding {
    pub(super) fn line(&self) -> Option<&Find> {
        self.line.as_ref()
    }

    /// Opens the line for what is selected, or for what was looked for before.
    pub(super) fn begin(&mut self, selected: &[u8]) {
        let before = self.line.take().map(|find| find.query).unwrap_or_default();
        let selected = std::str::from_utf8(selected).ok();
        let selected = selected.filter(|text| !text.is_empty() && !text.contains('\n'));
        self.line = Some(Find { query: selected.map_or(before, str::to_owned), typing: true });
    }

    pub(super) fn close(&mut self) {
        self.line = None;
    }

    /// The words, if letters go there.
    pub(super) fn typed(&mut self) -> Option<&mut String> {
        self.line.as_mut().filter(|find| find.typing).map(|find| &mut find.query)
    }

    /// Takes a key.
    pub(super) fn take_key(&mut self, key: &Key, held: Modifiers) -> QueryKey {
        let Some(find) = self.line.as_mut().filter(|find| find.typing) else { return QueryKey::Other };
        match key {
            Key::Named(NamedKey::Enter) => QueryKey::Next { forward: !held.shift_key() },
            Key::Named(NamedKey::Backspace) => {
                find.query.pop();
                QueryKey::Changed
            }
            Key::Named(NamedKey::ArrowUp | NamedKey::ArrowDown) => {
                find.typing = false;
                QueryKey::Other
            }
            _ => QueryKey::Other,
        }
    }

    /// The next place in a text, or the one before; otherwise says that there is none. `None` if nothing is looked for.
    pub(super) fn next(&self, editing: &Editing, forward: bool) -> Option<Result<Range<usize>, String>> {
        let query = self.line.as_ref().map(|find| &find.query).filter(|query| !query.is_empty())?;
        let selection = editing.selection();
        let from = if forward { selection.end } else { selection.start };
        let place = find(editing.buffer().bytes(), query, from, forward);
        Some(place.ok_or_else(|| format!("\u{2018}{query}\u{2019} stands nowhere in this text")))
    }
}
