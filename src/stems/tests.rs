//! Tests of reading stems: parts of a song, interruption, and the thread of a show.

use std::cell::RefCell;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::channel;
use std::time::Duration;

use super::*;
use mariana_field::graph::{LevelList, SongPart};
use mariana_player::playlist::Playlist;
use mariana_player::track::Repeat;
use mariana_testing::wave::write_wav;

/// Writes silence of `silent` seconds and then a tone, `seconds` in total.
fn write_tone(path: &Path, rate: u32, silent: f32, seconds: f32) {
    let sample = |frame: usize| {
        let time = frame as f32 / rate as f32;
        if time < silent { 0.0 } else { 0.5 * (std::f32::consts::TAU * 440.0 * time).sin() }
    };
    write_wav(path, rate, 1, (0..(seconds * rate as f32) as usize).map(sample));
}

fn song_with_stems() -> (tempfile::TempDir, Song) {
    let folder = tempfile::tempdir().unwrap();
    let song = folder.path().join("song.wav");
    std::fs::create_dir(song.with_extension("stems")).unwrap();
    write_tone(&song, 48_000, 0.0, 6.0);
    write_tone(&folder.path().join("song.stems/drums.wav"), 32_000, 3.0, 6.0);
    write_tone(&folder.path().join("song.stems/vocals.wav"), 48_000, 9.0, 6.0);
    (folder, Song::File(song))
}

/// A cache that keeps nothing.
fn none() -> CachedFiles {
    parts_cache(&Folders::default())
}

fn volume(parts: &Parts, part: SongPart, time: f64) -> f32 {
    let input = PartInput {
        part,
        number: mariana_field::graph::PartNumber::Sound(PartInput::sounds().next().unwrap()),
    };
    parts.tracks.at(time)[input.index()]
}

#[test]
fn parts_are_numbered_as_in_scenes_and_follow_the_songs_time() {
    let (_folder, song) = song_with_stems();
    let mut of_song = SongOfParts { song: &song, cut: None, duration: Some(6.0), scene_gain: 1.0 };
    let parts = of_song.read(&none(), &|| true, &|_| {}).unwrap();
    assert!(parts.problems.is_empty(), "{:?}", parts.problems);
    assert_eq!(parts.tracks.at(1.0).len(), PartInput::COUNT);
    assert_eq!(kept_numbers().len() + LevelList::Band.count(), PartInput::OF_ONE);
    let heard = |parts: &Parts, time: f64| SongPart::ALL.map(|part| volume(parts, part, time) > 0.3);
    assert_eq!(heard(&parts, 2.0), [false; 4]);
    assert_eq!(heard(&parts, 4.0), [true, false, false, false]);
    assert_eq!(volume(&parts, SongPart::Vocals, 4.0), 0.0);
    assert_eq!(parts.tracks.at(60.0), [0.0; PartInput::COUNT]);
    // A track of a cue sheet begins later in the same file, and ends earlier.
    of_song.cut = Some(Cut { start: 225, end: Some(300) });
    let parts = of_song.read(&none(), &|| true, &|_| {}).unwrap();
    assert!(parts.problems.is_empty(), "{:?}", parts.problems);
    assert_eq!([0.5, 1.5].map(|time| heard(&parts, time)[0]), [true, false]);
    // The gain of the song also applies to its stems.
    of_song.scene_gain = 0.1;
    assert!(
        (volume(&of_song.read(&none(), &|| true, &|_| {}).unwrap(), SongPart::Drums, 0.5) - 0.0318).abs()
            < 2e-3
    );
}

#[test]
fn reading_stops_on_request_and_a_song_without_stems_has_no_parts() {
    let (folder, song) = song_with_stems();
    let of_song = SongOfParts { song: &song, cut: None, duration: None, scene_gain: 1.0 };
    let asked = AtomicUsize::new(0);
    assert!(of_song.read(&none(), &|| asked.fetch_add(1, Ordering::Relaxed) < 5, &|_| {}).is_none());
    assert!(asked.load(Ordering::Relaxed) < 10, "reading goes on after it was stopped");
    std::fs::remove_dir_all(folder.path().join("song.stems")).unwrap();
    let parts = of_song.read(&none(), &|| true, &|_| {}).unwrap();
    assert!(parts.problems.is_empty() && parts.tracks.at(1.0).is_empty());
}

