//! The track list, the file list and the cover, operated by keys.

use std::path::PathBuf;

use crate::support::apart::apart;
use crate::support::session::{App, Place};
use mariana::input::Input;
use mariana_testing::wave::write_tagged_wav;

const SMALL: &[&str] = &["--size", "320x180"];

fn song(place: &Place, name: &str, title: &str) -> PathBuf {
    let path = place.path(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    let tags = [("TIT2", title), ("TPE1", "an artist")];
    write_tagged_wav(&path, 8_000, 1, std::iter::repeat_n(0.0, 60 * 8_000), &tags);
    path
}

fn wait_for_track(app: &App, name: &str, place: &str) {
    app.wait_for_title(name, |title| title.contains(name) && title.contains(place));
}

/// Opens a session with three songs.
fn open(place: &Place) -> App {
    for (number, name) in (1..).zip(["one", "two", "three"]) {
        song(place, &format!("music/{number}.wav"), name);
    }
    let app = place.open(&place.path("music"), SMALL);
    app.wait_until("a frame", |app| app.shown() > 0);
    app
}

#[test]
fn the_track_list_is_edited_by_keys_and_every_change_is_undone() {
    apart!();
    let place = Place::new();
    let app = open(&place);
    wait_for_track(&app, "one", "1/3");
    app.press(&["u", "alt+Down"]);
    wait_for_track(&app, "one", "2/3");
    app.press(&["Delete"]);
    wait_for_track(&app, "three", "2/2");
    app.press(&["ctrl+z"]);
    app.wait_until_reported("undone: remove an artist - one");
    wait_for_track(&app, "three", "3/3");
    app.press(&["ctrl+z"]);
    app.wait_until_reported("undone: move an artist - one");
    app.press(&["Home", "Return"]);
    wait_for_track(&app, "one", "1/3");
    // A search finds the title of a track that was never opened, once its tags are read.
    app.wait_until("the tags", |app| {
        app.press(&["slash"]);
        app.type_text("thr\n");
        app.title().contains("three")
    });
    // Dropped files replace the list, which comes back without an open panel.
    app.press(&["u"]);
    app.send(Input::Dropped(song(&place, "new.wav", "new")));
    wait_for_track(&app, "new", "Mariana");
    app.press(&["ctrl+z"]);
    app.wait_until_reported("undone: open other tracks");
    wait_for_track(&app, "three", "3/3");
    app.quit_by_key();
    let cached = std::fs::read_to_string(place.path("cache/tags.jsonl")).unwrap();
    assert!(["one", "two", "three"].iter().all(|title| cached.contains(&format!("\"{title}\""))), "{cached}");
}

#[test]
fn the_file_list_adds_and_plays_by_keys_and_remembers_folders() {
    apart!();
    let place = Place::new();
    song(&place, "other/album/1.wav", "first");
    song(&place, "other/album/2.wav", "second");
    let app = open(&place);
    wait_for_track(&app, "one", "1/3");
    // The list begins in the folder of the track.
    app.press(&["o"]);
    app.wait_until_reported("music is listed");
    app.press(&["BackSpace"]);
    app.wait_until_reported(&format!("{} is listed", place.folder().display()));
    // Without the space, O closes the list.
    app.type_text(" other");
    app.press(&["Return"]);
    app.wait_until_reported("other is listed");
    // Shift adds the folder and leaves the list open.
    app.press(&["shift+Return"]);
    wait_for_track(&app, "one", "1/5");
    app.press(&["Return"]);
    app.wait_until_reported("album is listed");
    app.press(&["ctrl+d", "ctrl+Return"]);
    wait_for_track(&app, "first", "1/2");
    app.quit_by_key();
    let saved = place.saved_settings();
    let album = place.path("other/album");
    for wanted in ["recent_folders", "favourite_folders", album.to_str().unwrap()] {
        assert!(saved.contains(wanted), "no {wanted} in {saved}");
    }
}

#[test]
fn the_cover_of_the_song_is_shown_after_the_start() {
    apart!();
    let place = Place::new();
    let path = song(&place, "music/a.wav", "a title");
    let cover = image::RgbaImage::from_pixel(600, 300, image::Rgba([0, 255, 0, 255]));
    cover.save(place.path("music/Cover.png")).unwrap();
    let options =
        ["--prepare-ahead", "off", "--silent", "--new", "--size", "640x360", "--scene", "length(p) - 1"];
    let app = place.begin(&[&[path.to_str().unwrap()], &options[..]].concat());
    let is_green = |pixel: &image::Rgba<u8>| pixel.0[1] > 240 && pixel.0[0] < 16 && pixel.0[2] < 16;
    let shown = app.wait_for("the cover", |picture| picture.pixels().any(is_green));
    let count = shown.pixels().filter(|pixel| is_green(pixel)).count();
    assert!(count > 60 * 60, "{count} pixels of the cover");
    app.quit();
}
