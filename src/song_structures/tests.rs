//! Tests of the cache, of damaged songs, and of the reader's order.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use super::*;
use mariana_player::playlist::{Cut, Playlist};
use mariana_player::source::SourceError;
use mariana_player::track::{Repeat, TrackInfo};
use mariana_testing::wave::write_wav;

/// Writes `seconds` of clicks; songs differ in their number of clicks `per_second`.
fn write_song(path: &Path, seconds: usize, per_second: usize) {
    let frames = (0..seconds * 48_000).map(|frame| {
        let since = frame % (48_000 / per_second);
        let sample = if since < 400 { 0.6 * (0.4 * since as f32).sin() } else { 0.0 };
        [sample; 2]
    });
    write_wav(path, 48_000, 2, frames.flatten());
}

fn whole(path: &Path) -> Content {
    Content { song: Song::File(path.to_owned()), cut: None }
}

fn cache_in(folder: PathBuf) -> CachedFiles {
    CachedFiles { folder: Some(folder), ..structure_cache(&Folders::default()) }
}

fn kept_files(folder: &Path) -> Vec<std::path::PathBuf> {
    let listing = fs::read_dir(folder).into_iter().flatten();
    listing.map(|entry| entry.unwrap().path()).collect()
}

#[test]
fn a_structure_that_was_kept_is_the_same_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let (path, kept) = (folder.path().join("a.wav"), folder.path().join("songs"));
    write_song(&path, 12, 2);
    let cache = cache_in(kept.clone());
    let song = Song::File(path);
    let first = structure_of(&song, &cache);
    assert!(first.seconds > 11.0 && !first.energy.is_empty() && !first.beats.is_empty(), "{first:?}");
    let files = kept_files(&kept);
    assert_eq!(files.len(), 1);
    // The analysis cannot find this value, so it must come from the file.
    let reported = fs::read_to_string(&files[0]).unwrap();
    let changed = SongStructure { tuning_hz: 432.1, ..first.clone() };
    let key = key_of(&Content { song: song.clone(), cut: None }, &cache, &|| true).unwrap();
    cache.save(key, &serde_json::to_vec(&changed).unwrap());
    assert_eq!(structure_of(&song, &cache), changed);
    fs::write(&files[0], reported).unwrap();
    assert_eq!(structure_of(&song, &cache), first);
}

#[test]
fn a_damaged_file_is_made_anew() {
    let folder = tempfile::tempdir().unwrap();
    let (path, kept) = (folder.path().join("a.wav"), folder.path().join("songs"));
    write_song(&path, 8, 2);
    let (cache, song) = (cache_in(kept.clone()), Song::File(path));
    let first = structure_of(&song, &cache);
    let file = kept_files(&kept).remove(0);
    let whole = fs::read(&file).unwrap();
    let mut flipped = whole.clone();
    *flipped.last_mut().unwrap() ^= 1;
    // Valid JSON with another value.
    let other = String::from_utf8(whole.clone()).unwrap().replacen("\"seconds\":8", "\"seconds\":9", 1);
    assert_ne!(other.as_bytes(), whole);
    let cuts = [0, 10, 17, whole.len() - 1].map(|end| &whole[..end]);
    for damaged in cuts.into_iter().chain([&flipped, other.as_bytes(), b"null"]) {
        fs::write(&file, damaged).unwrap();
        assert_eq!(structure_of(&song, &cache), first);
        assert_eq!(fs::read(&file).unwrap(), whole, "the file was not repaired");
    }
}

#[test]
fn songs_are_known_by_their_bytes_and_their_part() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    write_song(&path("a.wav"), 2, 2);
    fs::copy(path("a.wav"), path("same.wav")).unwrap();
    write_song(&path("other.wav"), 2, 3);
    let cache = cache_in(path("kept"));
    let key = |content: &Content| key_of(content, &cache, &|| true).unwrap();
    let first = key(&whole(&path("a.wav")));
    assert_eq!(first, key(&whole(&path("same.wav"))));
    assert_ne!(first, key(&whole(&path("other.wav"))));
    let part = Content { cut: Some(Cut { start: 0, end: Some(75) }), ..whole(&path("a.wav")) };
    assert_ne!(first, key(&part));
    assert_eq!(key_of(&whole(&path("missing.wav")), &cache, &|| true), None);
    assert_eq!(key_of(&whole(&path("a.wav")), &cache, &|| false), None, "a stopped hash has no key");
}

