//! The state of the file list, for music, playlists and scenes. The list replaces file dialogs, which some desktops
//! lack. The overlay draws it, and keys and the pointer change it. A thread reads folders, so that a slow disk does not
//! delay the show.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};

use directories::UserDirs;
use mariana_commands::input::{Key, NamedKey};

use crate::limits::LIMITS;
use crate::text_query::TextQuery;
use mariana_commands::{Command, Files, Panel};

/// An entry of a folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileEntry {
    /// File name without control characters.
    pub name: String,
    /// Full path.
    pub path: PathBuf,
    /// True for a folder or a link to a folder.
    pub is_folder: bool,
}

/// A shortcut to a folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// Display name, such as "Music".
    pub name: String,
    /// Full path.
    pub path: PathBuf,
}

const CLOSE: Command = Command::TogglePanel(Panel::Files);

/// The shown folder, the search text and the selection.
#[derive(Debug)]
pub struct FileBrowser {
    folder: PathBuf,
    places: Vec<Place>,
    entries: Vec<FileEntry>,
    /// Indices of the entries that match the search text.
    found: Vec<usize>,
    query: TextQuery,
    selected: usize,
    trouble: Option<String>,
    /// The folder that the user left by going up. It will be selected in its parent folder.
    came_from: Option<PathBuf>,
    wanted: Sender<PathBuf>,
    read: Receiver<(PathBuf, Result<Vec<FileEntry>, String>)>,
    revision: u64,
}

impl FileBrowser {
    /// Shows `folder`, or the user's music folder if it is `None`. `wake` is called when a folder has been read.
    ///
    /// # Errors
    /// Fails if the system cannot start another thread.
    pub fn start(folder: Option<PathBuf>, wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let (wanted, requests) = channel::<PathBuf>();
        let (answers, read) = channel();
        std::thread::Builder::new().name("folders".into()).spawn(move || {
            for folder in requests {
                let listing = entries_of(&folder);
                if answers.send((folder, listing)).is_err() {
                    return;
                }
                wake();
            }
        })?;
        let places = places();
        let begin = folder.or_else(|| places.first().map(|place| place.path.clone()));
        let mut browser = Self {
            folder: PathBuf::new(),
            places,
            entries: Vec::new(),
            found: Vec::new(),
            query: TextQuery::default(),
            selected: 0,
            trouble: None,
            came_from: None,
            wanted,
            read,
            revision: 0,
        };
        browser.enter(begin.unwrap_or_else(|| PathBuf::from("/")));
        Ok(browser)
    }

