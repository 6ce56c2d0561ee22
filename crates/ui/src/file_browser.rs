//! The state of the file list, for music, playlists and scenes. The list replaces file dialogs, which some desktops
//! lack. The overlay draws it, and keys and the pointer change it. Threads read folders and tags, so that a slow disk
//! does not delay the show.

mod reading;

use std::collections::BTreeSet;
use std::ops::Range;
use std::path::{Path, PathBuf};

use mariana_commands::input::{Key, Modifiers, NamedKey};
use mariana_player::tags::TagLibrary;

use crate::limits;
use crate::text_query::TextQuery;
use mariana_commands::{Command, Files, Panel};
use reading::{Answer, FolderReader, common_places, entries_of};

/// An entry of a folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileEntry {
    /// File name without control characters.
    pub name: String,
    /// Full path.
    pub path: PathBuf,
    /// The kind, by the file's extension.
    pub kind: FileKind,
}

/// Kinds of entries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileKind {
    /// A folder or a link to a folder.
    Folder,
    /// A music file.
    Music,
    /// A playlist.
    List,
    /// A scene.
    Scene,
    /// Any other file.
    Other,
}

/// A shortcut to a folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// Display name, such as "Music".
    pub name: String,
    /// Full path.
    pub path: PathBuf,
    /// The origin of the shortcut.
    pub kind: PlaceKind,
}

/// Origins of shortcuts, in the order of the list.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlaceKind {
    /// The user has marked the folder.
    Favourite,
    /// The system provides the folder.
    Common,
    /// The system mounts disks there.
    Media,
    /// Music was opened from the folder.
    Recent,
}

/// The folders that the settings remember. Only paths in UTF-8 can be remembered.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct RememberedFolders {
    /// The folders that the user has marked.
    pub favourites: BTreeSet<String>,
    /// The folders from which music was opened, the newest first.
    pub recent: Vec<String>,
}

pub(crate) const CLOSE: Command = Command::TogglePanel(Panel::Files);
const READING: &str = "reading this folder; a slow disk or network takes a while";
pub(crate) const PAGE: usize = 10;

/// The shown folder, the search text and the selection.
pub struct FileBrowser {
    /// The shown folder. Empty until the first folder is known.
    pub folder: PathBuf,
    remembered: RememberedFolders,
    /// The folders that the system provides, once they are known.
    common: Vec<Place>,
    /// Shortcuts to folders, grouped by their kind.
    pub places: Vec<Place>,
    entries: Vec<FileEntry>,
    /// Indices of the entries that match the search text.
    found: Vec<usize>,
    query: TextQuery,
    /// Index of the selected entry among the matching entries.
    pub selected: usize,
    /// The selected shortcut, while keys act on the shortcuts.
    pub selected_place: Option<usize>,
    trouble: Option<String>,
    /// The folder that the user left by going up. It will be selected in its parent folder.
    came_from: Option<PathBuf>,
    reader: FolderReader,
    /// The tags of files.
    pub tags: TagLibrary,
    revision: u64,
}

impl FileBrowser {
    /// Shows `folder`; for `None`, the user's music folder once it is known. `wake` is called when a folder has been
    /// read.
    pub fn start(
        folder: Option<PathBuf>,
        remembered: RememberedFolders,
        tags: TagLibrary,
        wake: impl Fn() + Send + Sync + 'static,
    ) -> Self {
        Self::with_reader(folder, remembered, tags, FolderReader::new(entries_of, wake))
    }

    fn with_reader(
        folder: Option<PathBuf>,
        remembered: RememberedFolders,
        tags: TagLibrary,
        reader: FolderReader,
    ) -> Self {
        let mut browser = Self {
            folder: PathBuf::new(),
            remembered,
            common: Vec::new(),
            places: Vec::new(),
            entries: Vec::new(),
            found: Vec::new(),
            query: TextQuery::default(),
            selected: 0,
            selected_place: None,
            trouble: Some(READING.to_owned()),
            came_from: None,
            reader,
            tags,
            revision: 0,
        };
        browser.list_places();
        browser.trouble = browser.reader.start(|| Answer::Places(common_places())).err().or(browser.trouble);
        if let Some(folder) = folder {
            browser.enter(folder);
        }
        browser
    }

    /// True if the user has marked the shown folder.
    pub fn is_favourite(&self) -> bool {
        self.folder.to_str().is_some_and(|folder| self.remembered.favourites.contains(folder))
    }

    /// The number of matching entries.
    pub fn count(&self) -> usize {
        self.found.len()
    }

    /// The matching entry at an index.
    pub fn entry(&self, place: usize) -> Option<&FileEntry> {
        self.entries.get(*self.found.get(place)?)
    }

    /// The search text.
    pub fn query(&self) -> &str {
        self.query.text()
    }