#[test]
fn broken_and_silent_songs_are_neutral() {
    let folder = tempfile::tempdir().unwrap();
    let cache = cache_in(folder.path().join("kept"));
    let path = folder.path().join("noise.wav");
    fs::write(&path, b"this is no song").unwrap();
    assert_eq!(structure_of(&Song::File(path.clone()), &cache), SongStructure::default());
    assert_eq!(
        structure_of(&Song::File(folder.path().join("missing.wav")), &cache),
        SongStructure::default()
    );
    write_wav(&path, 48_000, 2, std::iter::repeat_n(0.0, 2 * 96_000));
    let moment = structure_of(&Song::File(path.clone()), &cache).moment(1.0);
    assert_eq!((moment.section, moment.energy, moment.beat_in_bar, moment.progress), (0.0, 0.0, 0.0, 0.5));
    write_song(&path, 20, 2);
    let bytes = fs::read(&path).unwrap();
    fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    let structure = structure_of(&Song::File(path), &cache);
    assert!((9.0..11.0).contains(&structure.seconds), "{} s", structure.seconds);
}

/// Bars of the demo track have 102,400 samples, and its score has drops at bars 12 and 24.
#[test]
fn the_demo_track_has_the_drops_of_its_score() {
    const DEMO: Song = Song::Embedded { name: "demo.ogg", bytes: mariana_assets::DEMO_TRACK };
    let structure = structure_of(&DEMO, &cache_in(PathBuf::from("/missing/x")));
    assert_eq!(structure.drops.len(), 2, "{:?}", structure.drops);
    for (drop, bar) in structure.drops.iter().zip([12.0, 24.0]) {
        let truly = bar * 102_400.0 / 48_000.0;
        assert!((drop - truly).abs() < 0.1, "{drop} is not {truly}");
    }
}

#[test]
fn only_the_oldest_beyond_the_limit_are_forgotten() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.song", "b.song", "c.song", "other.txt"] {
        fs::write(folder.path().join(name), name).unwrap();
    }
    let folder_path = Some(folder.path().to_owned());
    CachedFiles { folder: folder_path, ending: "song", bytes_max: 99, kept_max: 1 }.forget_oldest();
    let left = kept_files(folder.path());
    assert_eq!(left.len(), 2, "{left:?}");
    assert!(left.iter().any(|path| path.ends_with("other.txt")));
}

fn track_of(path: &Path) -> Arc<TrackInfo> {
    Playlist::open(&[path.to_owned()], Repeat::All, false).unwrap().first.info
}

fn numbered(track: &Arc<TrackInfo>, id: u64) -> Arc<TrackInfo> {
    Arc::new(TrackInfo { id, ..(**track).clone() })
}