#[test]
fn the_beginning_is_known_before_the_end() {
    let folder = tempfile::tempdir().unwrap();
    let song = folder.path().join("song.wav");
    std::fs::create_dir(song.with_extension("stems")).unwrap();
    write_tone(&song.with_extension("stems").join("drums.wav"), 8_000, 5.0, 45.0);
    write_tone(&song.with_extension("stems").join("bass.wav"), 8_000, 0.0, 15.0);
    let song = Song::File(song);
    let of_song = SongOfParts { song: &song, cut: None, duration: Some(45.0), scene_gain: 1.0 };
    let published = RefCell::new(Vec::new());
    let parts = of_song.read(&none(), &|| true, &|parts| published.borrow_mut().push(parts)).unwrap();
    let lengths: Vec<f64> =
        published.borrow().iter().map(|parts| parts.tracks.tracks[0].as_ref().unwrap().seconds()).collect();
    assert!(lengths.iter().zip([10.0, 20.0, 40.0]).all(|(a, b)| (a - b).abs() < 0.5), "{lengths:?}");
    assert!(published.borrow().iter().all(|parts| !parts.are_complete) && parts.are_complete);
    for begun in published.borrow().iter() {
        assert_eq!(begun.tracks.at(7.3), parts.tracks.at(7.3), "a later reading changes the beginning");
    }
    assert!(parts.problems.len() == 1 && parts.problems[0].contains("lasts"), "{:?}", parts.problems);
}

#[test]
fn parts_without_problems_are_cached_by_the_bytes_of_their_stems() {
    let (folder, song) = song_with_stems();
    let stem = |name: &str| folder.path().join("song.stems").join(name);
    let cache = parts_cache(&Folders { cache: Some(folder.path().join("cache")), ..Folders::default() });
    let read = |scene_gain: f32| {
        let of_song = SongOfParts { song: &song, cut: None, duration: Some(6.0), scene_gain };
        let published = RefCell::new(0);
        let parts = of_song.read(&cache, &|| true, &|_| *published.borrow_mut() += 1).unwrap();
        (parts.tracks, parts.problems.len())
    };
    let kept = || std::fs::read_dir(folder.path().join("cache/parts")).map_or(0, Iterator::count);
    let first = read(1.0);
    assert_eq!((kept(), read(1.0)), (1, first.clone()));
    // Damage the cached file: the stems are read again.
    let file = std::fs::read_dir(folder.path().join("cache/parts")).unwrap().next().unwrap().unwrap().path();
    let whole = std::fs::read(&file).unwrap();
    std::fs::write(&file, &whole[..whole.len() / 2]).unwrap();
    assert_eq!(read(1.0), first);
    assert_eq!(std::fs::read(&file).unwrap(), whole);
    assert_ne!(read(0.5).0, first.0);
    assert_eq!(kept(), 2);
    write_tone(&stem("drums.wav"), 32_000, 2.0, 6.0);
    assert_ne!(read(1.0).0, first.0);
    assert_eq!(kept(), 3);
    std::fs::write(stem("drums.wav"), "").unwrap();
    assert_eq!([read(1.0).1, read(1.0).1, kept()], [1, 1, 3], "problems are reported each time");
}

#[test]
fn the_thread_of_a_show_finds_the_same_parts() {
    let (_folder, song) = song_with_stems();
    let Song::File(path) = &song else { panic!("a file") };
    let track = Playlist::open(std::slice::from_ref(path), Repeat::All, false).unwrap().first.info;
    let (wake, woken) = channel();
    let reader = start_reader(none(), move || wake.send(()).unwrap_or_default());
    reader.request([&track]);
    woken.recv_timeout(Duration::from_secs(60)).unwrap();
    let of_song = SongOfParts { song: &song, cut: None, duration: track.duration, scene_gain: 1.0 };
    let tracks = of_song.read(&none(), &|| true, &|_| {}).unwrap().tracks;
    assert_eq!(reader.get(track.id).unwrap().tracks, tracks);
}