    /// A message that replaces the entries, such as an error.
    pub fn trouble(&self) -> Option<&str> {
        match &self.trouble {
            None if self.found.is_empty() => Some("no file matches: press Backspace to shorten the search"),
            trouble => trouble.as_deref(),
        }
    }

    /// A number that grows whenever the list or the tags change.
    pub fn revision(&self) -> u64 {
        self.revision + self.tags.revision()
    }

    /// Shows the entries of a folder that has been read, and the folders that the system provides.
    pub fn update(&mut self) {
        for answer in self.reader.answers() {
            match answer {
                Answer::Places(places) => self.show_places(places),
                Answer::Folder(folder, listing) if folder == self.folder => self.show_listing(listing),
                // The user has left this folder.
                Answer::Folder(..) => {}
            }
        }
    }

    fn show_places(&mut self, places: Vec<Place>) {
        self.common = places;
        self.list_places();
        if self.folder.as_os_str().is_empty() {
            let first = self.common.first().map(|place| place.path.clone());
            self.enter(first.unwrap_or_else(|| PathBuf::from("/")));
        }
    }

    fn show_listing(&mut self, listing: Result<Vec<FileEntry>, String>) {
        tracing::debug!("{} is listed", self.folder.display());
        (self.entries, self.trouble) = match listing {
            Ok(entries) if entries.is_empty() => (entries, Some("this folder is empty".to_owned())),
            Ok(entries) => (entries, None),
            Err(reason) => (Vec::new(), Some(format!("this folder cannot be read: {reason}"))),
        };
        self.search();
        let music = self.entries.iter().filter(|entry| entry.kind == FileKind::Music);
        self.tags.request_folder(music.map(|entry| entry.path.clone()));
        let left = self.came_from.take();
        let is_left =
            |at: &usize| self.entries.get(*at).is_some_and(|entry| Some(&entry.path) == left.as_ref());
        self.selected = self.found.iter().position(is_left).unwrap_or(0);
    }

    /// Notes which matching entries are visible, so that their tags are read first.
    pub fn record_drawn(&self, places: Range<usize>) {
        let visible = places.filter_map(|place| self.entry(place));
        let music = visible.filter(|entry| entry.kind == FileKind::Music);
        self.tags.request(music.map(|entry| entry.path.as_path()));
    }

    /// Handles a key and returns its commands. Letters search, arrows select, Enter opens, and Backspace or Alt+Up goes
    /// up. Tab switches between the entries and the shortcuts. Shift+Enter adds the entry to the tracks. Ctrl+Enter
    /// plays the whole folder, and Ctrl+Shift+Enter adds it. Ctrl+D marks the folder. Escape clears the search text;
    /// without a search text it closes the list.
    pub fn handle_key(&mut self, key: &Key, held: Modifiers) -> Vec<Command> {
        let command = held.intersects(Modifiers::CONTROL | Modifiers::SUPER);
        let shift = held.contains(Modifiers::SHIFT);
        match key {
            Key::Named(NamedKey::Escape) if self.query.text().is_empty() => return vec![CLOSE],
            Key::Named(NamedKey::Enter) if command => return self.open_folder(shift),
            Key::Character(letter) if command && letter.eq_ignore_ascii_case("d") => return self.mark(),
            Key::Named(NamedKey::ArrowUp) if held.contains(Modifiers::ALT) => self.enter_parent(),
            Key::Named(NamedKey::Tab) => {
                let first = self.places.iter().position(|place| place.path == self.folder).unwrap_or(0);
                let to_places = self.selected_place.is_none() && !self.places.is_empty();
                self.selected_place = to_places.then_some(first);
            }
            Key::Named(named) if self.selected_place.is_some() && self.handle_place_key(*named) => {}
            Key::Named(NamedKey::Enter) => return self.open(self.selected, shift),
            Key::Named(NamedKey::ArrowRight) => {
                if self.entry(self.selected).is_some_and(|entry| entry.kind == FileKind::Folder) {
                    return self.open(self.selected, false);
                }
            }
            Key::Named(NamedKey::ArrowLeft) => self.enter_parent(),
            Key::Named(NamedKey::Backspace) if self.query.text().is_empty() => self.enter_parent(),
            key => {
                if let Some(place) = moved(key, self.selected, PAGE) {
                    self.select(place);
                } else if self.query.handle_key(key, command) {
                    self.selected_place = None;
                    self.search();
                    self.selected = 0;
                }
            }
        }
        Vec::new()
    }

    /// Handles a key for the shortcuts. Returns false for other keys.
    fn handle_place_key(&mut self, key: NamedKey) -> bool {
        let selected = self.selected_place.unwrap_or(0);
        match key {
            NamedKey::Enter | NamedKey::ArrowRight => self.enter_place(selected),
            NamedKey::ArrowLeft => {}
            key => {
                let Some(place) = moved(&Key::Named(key), selected, PAGE) else { return false };
                self.selected_place = Some(place.min(self.places.len().saturating_sub(1)));
            }
        }
        true
    }

