//! The state of the table of keys: a search text and a selected row. The overlay draws the table.

use mariana_commands::input::{Key, NamedKey};
use mariana_commands::{Binding, Command, Group, bindings_of};

use crate::file_browser::moved;
use crate::text_query::TextQuery;

/// Number of rows by which Page up and Page down move the selection.
const PAGE: usize = 8;

/// The search text and the selection.
#[derive(Debug, Default)]
pub struct HelpPanel {
    query: TextQuery,
    /// Index among the matching rows.
    pub selected: usize,
}

impl HelpPanel {
    /// The matching rows of each group. Groups without a matching row are left out.
    pub fn found(&self) -> Vec<(Group, Vec<&'static Binding>)> {
        let fits = |group: Group, binding: &Binding| {
            self.query.fits(&format!("{} {} {}", binding.written, binding.help, group.name()))
        };
        let of_group = |group| (group, bindings_of(group).filter(|binding| fits(group, binding)).collect());
        Group::ALL.into_iter().map(of_group).filter(|(_, rows): &(_, Vec<_>)| !rows.is_empty()).collect()
    }

    /// The search text.
    pub fn query(&self) -> &str {
        self.query.text()
    }

    /// Handles a key; `command` is true while Ctrl or Command is held. Letters search, arrows select, and Enter
    /// carries out the selected row. H and F1 close the table; H searches once there is a search text. Returns
    /// the key's commands; `None` for a key that belongs to the show.
    pub fn handle_key(&mut self, key: &Key, command: bool) -> Option<Vec<Command>> {
        let last = self.rows().len().saturating_sub(1);
        let selected = match key {
            Key::Named(NamedKey::Escape) if self.query().is_empty() => return Some(vec![CLOSE]),
            Key::Named(NamedKey::F1) => return Some(vec![CLOSE]),
            // Before a search, Space pauses.
            Key::Named(NamedKey::Space) if self.query().is_empty() => return None,
            Key::Character(letter)
                if self.query().is_empty() && !command && letter.eq_ignore_ascii_case("h") =>
            {
                return Some(vec![CLOSE]);
            }
            Key::Named(NamedKey::Enter) => return Some(self.pick(self.selected)),
            key => match moved(key, self.selected, PAGE) {
                Some(row) => row.min(last),
                None if self.query.handle_key(key, command) => self.row_of_key().unwrap_or(0),
                None => return None,
            },
        };
        self.selected = selected;
        Some(Vec::new())
    }

    /// The commands of the matching row with this index. They close the table, unless the row's key repeats.
    pub fn pick(&mut self, row: usize) -> Vec<Command> {
        let Some(binding) = self.rows().get(row).copied() else { return Vec::new() };
        self.selected = row;
        match binding.command() {
            // A search for "q" and Enter, or a click on the wrong row, must not end a show.
            Some(Command::ToggleHelp | Command::Leave | Command::Quit) => vec![CLOSE],
            command if binding.repeats => command.into_iter().collect(),
            command => [CLOSE].into_iter().chain(command).collect(),
        }
    }

    fn rows(&self) -> Vec<&'static Binding> {
        self.found().into_iter().flat_map(|(_, rows)| rows).collect()
    }

    /// The row of the key that the search text names, so that typing a key selects what the key does.
    fn row_of_key(&self) -> Option<usize> {
        let named = |binding: &&Binding| binding.caps().any(|cap| cap.eq_ignore_ascii_case(self.query()));
        self.rows().iter().position(named)
    }
}

const CLOSE: Command = Command::ToggleHelp;

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_commands::{Switch, bindings};

    fn press(help: &mut HelpPanel, key: NamedKey) -> Vec<Command> {
        help.handle_key(&Key::Named(key), false).unwrap_or_else(|| panic!("the table ignores {key:?}"))
    }

    fn typed(help: &mut HelpPanel, text: &str) {
        for letter in text.chars() {
            assert_eq!(help.handle_key(&Key::Character(letter.to_string()), false), Some(vec![]));
        }
    }

    #[test]
    fn every_key_is_in_the_table_once() {
        let rows = HelpPanel::default().rows();
        assert_eq!(rows.len(), bindings().count());
        assert!(bindings().all(|binding| rows.iter().any(|row| std::ptr::eq(*row, binding))));
    }

    #[test]
    fn typing_finds_rows_by_words_keys_and_groups_and_enter_acts() {
        let mut help = HelpPanel::default();
        typed(&mut help, "freeze");
        assert_eq!(help.found().len(), 1);
        assert_eq!(press(&mut help, NamedKey::Enter), [CLOSE, Command::Freeze(Switch::Toggle)]);
        assert_eq!(press(&mut help, NamedKey::Escape), []);
        typed(&mut help, "k");
        let kept = help.rows()[help.selected];
        assert_eq!(kept.command(), Some(Command::Keep(Switch::Toggle)), "the key that was typed is selected");
        let _ = press(&mut help, NamedKey::Escape);
        typed(&mut help, "for developers");
        assert_eq!(help.found().iter().map(|(group, _)| *group).collect::<Vec<_>>(), [Group::Developers]);
        typed(&mut help, " qqq");
        assert_eq!((help.found().len(), press(&mut help, NamedKey::Enter)), (0, vec![]));
        let _ = press(&mut help, NamedKey::Escape);
        assert_eq!(press(&mut help, NamedKey::Escape), [CLOSE]);
    }

    #[test]
    fn a_random_run_that_typed_into_the_table_ended_the_program() {
        let mut help = HelpPanel::default();
        typed(&mut help, "q");
        let row = help.rows()[help.selected];
        assert_eq!(row.command(), Some(Command::Quit));
        assert_eq!((press(&mut help, NamedKey::Enter), help.pick(help.selected)), (vec![CLOSE], vec![CLOSE]));
    }

    #[test]
    fn the_key_that_opens_the_table_closes_it_until_something_is_typed() {
        let mut help = HelpPanel::default();
        let h = Key::Character("h".to_owned());
        assert_eq!(help.handle_key(&h, false), Some(vec![CLOSE]));
        typed(&mut help, "s");
        assert_eq!(help.handle_key(&h, false), Some(vec![]));
        assert_eq!(help.query(), "sh");
        assert_eq!(press(&mut help, NamedKey::F1), [CLOSE]);
        for key in [Key::Named(NamedKey::F5), Key::Named(NamedKey::ArrowLeft), Key::Other] {
            assert_eq!(help.handle_key(&key, false), None, "{key:?} belongs to the show");
        }
    }

    #[test]
    fn arrows_stop_at_the_ends_and_repeating_keys_leave_the_table_open() {
        let mut help = HelpPanel::default();
        assert_eq!((press(&mut help, NamedKey::ArrowUp), help.selected), (vec![], 0));
        let _ = press(&mut help, NamedKey::End);
        let last = help.selected;
        let _ = press(&mut help, NamedKey::PageDown);
        assert_eq!((last, help.selected), (bindings().count() - 1, last));
        let _ = press(&mut help, NamedKey::Home);
        let _ = press(&mut help, NamedKey::ArrowDown);
        assert_eq!(press(&mut help, NamedKey::Enter), [Command::SeekBy(-mariana_commands::SEEK_SECONDS)]);
    }
}
