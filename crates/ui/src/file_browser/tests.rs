//! Tests of the file list.

use std::fs;
use std::sync::Mutex;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use super::*;

fn names(browser: &FileBrowser) -> Vec<&str> {
    (0..browser.count()).filter_map(|place| browser.entry(place)).map(|entry| &*entry.name).collect()
}

/// Waits until the folder and the system's folders are known.
pub(crate) fn read(browser: &mut FileBrowser) {
    for _ in 0..10_000 {
        browser.update();
        if browser.trouble() != Some(READING) && !browser.common.is_empty() {
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
    for name in ["10.flac", "2.MP3", "A.txt", ".hidden.mp3", "list.m3u8", "x.scene", "album/1.ogg"] {
        fs::write(folder.path().join(name), "x").unwrap();
    }
    folder
}

pub(crate) fn open(folder: &Path) -> FileBrowser {
    let (tags, remembered) = (TagLibrary::default(), RememberedFolders::default());
    let mut browser = FileBrowser::start(Some(folder.to_owned()), remembered, tags, || {});
    read(&mut browser);
    browser
}

fn key(browser: &mut FileBrowser, key: NamedKey) -> Vec<Command> {
    browser.handle_key(&Key::Named(key), Modifiers::empty())
}

fn typed(browser: &mut FileBrowser, text: &str) {
    for letter in text.chars() {
        let _ = browser.handle_key(&Key::Character(letter.to_string()), Modifiers::empty());
    }
}

#[test]
fn folders_are_entered_and_left_and_files_are_picked() {
    let folder = folder();
    let mut browser = open(folder.path());
    assert_eq!(names(&browser), ["album", "empty", "2.MP3", "10.flac", "list.m3u8", "x.scene", "A.txt"]);
    assert_eq!(key(&mut browser, NamedKey::Enter), []);
    read(&mut browser);
    assert_eq!(names(&browser), ["1.ogg"]);
    let path = folder.path().join("album/1.ogg");
    let open = |path: &Path, append| Command::Open(Files { files: vec![path.to_owned()], append });
    let enter = Key::Named(NamedKey::Enter);
    assert_eq!(browser.handle_key(&enter, Modifiers::SHIFT), [open(&path, true)], "the list stays open");
    assert_eq!(browser.handle_key(&enter, Modifiers::empty()), [open(&path, false), CLOSE]);
    let album = folder.path().join("album");
    assert_eq!(browser.handle_key(&enter, Modifiers::CONTROL), [open(&album, false), CLOSE]);
    assert_eq!(browser.handle_key(&enter, Modifiers::CONTROL | Modifiers::SHIFT), [open(&album, true)]);
    assert_eq!(key(&mut browser, NamedKey::ArrowDown), []);
    assert_eq!(browser.handle_key(&Key::Named(NamedKey::ArrowUp), Modifiers::ALT), []);
    read(&mut browser);
    assert_eq!(browser.entry(browser.selected).unwrap().name, "album");
    // A folder is added whole, and played whole.
    assert_eq!(browser.handle_key(&enter, Modifiers::SHIFT), [open(&album, true)]);
    assert_eq!(browser.play(0), [open(&album, false), CLOSE]);
    assert_eq!(key(&mut browser, NamedKey::ArrowRight), []);
    read(&mut browser);
    assert_eq!(key(&mut browser, NamedKey::Backspace), []);
    read(&mut browser);
    assert_eq!((browser.folder.as_path(), browser.selected), (folder.path(), 0));
    assert_eq!(key(&mut browser, NamedKey::Escape), [CLOSE]);
}

#[test]
fn letters_search_and_backspace_deletes_them_before_it_goes_up() {
    let folder = folder();
    let mut browser = open(folder.path());
    typed(&mut browser, "MP");
    assert_eq!((browser.query(), names(&browser)), ("MP", vec!["empty", "2.MP3"]));
    typed(&mut browser, "q");
    assert!(browser.trouble().unwrap().contains("shorten the search"));
    assert_eq!(key(&mut browser, NamedKey::Enter), []);
    let _ = key(&mut browser, NamedKey::Backspace);
    let _ = key(&mut browser, NamedKey::Backspace);
    assert_eq!((browser.query(), browser.folder.as_path()), ("M", folder.path()));
    assert_eq!(key(&mut browser, NamedKey::Escape), []);
    assert_eq!((browser.query(), browser.count()), ("", 7));
}

#[test]
fn the_search_finds_titles_and_artists() {
    let folder = tempfile::tempdir().unwrap();
    let tags = [("TIT2", "Grüße aus 東京"), ("TPE1", "The Tide")];
    let song = folder.path().join("01.wav");
    mariana_testing::wave::write_tagged_wav(&song, 8_000, 1, std::iter::repeat_n(0.0, 80), &tags);
    fs::write(folder.path().join("02.wav"), "x").unwrap();
    let (wake, woken) = channel();
    let library = TagLibrary::start(None, move || wake.send(()).unwrap_or_default()).unwrap();
    let remembered = RememberedFolders::default();
    let mut browser = FileBrowser::start(Some(folder.path().to_owned()), remembered, library, || {});
    read(&mut browser);
    browser.record_drawn(0..browser.count());
    let before = browser.revision();
    while browser.tags.get(&song).is_none() {
        woken.recv_timeout(Duration::from_secs(60)).expect("the tags are read");
    }
    typed(&mut browser, "tide 東");
    assert_eq!(names(&browser), ["01.wav"]);
    assert!(browser.revision() > before);
    typed(&mut browser, "z");
    assert_eq!(browser.count(), 0);
}

#[test]
fn empty_and_unreadable_folders_show_a_message() {
    let folder = folder();
    let mut browser = open(&folder.path().join("empty"));
    assert_eq!(browser.trouble(), Some("this folder is empty"));
    assert_eq!(key(&mut browser, NamedKey::Enter), []);
    let browser = open(&folder.path().join("missing"));
    assert!(browser.trouble().unwrap().contains("cannot be read"), "{:?}", browser.trouble());
}

#[test]
fn shortcuts_are_reached_by_tab_and_folders_can_be_marked() {
    let folder = folder();
    let recent = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let remembered = RememberedFolders {
        favourites: [recent("album")].into(),
        recent: vec![recent("empty"), recent("album")],
    };
    let mut browser =
        FileBrowser::start(Some(folder.path().to_owned()), remembered, TagLibrary::default(), || {});
    read(&mut browser);
    let kinds =
        |browser: &FileBrowser| -> Vec<PlaceKind> { browser.places.iter().map(|place| place.kind).collect() };
    let all = kinds(&browser);
    assert_eq!((all[0], all[all.len() - 1]), (PlaceKind::Favourite, PlaceKind::Recent));
    assert_eq!(all.iter().filter(|kind| **kind == PlaceKind::Recent).count(), 1, "a folder is listed twice");
    assert_eq!(key(&mut browser, NamedKey::Tab), []);
    assert_eq!(browser.selected_place, Some(0));
    let _ = (key(&mut browser, NamedKey::End), key(&mut browser, NamedKey::ArrowDown));
    assert_eq!(browser.selected_place, Some(all.len() - 1));
    let _ = key(&mut browser, NamedKey::Enter);
    read(&mut browser);
    assert_eq!(
        (browser.folder.as_path(), browser.selected_place),
        (folder.path().join("empty").as_path(), None)
    );
    assert!(!browser.is_favourite());
    let marked = browser.handle_key(&Key::Character("d".into()), Modifiers::CONTROL);
    assert_eq!(marked, [Command::MarkFolders([recent("album"), recent("empty")].into())]);
    assert!(browser.is_favourite() && kinds(&browser)[1] == PlaceKind::Favourite);
    assert_eq!(browser.mark(), [Command::MarkFolders([recent("album")].into())]);
    // A letter in the shortcuts searches the entries.
    let _ = key(&mut browser, NamedKey::Tab);
    typed(&mut browser, "x");
    assert_eq!((browser.selected_place, browser.query()), (None, "x"));
}

/// A reader that waits for a message before it lists a folder called "slow".
fn slow_reader() -> (FolderReader, std::sync::mpsc::Sender<()>) {
    let (go_on, waits) = channel::<()>();
    let waits: Mutex<Receiver<()>> = Mutex::new(waits);
    let read = move |folder: &Path| {
        if folder.ends_with("slow") {
            let _ = waits.lock().unwrap().recv();
        }
        entries_of(folder)
    };
    (FolderReader::new(read, || {}), go_on)
}

#[test]
fn a_folder_that_does_not_answer_delays_no_other_folder() {
    let folder = folder();
    fs::create_dir(folder.path().join("slow")).unwrap();
    fs::write(folder.path().join("slow/s.ogg"), "x").unwrap();
    let (reader, go_on) = slow_reader();
    let slow = folder.path().join("slow");
    let (tags, remembered) = (TagLibrary::default(), RememberedFolders::default());
    let mut browser = FileBrowser::with_reader(Some(slow.clone()), remembered, tags, reader);
    browser.update();
    assert_eq!(browser.trouble(), Some(READING));
    browser.enter_parent();
    read(&mut browser);
    assert_eq!(browser.entry(browser.selected).unwrap().name, "slow");
    // Too many folders without an answer are refused with a sentence.
    for _ in 0..limits::FOLDERS_READ_MAX + 1 {
        browser.enter(slow.clone());
    }
    assert!(browser.trouble().unwrap().contains("do not answer"), "{:?}", browser.trouble());
    drop(go_on);
    while browser.reader.request(folder.path().to_owned()).is_err() {
        std::thread::sleep(Duration::from_millis(2));
    }
    browser.enter(slow);
    read(&mut browser);
    assert_eq!(names(&browser), ["s.ogg"]);
}
