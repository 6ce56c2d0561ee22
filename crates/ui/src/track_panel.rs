//! The state of the track list: the selected row and the search. The overlay draws it, and keys and the pointer change
//! it.

use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

use mariana_commands::input::{Key, Modifiers, NamedKey};
use mariana_commands::{Command, Panel};
use mariana_player::ListedTracks;
use mariana_player::decode::TrackTags;
use mariana_player::tags::TagLibrary;

use crate::file_browser::{PAGE, moved};
use crate::text_query::TextQuery;

/// The tracks, the selected row and the search.
#[derive(Debug)]
pub struct TrackPanel {
    /// The whole list.
    pub list: Arc<ListedTracks>,
    tags: TagLibrary,
    /// The index of the playing track.
    pub present: usize,
    /// The selected row.
    pub selected: usize,
    /// The search text; `None` if there is no search.
    query: Option<TextQuery>,
    /// The indices of the matching tracks, during a search.
    found: Vec<usize>,
}

impl TrackPanel {
    /// Shows `list` and selects the track at index `present`.
    pub fn new(list: Arc<ListedTracks>, present: usize, tags: TagLibrary) -> Self {
        let selected = present.min(list.entries.len().saturating_sub(1));
        Self { list, tags, present, selected, query: None, found: Vec::new() }
    }

    /// Shows a changed list or another playing track.
    pub fn update(&mut self, list: &Arc<ListedTracks>, present: usize) {
        self.present = present;
        if !Arc::ptr_eq(&self.list, list) {
            self.list = list.clone();
            self.search();
            self.select(self.selected);
        }
    }

    /// The number of rows: of matching tracks during a search, otherwise of all tracks.
    pub fn rows(&self) -> usize {
        if self.is_filtered() { self.found.len() } else { self.list.entries.len() }
    }

    /// The index of the track in a row.
    pub fn track_in(&self, row: usize) -> Option<usize> {
        let index = if self.is_filtered() { *self.found.get(row)? } else { row };
        (index < self.list.entries.len()).then_some(index)
    }

    /// The tags of the track at an index, as far as they are known.
    pub fn tags_of(&self, index: usize) -> TrackTags {
        self.list.entries.get(index).map(|track| self.tags.of_track(track)).unwrap_or_default()
    }

    /// The search text; `None` if there is no search.
    pub fn query(&self) -> Option<&str> {
        self.query.as_ref().map(TextQuery::text)
    }

    /// True if the rows show only some of the tracks. Such rows cannot be moved.
    pub fn is_filtered(&self) -> bool {
        self.query.as_ref().is_some_and(|query| !query.text().is_empty())
    }

    /// True while keys type the search text.
    pub fn is_searching(&self) -> bool {
        self.query.is_some()
    }

    /// The number of tracks and their length in words, such as "12 tracks · 48:10".
    pub fn totals(&self, in_words: impl Fn(f64) -> String) -> String {
        let (count, totals) = (self.list.entries.len(), self.tags.totals());
        let tracks = if count == 1 { "1 track".to_owned() } else { format!("{count} tracks") };
        match (totals.seconds > 0.0, totals.unknown > 0) {
            (true, false) => format!("{tracks} · {}", in_words(totals.seconds)),
            (true, true) => format!("{tracks} · more than {}", in_words(totals.seconds)),
            (false, _) => tracks,
        }
    }

    /// A number that grows whenever the list or its tags change.
    pub fn revision(&self) -> u64 {
        self.tags.revision() + self.list.revision
    }

    /// Notes which rows are visible, so that their tags are read first.
    pub fn record_drawn(&self, rows: Range<usize>) {
        let visible = rows.filter_map(|row| self.list.entries.get(self.track_in(row)?));
        self.tags.request(visible.filter_map(|track| track.file.as_deref()));
    }

