//! Playlists: keys, and messages about tracks.

use crate::support::apart::apart;
use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::support::session::{App, Place};
use mariana_testing::process::WAIT_LIMIT;
use mariana_testing::wave::write_wav;

const SMALL: &[&str] = &["--size", "320x180"];

fn write_song(path: &Path, seconds: f64) {
    let samples = (0..(seconds * 16_000.0) as usize).map(|n| (f64::from(n as u32) * 0.02).sin() as f32 * 0.4);
    write_wav(path, 8_000, 2, samples);
}

fn folder_of(place: &Place, songs: &[&str], seconds: f64) -> PathBuf {
    let folder = place.path("music");
    std::fs::create_dir(&folder).unwrap();
    songs.iter().for_each(|song| write_song(&folder.join(song), seconds));
    folder
}

fn wait_for_track(app: &App, name: &str, place: &str) {
    app.wait_for_title(name, |title| title.starts_with(name) && title.contains(place));
}

#[test]
fn a_folder_plays_in_order_and_keys_change_the_track() {
    apart!();
    let place = Place::new();
    let folder = folder_of(&place, &["1.wav", "10.wav", "2.wav"], 60.0);
    std::fs::write(folder.join("9.mp3"), b"this is no music at all").unwrap();
    let app = place.open(&folder, SMALL);
    wait_for_track(&app, "1.wav - Mariana", "1/4");
    app.press(&["Next"]);
    wait_for_track(&app, "2.wav - Mariana", "2/4");
    app.press(&["Next"]);
    wait_for_track(&app, "10.wav - Mariana", "4/4");
    app.wait_until_reported("9.mp3 is not an audio file");
    app.press(&["Next"]);
    wait_for_track(&app, "1.wav - Mariana", "1/4");
    app.press(&["Prior", "Prior"]);
    wait_for_track(&app, "2.wav - Mariana", "2/4");
    // L steps from repeating the list to repeating one track, and then to no repetition, in which the list has an end.
    app.press(&["l", "l", "Next"]);
    wait_for_track(&app, "10.wav - Mariana", "4/4");
    app.press(&["Next"]);
    app.wait_until_reported("the list ends here");
    assert!(app.runs() && app.title().starts_with("10.wav"));
    app.quit_by_key();
}

#[test]
fn a_show_continues_when_its_files_are_deleted() {
    apart!();
    let place = Place::new();
    let folder = folder_of(&place, &["1.wav", "2.wav"], 1.0);
    let app = place.open(&folder, SMALL);
    wait_for_track(&app, "1.wav", "1/2");
    wait_for_track(&app, "2.wav", "2/2");
    std::fs::remove_dir_all(&folder).unwrap();
    // The open track keeps playing, but the session can open no other track.
    app.wait_until_reported("does not exist");
    app.press(&["Next"]);
    app.wait_until_reported("none of the 2 tracks can be played");
    assert!(app.runs());
    app.quit_by_key();
}

#[test]
fn a_playlist_without_playable_tracks_is_reported() {
    apart!();
    let place = Place::new();
    let list = place.path("list.m3u8");
    std::fs::write(&list, "gone.mp3\nhttp://radio.example/live\n../nowhere/b.ogg\nlist.m3u8\n").unwrap();
    let app = place.open(&list, SMALL);
    wait_for_track(&app, "nothing to play", "Mariana");
    for sentence in
        ["gone.mp3 does not exist", "http://radio.example/live", "contains itself", "none of the 2 tracks"]
    {
        app.wait_until_reported(sentence);
    }
    // Without music, the scene keeps moving.
    let before = app.picture();
    app.wait_for("another picture", |picture| *picture != before);
    // A key finds a track again once its file exists.
    write_song(&place.path("gone.mp3"), 5.0);
    app.press(&["Next"]);
    wait_for_track(&app, "gone.mp3", "1/2");
    app.quit_by_key();
}

#[test]
fn a_list_that_plays_once_ends_the_program() {
    apart!();
    let place = Place::new();
    let folder = folder_of(&place, &["1.wav", "2.wav"], 0.6);
    std::fs::write(folder.join("3.flac"), b"fLaC").unwrap();
    let app = place.open(&folder, &[SMALL, &["--once"]].concat());
    let begun = Instant::now();
    while app.step() {
        assert!(begun.elapsed() < WAIT_LIMIT, "the session does not end: {}", app.reported());
    }
    let reported = app.quit();
    assert!(reported.contains("3.flac"), "{reported}");
}
