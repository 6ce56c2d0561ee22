//! Tests of reading tags ahead.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use super::*;
use crate::listed::{ListedTrack, ListedTracks};
use mariana_testing::wave::write_tagged_wav;

const PATIENCE: Duration = Duration::from_secs(60);

/// A library with its cache in a folder, and the calls of `wake`.
fn library(folder: &Path) -> (TagLibrary, Receiver<()>) {
    let (wake, woken) = channel();
    let wake = move || wake.send(()).unwrap_or_default();
    (TagLibrary::start(Some(folder.join("cache/tags")), wake).unwrap(), woken)
}

fn wait_for(library: &TagLibrary, woken: &Receiver<()>, what: &str, is_so: impl Fn(&TagLibrary) -> bool) {
    let begun = Instant::now();
    while !is_so(library) {
        assert!(begun.elapsed() < PATIENCE, "timed out waiting for {what}");
        let _ = woken.recv_timeout(Duration::from_millis(50));
    }
}

fn song(folder: &Path, name: &str, title: &str, seconds: f64) -> PathBuf {
    let path = folder.join(name);
    let samples = std::iter::repeat_n(0.0, (seconds * 8_000.0) as usize);
    write_tagged_wav(&path, 8_000, 1, samples, &[("TIT2", title), ("TPE1", "an artist")]);
    path
}

fn list_of(files: &[PathBuf]) -> Arc<ListedTracks> {
    let entry = |file: &PathBuf| ListedTrack { file: Some(file.clone()), ..ListedTrack::default() };
    Arc::new(ListedTracks { revision: 1, entries: files.iter().map(entry).collect(), undo: None })
}

fn title(library: &TagLibrary, file: &Path) -> Option<Option<String>> {
    library.get(file).map(|tags| tags.title.clone())
}

#[test]
fn the_tags_of_a_list_are_read_without_playing_it() {
    let folder = tempfile::tempdir().unwrap();
    let files = [song(folder.path(), "a.wav", "夜 🎵 \u{1}x", 2.0), song(folder.path(), "b.wav", "", 3.0)];
    let junk = folder.path().join("junk.mp3");
    fs::write(&junk, b"no music at all").unwrap();
    let missing = folder.path().join("missing.ogg");
    let (library, woken) = library(folder.path());
    let all = [&files[..], &[junk.clone(), missing.clone(), folder.path().to_owned()]].concat();
    let list = list_of(&all);
    library.follow_list(&list);
    wait_for(&library, &woken, "all tags", |library| all.iter().all(|file| library.get(file).is_some()));
    wait_for(&library, &woken, "the totals", |library| library.totals().unknown == 3);
    assert_eq!(library.totals(), Totals { seconds: 5.0, unknown: 3 });
    let first = library.of_track(&list.entries[0]);
    let expected =
        TrackTags { title: Some("夜 🎵 x".into()), artist: Some("an artist".into()), duration: Some(2.0) };
    assert_eq!(first, expected);
    // A part of a file keeps its own data.
    let part = ListedTrack { start: Some(1.0), title: Some("part".into()), ..list.entries[0].clone() };
    assert_eq!(library.of_track(&part), TrackTags { title: Some("part".into()), ..TrackTags::default() });
    // A name from a playlist is used for a file without a title.
    let named = ListedTrack { title: Some("from the list".into()), ..list.entries[1].clone() };
    assert_eq!(library.of_track(&named).title.as_deref(), Some("from the list"));
    drop(library);
    let end = std::iter::repeat_with(|| woken.recv_timeout(PATIENCE)).find(Result::is_err);
    assert_eq!(end, Some(Err(RecvTimeoutError::Disconnected)), "the thread ends");
}

#[test]
fn unchanged_files_are_taken_from_the_cache_and_changed_files_are_read_again() {
    let folder = tempfile::tempdir().unwrap();
    let files = [song(folder.path(), "a.wav", "one", 1.0), song(folder.path(), "b.wav", "two", 1.0)];
    let cache = folder.path().join("cache/tags");
    let read_all = || {
        let (library, woken) = library(folder.path());
        library.follow_list(&list_of(&files));
        wait_for(&library, &woken, "the tags", |library| {
            files.iter().all(|file| library.get(file).is_some())
        });
        let titles = files.each_ref().map(|file| title(&library, file).flatten().unwrap_or_default());
        // The thread saves at its end.
        drop(library);
        while woken.recv_timeout(PATIENCE) != Err(RecvTimeoutError::Disconnected) {}
        titles
    };
    assert_eq!(read_all(), ["one", "two"]);
    // The cache decides while the file is unchanged.
    let text = fs::read_to_string(&cache).unwrap();
    fs::write(&cache, text.replace("\"one\"", "\"cached\"").replace("\"two\"", "\"cached, too\"")).unwrap();
    song(folder.path(), "b.wav", "a new title", 2.0);
    assert_eq!(read_all(), ["cached", "a new title"]);
    // Rubbish costs nothing.
    for rubbish in
        ["", "\0\0\0", "Mariana's tags, version 2\n[1]\n{\n[\"/x\",1,2,null,null,1e999]\n\u{1F3B5}"]
    {
        fs::write(&cache, rubbish).unwrap();
        assert_eq!(read_all(), ["one", "a new title"], "{rubbish:?}");
    }
}