    /// Begins a search, or ends it and shows all tracks again.
    pub fn toggle_search(&mut self) {
        let index = self.track_in(self.selected);
        self.query = if self.query.is_none() { Some(TextQuery::default()) } else { None };
        self.search();
        // The selected track stays selected.
        self.select(index.unwrap_or(0));
    }

    /// Handles a key. Returns its commands; `None` for a key that belongs to the show. Arrows select, Enter plays,
    /// Delete removes, Alt and an arrow move the track, Ctrl+Z takes back the last change, and `/` or Ctrl+F searches.
    pub fn handle_key(&mut self, key: &Key, held: Modifiers) -> Option<Vec<Command>> {
        let command = held.intersects(Modifiers::CONTROL | Modifiers::SUPER);
        let is_letter =
            |wanted: &str| matches!(key, Key::Character(text) if text.eq_ignore_ascii_case(wanted));
        if command && is_letter("z") {
            return Some(vec![Command::UndoTracks]);
        }
        if command && is_letter("f") || !command && self.query.is_none() && is_letter("/") {
            self.toggle_search();
            return Some(Vec::new());
        }
        if held.contains(Modifiers::ALT) {
            return self.handle_move_key(key);
        }
        if let Some(row) = moved(key, self.selected, PAGE) {
            self.select(row);
            return Some(Vec::new());
        }
        let index = self.track_in(self.selected);
        match key {
            Key::Named(NamedKey::Enter) => {
                if self.is_searching() {
                    self.toggle_search();
                }
                Some(index.map(Command::PlayTrack).into_iter().collect())
            }
            Key::Named(NamedKey::Delete) => Some(index.map(Command::RemoveTrack).into_iter().collect()),
            Key::Named(NamedKey::Escape) if self.is_searching() => {
                self.toggle_search();
                Some(Vec::new())
            }
            key => {
                let query = self.query.as_mut()?;
                if query.handle_key(key, command) {
                    self.search();
                    self.select(0);
                }
                Some(Vec::new())
            }
        }
    }

    fn handle_move_key(&mut self, key: &Key) -> Option<Vec<Command>> {
        let to = moved(key, self.selected, PAGE)?.min(self.list.entries.len().saturating_sub(1));
        if self.is_filtered() || to == self.selected {
            return Some(Vec::new());
        }
        let from = std::mem::replace(&mut self.selected, to);
        Some(vec![Command::MoveTrack((from, to))])
    }

    /// Selects a row.
    pub fn select(&mut self, row: usize) {
        self.selected = row.min(self.rows().saturating_sub(1));
    }

    fn search(&mut self) {
        self.found.clear();
        let Some(query) = self.query.as_ref().filter(|query| !query.text().is_empty()) else { return };
        for (index, track) in self.list.entries.iter().enumerate() {
            let tags = self.tags.of_track(track);
            let file = track.file.as_ref().and_then(|file| file.file_name()).map(PathBuf::from);
            let file = file.unwrap_or_default();
            let texts = [Some(&*track.name), file.to_str(), tags.title.as_deref(), tags.artist.as_deref()];
            if query.fits(&texts.map(Option::unwrap_or_default).join(" ")) {
                self.found.push(index);
            }
        }
    }