#[test]
fn the_reader_analyses_the_current_and_the_next_track() {
    const PATIENCE: Duration = Duration::from_secs(60);
    let folder = tempfile::tempdir().unwrap();
    let (first, second) = (folder.path().join("a.wav"), folder.path().join("b.wav"));
    write_song(&first, 12, 2);
    write_song(&second, 9, 3);
    fs::write(folder.path().join("a.lrc"), "[00:02.00]La la").unwrap();
    let cache = cache_in(folder.path().join("kept"));
    let (wake, woken) = channel();
    let reader = SongReader::start(cache.clone(), move || wake.send(()).unwrap_or_default());
    let tracks = [numbered(&track_of(&first), 3), numbered(&track_of(&second), 7)];
    assert_eq!(reader.get(3), None);
    reader.request(&tracks);
    (0..2).for_each(|_| woken.recv_timeout(PATIENCE).unwrap());
    for (track, path) in tracks.iter().zip([&first, &second]) {
        let known = reader.get(track.id).expect("the track was analysed");
        let at_once = structure_of(&Song::File(path.clone()), &cache_in(PathBuf::from("/missing/x")));
        assert_eq!(*known.structure, at_once, "the window and a still use different structures");
    }
    let lines = tracks.each_ref().map(|track| reader.get(track.id).map(|song| song.moment(3.0).line));
    assert_eq!(lines, [Some(1.0), Some(0.0)], "only the first song has lyrics");
    // A track that cannot be decoded is tried once, and the thread continues.
    fs::remove_file(&second).unwrap();
    reader.request(&[numbered(&track_of(&first), 8), numbered(&tracks[1], 9)]);
    (0..2).for_each(|_| woken.recv_timeout(PATIENCE).unwrap());
    assert!(reader.get(8).is_some() && reader.get(9).is_none());
    // Silence that replaces a removed track has that track's id, but not its structure.
    let silence = mariana_player::track::Track::silence(0, 1).with_id(3).info;
    reader.request(&[silence]);
    assert_eq!(reader.get(3), None);
    drop(reader);
    assert_eq!(woken.recv_timeout(PATIENCE), Err(RecvTimeoutError::Disconnected), "the thread ends");
}

#[test]
fn a_panic_at_one_song_ended_the_analysis_of_all_later_songs() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.wav");
    write_song(&path, 1, 2);
    let (wake, woken) = channel();
    let find = |track: &TrackInfo, _: &(dyn Fn() -> bool + Sync), _: &dyn Fn(u64)| {
        assert!(track.id != 1, "on purpose");
        Some(Some(track.id))
    };
    let reader = SongReader::of("test", "test", 2, find, move || wake.send(()).unwrap_or_default());
    reader.request(&[1, 2].map(|id| numbered(&track_of(&path), id)));
    (0..2).for_each(|_| woken.recv_timeout(Duration::from_secs(60)).unwrap());
    assert_eq!((reader.get(1), reader.get(2).as_deref()), (None, Some(&2)));
}

/// Endless frames. Each request for a block is reported.
struct Endless(std::sync::mpsc::Sender<()>);

impl FrameSource for Endless {
    fn sample_rate(&self) -> u32 {
        48_000
    }

    fn duration(&self) -> Option<f64> {
        None
    }

    fn next_block(&mut self, out: &mut Vec<[f32; 2]>) -> Result<usize, SourceError> {
        let _ = self.0.send(());
        out.push([0.1; 2]);
        Ok(1)
    }

    fn seek(&mut self, _: f64) -> Result<f64, SourceError> {
        Ok(0.0)
    }
}

#[test]
fn a_track_that_is_wanted_no_more_is_left() {
    const PATIENCE: Duration = Duration::from_secs(60);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.wav");
    write_song(&path, 4, 2);
    let (wake, woken) = channel();
    let (asked, asks) = channel();
    let find = move |track: &TrackInfo, go_on: &(dyn Fn() -> bool + Sync), _: &dyn Fn(u64)| match track.id {
        1 => listen(&mut Endless(asked.clone()), go_on).map(|_| None),
        other => Some(Some(other)),
    };
    let reader = SongReader::of("test", "test", 2, find, move || wake.send(()).unwrap_or_default());
    let [endless, song] = [1, 2].map(|id| numbered(&track_of(&path), id));
    reader.request([&endless, &song]);
    asks.recv_timeout(PATIENCE).unwrap();
    // The current track comes first.
    reader.request([&song, &endless]);
    woken.recv_timeout(PATIENCE).unwrap();
    assert!(reader.get(2).is_some() && reader.get(1).is_none());
    drop(reader);
    let end = std::iter::repeat_with(|| asks.recv_timeout(PATIENCE)).find(Result::is_err);
    assert_eq!(end, Some(Err(RecvTimeoutError::Disconnected)), "the thread ends");
}