#[test]
fn visible_rows_come_before_the_folder_and_the_folder_before_the_list() {
    let path = |name: &str| PathBuf::from(format!("/nowhere/{name}"));
    let library = TagLibrary::default();
    let list: Vec<PathBuf> = (0..3).map(|n| path(&format!("list {n}"))).collect();
    library.follow_list(&list_of(&list));
    library.request_folder([path("folder")]);
    library.request([path("row").as_path()]);
    let mut order = Vec::new();
    loop {
        let next = library.0.lock().next();
        let Some(file) = next else { break };
        library.0.lock().insert(&file, Stamp::default(), Arc::default(), true);
        order.push(file);
    }
    assert_eq!(order, [&[path("row"), path("folder")], &list[..]].concat());
    library.request([path("row").as_path()]);
    assert_eq!(library.0.lock().next(), None, "a known file is not read again");
}

#[test]
fn at_the_limit_the_tags_are_forgotten_and_the_list_is_read_again() {
    let mut state = State { list_at: 7, ..State::default() };
    let path = |n: usize| PathBuf::from(format!("/nowhere/{n}"));
    for n in 0..=limits::TAGS_KEPT_MAX {
        state.insert(&path(n), Stamp::default(), Arc::default(), true);
    }
    assert!(state.known.len() <= limits::TAGS_KEPT_MAX);
    assert!(!state.is_current(&path(0)) && state.is_current(&path(limits::TAGS_KEPT_MAX)));
    assert_eq!(state.list_at, 0);
}

#[test]
fn tags_of_a_megabyte_and_damaged_files_do_no_harm() {
    let folder = tempfile::tempdir().unwrap();
    let huge = song(folder.path(), "huge.wav", &"ü".repeat(1 << 19), 1.0);
    let whole = fs::read(song(folder.path(), "whole.wav", "a title", 1.0)).unwrap();
    let mut files = vec![huge.clone()];
    for length in (0..120).chain([whole.len() - 1]) {
        let path = folder.path().join(format!("{length}.wav"));
        fs::write(&path, &whole[..length]).unwrap();
        files.push(path);
    }
    let (library, woken) = library(folder.path());
    library.request(files.iter().map(PathBuf::as_path));
    wait_for(&library, &woken, "all tags", |library| files.iter().all(|file| library.get(file).is_some()));
    let letters = title(&library, &huge).flatten().map_or(0, |title| title.chars().count());
    assert!(letters <= limits::NAME_LETTERS_MAX + 1, "{letters}");
}

/// With `MARIANA_FIGURES` set, prints the time and the memory for the tags of 10,000 files.
#[test]
fn ten_thousand_tracks_take_little_memory() {
    let count = if std::env::var_os("MARIANA_FIGURES").is_some() { 10_000 } else { 300 };
    let folder = tempfile::tempdir().unwrap();
    let file = |n: usize| {
        song(folder.path(), &format!("{n:05} a song of the usual length.wav"), &format!("title {n}"), 0.01)
    };
    let files: Vec<PathBuf> = (0..count).map(file).collect();
    let (before, begun) = (resident_bytes(), Instant::now());
    let list = list_of(&files);
    let run = || {
        let (library, woken) = library(folder.path());
        library.follow_list(&list);
        wait_for(&library, &woken, "all tags", |library| library.0.lock().list_at == count);
        wait_for(&library, &woken, "the totals", |library| library.totals().seconds > 0.0);
        library
    };
    let first = run();
    let (took, bytes) = (begun.elapsed(), resident_bytes().saturating_sub(before));
    assert!(files.iter().all(|file| first.get(file).is_some()));
    drop(first);
    let begun = Instant::now();
    drop(run());
    println!("{count} tracks: {took:.2?} and {} KiB, again {:.2?}", bytes >> 10, begun.elapsed());
    // Each track may take 4 KiB; the allocator and the thread have a constant share.
    assert!(bytes < (16 << 20) + count * 4096, "{bytes} bytes for {count} tracks");
}

fn resident_bytes() -> usize {
    let text = fs::read_to_string("/proc/self/statm").unwrap_or_default();
    text.split(' ').nth(1).and_then(|pages| pages.parse::<usize>().ok()).unwrap_or_default() * 4096
}

#[test]
fn a_relative_path_is_the_same_file_as_its_absolute_path() {
    let mut state = State::default();
    let here = std::env::current_dir().unwrap();
    state.insert(Path::new("x.wav"), Stamp::default(), Arc::default(), true);
    assert!(state.is_current(&here.join("x.wav")) && state.is_current(Path::new("x.wav")));
    assert!(state.known.keys().all(|path| path.is_absolute()));
}

#[test]
fn without_a_thread_nothing_is_known() {
    let library = TagLibrary::default();
    let path = Path::new("/nowhere/x.wav");
    library.request([path]);
    assert_eq!((library.get(path), library.revision()), (None, 0));
}