    /// The command that opens the file list, to add tracks.
    pub const ADD: Command = Command::TogglePanel(Panel::Files);
}

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_player::ListedTrack;

    fn list(names: &[&str]) -> Arc<ListedTracks> {
        let entry = |name: &&str| ListedTrack { name: (*name).to_owned(), ..ListedTrack::default() };
        Arc::new(ListedTracks { revision: 1, entries: names.iter().map(entry).collect(), undo: None })
    }

    fn panel(names: &[&str], present: usize) -> TrackPanel {
        TrackPanel::new(list(names), present, TagLibrary::default())
    }

    fn key(panel: &mut TrackPanel, key: NamedKey) -> Option<Vec<Command>> {
        panel.handle_key(&Key::Named(key), Modifiers::empty())
    }

    fn letter(panel: &mut TrackPanel, text: &str, held: Modifiers) -> Option<Vec<Command>> {
        panel.handle_key(&Key::Character(text.to_owned()), held)
    }

    #[test]
    fn keys_select_play_move_and_remove() {
        let mut panel = panel(&["a", "b", "c"], 1);
        assert_eq!(panel.selected, 1);
        assert_eq!(key(&mut panel, NamedKey::ArrowDown), Some(vec![]));
        assert_eq!(key(&mut panel, NamedKey::ArrowDown), Some(vec![]));
        assert_eq!(key(&mut panel, NamedKey::Enter), Some(vec![Command::PlayTrack(2)]));
        let alt_up = panel.handle_key(&Key::Named(NamedKey::ArrowUp), Modifiers::ALT);
        assert_eq!((alt_up, panel.selected), (Some(vec![Command::MoveTrack((2, 1))]), 1));
        let alt_home = panel.handle_key(&Key::Named(NamedKey::Home), Modifiers::ALT);
        assert_eq!((alt_home, panel.selected), (Some(vec![Command::MoveTrack((1, 0))]), 0));
        assert_eq!(panel.handle_key(&Key::Named(NamedKey::ArrowUp), Modifiers::ALT), Some(vec![]));
        assert_eq!(key(&mut panel, NamedKey::Delete), Some(vec![Command::RemoveTrack(0)]));
        assert_eq!(letter(&mut panel, "z", Modifiers::CONTROL), Some(vec![Command::UndoTracks]));
        // Other keys belong to the show.
        assert_eq!(letter(&mut panel, "u", Modifiers::empty()), None);
        assert_eq!((key(&mut panel, NamedKey::Space), key(&mut panel, NamedKey::Escape)), (None, None));
    }

    #[test]
    fn an_empty_list_takes_all_keys_without_a_command() {
        let mut panel = panel(&[], 7);
        for pressed in [NamedKey::ArrowDown, NamedKey::End, NamedKey::Enter, NamedKey::Delete] {
            assert_eq!(key(&mut panel, pressed), Some(vec![]), "{pressed:?}");
            assert_eq!(panel.handle_key(&Key::Named(pressed), Modifiers::ALT).unwrap_or_default(), []);
        }
        assert_eq!((panel.selected, panel.track_in(0)), (0, None));
        assert_eq!(panel.totals(|_| "x".into()), "0 tracks");
    }

    #[test]
    fn a_search_shows_matching_tracks_and_keeps_their_indices() {
        let mut panel = panel(&["Ebb - The Tide", "Über - B", "Ebb - B"], 0);
        let none = Modifiers::empty();
        assert_eq!(letter(&mut panel, "/", none), Some(vec![]));
        for text in ["E", "b", "b"] {
            assert_eq!(letter(&mut panel, text, none), Some(vec![]));
        }
        assert_eq!(key(&mut panel, NamedKey::Space), Some(vec![]));
        assert_eq!(letter(&mut panel, "u", none), Some(vec![]), "letters are typed during a search");
        assert_eq!(panel.rows(), 0);
        let _ = key(&mut panel, NamedKey::Backspace);
        assert_eq!((panel.rows(), panel.track_in(1)), (2, Some(2)));
        let _ = key(&mut panel, NamedKey::ArrowDown);
        assert_eq!(panel.handle_key(&Key::Named(NamedKey::ArrowUp), Modifiers::ALT), Some(vec![]));
        // The list changes during the search.
        panel.update(&list(&["x", "Ebb", "y", "Ebb"]), 0);
        assert_eq!((panel.rows(), panel.selected, panel.track_in(1)), (2, 1, Some(3)));
        assert_eq!(key(&mut panel, NamedKey::Enter), Some(vec![Command::PlayTrack(3)]));
        assert_eq!((panel.query(), panel.rows(), panel.selected), (None, 4, 3));
    }
}