    /// Opens the matching entry at an index: enters a folder, or plays a file. With `append`, adds the folder or the
    /// file to the tracks; the list then stays open.
    pub fn open(&mut self, place: usize, append: bool) -> Vec<Command> {
        self.select(place);
        let Some(entry) = self.entry(place).cloned() else { return Vec::new() };
        if entry.kind == FileKind::Folder && !append {
            self.enter(entry.path);
            return Vec::new();
        }
        pick(entry.path, append)
    }

    /// Plays the matching entry at an index; of a folder, everything in it.
    pub fn play(&mut self, place: usize) -> Vec<Command> {
        self.select(place);
        self.entry(place).map(|entry| pick(entry.path.clone(), false)).unwrap_or_default()
    }

    /// Plays everything in the shown folder, or adds it to the tracks.
    pub fn open_folder(&self, append: bool) -> Vec<Command> {
        pick(self.folder.clone(), append)
    }

    /// Marks the shown folder as a favourite, or removes the mark.
    pub fn mark(&mut self) -> Vec<Command> {
        let Some(folder) = self.folder.to_str().filter(|folder| !folder.is_empty()) else {
            return Vec::new();
        };
        let favourites = &mut self.remembered.favourites;
        if !favourites.remove(folder) && favourites.len() < limits::FAVOURITE_FOLDERS_MAX {
            favourites.insert(folder.to_owned());
        }
        let marked = favourites.clone();
        self.list_places();
        vec![Command::MarkFolders(marked)]
    }

    /// Enters the folder of a shortcut.
    pub fn enter_place(&mut self, place: usize) {
        if let Some(path) = self.places.get(place).map(|place| place.path.clone()) {
            self.selected_place = None;
            self.enter(path);
        }
    }

    /// Enters the parent folder.
    pub fn enter_parent(&mut self) {
        if let Some(above) = self.folder.parent().map(Path::to_owned) {
            let left = self.folder.clone();
            self.enter(above);
            self.came_from = Some(left);
        }
    }

    fn enter(&mut self, folder: PathBuf) {
        self.query = TextQuery::default();
        (self.entries, self.found, self.selected) = (Vec::new(), Vec::new(), 0);
        self.came_from = None;
        self.folder.clone_from(&folder);
        self.revision += 1;
        self.trouble = Some(self.reader.request(folder).err().unwrap_or_else(|| READING.to_owned()));
    }

    fn select(&mut self, place: usize) {
        self.selected = place.min(self.found.len().saturating_sub(1));
        self.selected_place = None;
    }

    fn search(&mut self) {
        let fits = |entry: &FileEntry| {
            let music = Some(entry).filter(|entry| entry.kind == FileKind::Music);
            let tags = music.and_then(|entry| self.tags.get(&entry.path)).unwrap_or_default();
            let texts = [Some(&*entry.name), tags.title.as_deref(), tags.artist.as_deref()];
            self.query.fits(&texts.map(Option::unwrap_or_default).join(" "))
        };
        let all = self.entries.iter().enumerate();
        self.found = all.filter(|(_, entry)| fits(entry)).map(|(at, _)| at).collect();
        self.revision += 1;
    }

    fn list_places(&mut self) {
        let of = |kind: PlaceKind| {
            move |path: &String| {
                let path = PathBuf::from(path);
                let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
                Place { name: name.replace(char::is_control, " "), path, kind }
            }
        };
        self.places = self.remembered.favourites.iter().map(of(PlaceKind::Favourite)).collect();
        self.places.extend(self.common.iter().cloned());
        for recent in self.remembered.recent.iter().map(of(PlaceKind::Recent)) {
            if !self.places.iter().any(|place| place.path == recent.path) {
                self.places.push(recent);
            }
        }
        let last = self.places.len().saturating_sub(1);
        self.selected_place = self.selected_place.map(|place| place.min(last));
        self.revision += 1;
    }
}

fn pick(path: PathBuf, append: bool) -> Vec<Command> {
    let open = Command::Open(Files { files: vec![path], append });
    if append { vec![open] } else { vec![open, CLOSE] }
}

/// The index to which a key moves a selection in pages of this many rows, not limited by the number of rows; `None` for other keys.
pub(crate) fn moved(key: &Key, selected: usize, page: usize) -> Option<usize> {
    let Key::Named(named) = key else { return None };
    match named {
        NamedKey::ArrowUp => Some(selected.saturating_sub(1)),
        NamedKey::ArrowDown => Some(selected.saturating_add(1)),
        NamedKey::PageUp => Some(selected.saturating_sub(page)),
        NamedKey::PageDown => Some(selected.saturating_add(page)),
        NamedKey::Home => Some(0),
        NamedKey::End => Some(usize::MAX),
        _ => None,
    }
}

#[cfg(test)]
pub(crate) mod tests;