    /// The shown folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Shortcuts to common folders.
    pub fn places(&self) -> &[Place] {
        &self.places
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

    /// Index of the selected entry among the matching entries.
    pub fn selected(&self) -> usize {
        self.selected
    }

    /// A message that replaces the entries, such as an error.
    pub fn trouble(&self) -> Option<&str> {
        self.trouble.as_deref()
    }

    /// A number that grows whenever the list looks different.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Shows the entries of a folder that has been read.
    pub fn update(&mut self) {
        while let Ok((folder, listing)) = self.read.try_recv() {
            // Ignore a folder that the user has left.
            if folder != self.folder {
                continue;
            }
            tracing::debug!("{} is listed", folder.display());
            (self.entries, self.trouble) = match listing {
                Ok(entries) if entries.is_empty() => (entries, Some("this folder is empty".to_owned())),
                Ok(entries) => (entries, None),
                Err(reason) => (Vec::new(), Some(format!("this folder cannot be read: {reason}"))),
            };
            self.search();
            let left = self.came_from.take();
            let at = self
                .found
                .iter()
                .position(|at| self.entries.get(*at).is_some_and(|entry| Some(&entry.path) == left.as_ref()));
            self.selected = at.unwrap_or(0);
        }
    }

    /// Handles a key and returns its commands. Letters search, arrows select, Enter opens, and Backspace goes up.
    /// Escape clears the search text; without a search text it closes the list. With `shift`, opened files are added
    /// to the tracks. With `command`, Enter opens the whole folder.
    pub fn take_key(&mut self, key: &Key, shift: bool, command: bool) -> Vec<Command> {
        self.revision += 1;
        match key {
            Key::Named(NamedKey::Escape) if self.query.text().is_empty() => return vec![CLOSE],
            Key::Named(NamedKey::Enter) if command => return self.open_folder(shift),
            Key::Named(NamedKey::Enter) => return self.open(self.selected, shift),
            Key::Named(NamedKey::ArrowUp) => self.select(self.selected.saturating_sub(1)),
            Key::Named(NamedKey::ArrowDown) => self.select(self.selected + 1),
            Key::Named(NamedKey::PageUp) => self.select(self.selected.saturating_sub(10)),
            Key::Named(NamedKey::PageDown) => self.select(self.selected + 10),
            Key::Named(NamedKey::Home) => self.select(0),
            Key::Named(NamedKey::End) => self.select(usize::MAX),
            Key::Named(NamedKey::ArrowLeft) => self.go_up(),
            Key::Named(NamedKey::Backspace) if self.query.text().is_empty() => self.go_up(),
            key => {
                if self.query.take_key(key, command) {
                    self.search();
                    self.selected = 0;
                }
            }
        }
        Vec::new()
    }

    /// Opens the matching entry at an index: enters a folder, or plays a file.
    pub fn open(&mut self, place: usize, append: bool) -> Vec<Command> {
        self.select(place);
        let Some(entry) = self.entry(place).cloned() else { return Vec::new() };
        if entry.is_folder {
            self.enter(entry.path);
            return Vec::new();
        }
        self.pick(entry.path, append)
    }

    /// Plays everything in the shown folder.
    pub fn open_folder(&self, append: bool) -> Vec<Command> {
        self.pick(self.folder.clone(), append)
    }

    fn pick(&self, path: PathBuf, append: bool) -> Vec<Command> {
        vec![Command::Open(Files { files: vec![path], append }), CLOSE]
    }

    /// Enters the folder of a shortcut.
    pub fn enter_place(&mut self, place: usize) {
        if let Some(path) = self.places.get(place).map(|place| place.path.clone()) {
            self.enter(path);
        }
    }

    /// Enters the parent folder.
    pub fn go_up(&mut self) {
        if let Some(above) = self.folder.parent().map(Path::to_owned) {
            let left = self.folder.clone();
            self.enter(above);
            self.came_from = Some(left);
        }
    }

    fn enter(&mut self, folder: PathBuf) {
        self.query = TextQuery::default();
        (self.entries, self.found, self.selected) = (Vec::new(), Vec::new(), 0);
        (self.trouble, self.came_from) = (Some("reading ...".to_owned()), None);
        self.folder = folder.clone();
        self.revision += 1;
        if self.wanted.send(folder).is_err() {
            self.trouble = Some("folders can no longer be read: restart Mariana".to_owned());
        }
    }

    fn select(&mut self, place: usize) {
        self.selected = place.min(self.found.len().saturating_sub(1));
        self.revision += 1;
    }

    fn search(&mut self) {
        let fits = |entry: &FileEntry| self.query.fits(&entry.name);
        let all = self.entries.iter().enumerate();
        self.found = all.filter(|(_, entry)| fits(entry)).map(|(at, _)| at).collect();
        self.revision += 1;
    }
}

fn places() -> Vec<Place> {
    let user = UserDirs::new();
    let music = user.as_ref().and_then(|user| user.audio_dir().map(Path::to_owned));
    let home = user.as_ref().map(|user| user.home_dir().to_owned());
    let here = std::env::current_dir().ok();
    let root = here.as_ref().and_then(|here| here.ancestors().last().map(Path::to_owned));
    let all = [("Music", music), ("Home", home), ("Here", here), ("Computer", root)];
    let mut places: Vec<Place> = Vec::new();
    for (name, path) in all {
        let Some(path) = path.filter(|path| path.is_dir()) else { continue };
        if !places.iter().any(|place| place.path == path) {
            places.push(Place { name: name.to_owned(), path });
        }
    }
    places
}

/// The visible entries of a folder: folders first, then files, each by name.
fn entries_of(folder: &Path) -> Result<Vec<FileEntry>, String> {
    let listing = fs::read_dir(folder).map_err(|error| error.to_string())?;
    let mut entries: Vec<FileEntry> = listing
        .flatten()
        .take(LIMITS.folder_entries_max)
        .map(|entry| {
            let path = entry.path();
            let name = entry.file_name().to_string_lossy().replace(char::is_control, " ");
            FileEntry { name, is_folder: path.is_dir(), path }
        })
        .filter(|entry| !entry.name.starts_with('.'))
        .collect();
    entries.sort_by_cached_key(|entry| (!entry.is_folder, entry.name.to_lowercase(), entry.name.clone()));
    Ok(entries)
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    fn names(browser: &FileBrowser) -> Vec<&str> {
        (0..browser.count()).filter_map(|place| browser.entry(place)).map(|entry| &*entry.name).collect()
    }

    fn read(browser: &mut FileBrowser) {
        for _ in 0..2_000 {
            browser.update();
            if browser.trouble() != Some("reading ...") {
                return;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        panic!("the folder was not read");
    }

    fn folder() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("album")).unwrap();
        fs::create_dir(folder.path().join("empty")).unwrap();
        for name in ["b.flac", "A.mp3", ".hidden.mp3", "album/1.ogg"] {
            fs::write(folder.path().join(name), "x").unwrap();
        }
        folder
    }

    fn key(browser: &mut FileBrowser, key: NamedKey) -> Vec<Command> {
        browser.take_key(&Key::Named(key), false, false)
    }

    #[test]
    fn folders_are_entered_and_left_and_files_are_picked() {
        let folder = folder();
        let mut browser = FileBrowser::start(Some(folder.path().to_owned()), || {}).unwrap();
        read(&mut browser);
        assert_eq!(names(&browser), ["album", "empty", "A.mp3", "b.flac"]);
        assert_eq!(key(&mut browser, NamedKey::Enter), []);
        read(&mut browser);
        assert_eq!(names(&browser), ["1.ogg"]);
        let path = folder.path().join("album/1.ogg");
        let picked = browser.take_key(&Key::Named(NamedKey::Enter), true, false);
        let open = |path, append| [Command::Open(Files { files: vec![path], append }), CLOSE];
        assert_eq!(picked, open(path, true));
        let album = browser.take_key(&Key::Named(NamedKey::Enter), false, true);
        assert_eq!(album, open(folder.path().join("album"), false));
        assert_eq!(key(&mut browser, NamedKey::ArrowDown), []);
        assert_eq!(key(&mut browser, NamedKey::Backspace), []);
        read(&mut browser);
        assert_eq!(browser.entry(browser.selected()).unwrap().name, "album");
        assert_eq!(key(&mut browser, NamedKey::Escape), [CLOSE]);
    }

    #[test]
    fn letters_search_and_backspace_deletes_them_before_it_goes_up() {
        let folder = folder();
        let mut browser = FileBrowser::start(Some(folder.path().to_owned()), || {}).unwrap();
        read(&mut browser);
        for letter in ["M", "P"] {
            let _ = browser.take_key(&Key::Character(letter.into()), false, false);
        }
        assert_eq!((browser.query(), names(&browser)), ("MP", vec!["empty", "A.mp3"]));
        let _ = key(&mut browser, NamedKey::Backspace);
        assert_eq!((browser.query(), browser.folder()), ("M", folder.path()));
        assert_eq!(key(&mut browser, NamedKey::Escape), []);
        assert_eq!((browser.query(), browser.count()), ("", 4));
    }

    #[test]
    fn empty_and_unreadable_folders_show_a_message() {
        let folder = folder();
        let mut browser = FileBrowser::start(Some(folder.path().join("empty")), || {}).unwrap();
        read(&mut browser);
        assert_eq!(browser.trouble(), Some("this folder is empty"));
        assert_eq!(key(&mut browser, NamedKey::Enter), []);
        let mut browser = FileBrowser::start(Some(folder.path().join("missing")), || {}).unwrap();
        read(&mut browser);
        assert!(browser.trouble().unwrap().contains("cannot be read"), "{:?}", browser.trouble());
    }
}
