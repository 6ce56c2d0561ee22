//! What the panel of settings changes and what is remembered, and what is there in the next session.

use crate::support::apart::apart;
use std::time::Duration;

use crate::support::session::{App, Place};

/// A scene that costs little.
const SCENE: &str = "length(p - vec3(0, 1, 0)) - 1";

fn wait_for_setting(app: &App, place: &Place, line: &str) {
    app.wait_until(line, |_| place.saved_settings().lines().any(|found| found == line));
}

/// A session with these options, which goes on where the last one ended.
fn open(place: &Place, options: &[&str]) -> App {
    let app = place.begin(&[&["--silent", "--prepare-ahead", "off", "--scene", SCENE], options].concat());
    app.wait_until_told("first picture after");
    app
}

#[test]
fn an_end_without_warning_forgot_the_track_its_place_the_scene_the_volume_and_the_list() {
    apart!();
    let place = Place::new();
    let options = ["--size", "320x180"];
    let songs = ["one.wav", "two.wav"].map(|name| place.quiet_song(name, 120));
    let songs = songs.each_ref().map(|song| song.to_str().unwrap());
    let app = open(&place, &[&options[..], &songs].concat());
    app.press(&["Next"]);
    app.wait_for_title("the second track", |title| title.contains("2/2"));
    app.press(&["Down"]);
    app.wait_for_title("another volume", |title| title.contains("volume"));
    let title = app.title();
    // Six times 5 s.
    app.press(&["Right"; 6]);
    wait_for_setting(&app, &place, "track = 1");
    app.wait_until("the volume", |_| place.saved_settings().contains("\nvolume = 0.9"));
    app.wait_until("the place", |_| {
        let text = place.saved_settings();
        let seconds = text.lines().find_map(|line| line.strip_prefix("seconds = "));
        seconds.and_then(|seconds| seconds.parse().ok()).is_some_and(|seconds: f64| seconds >= 30.0)
    });
    app.press(&["n"]);
    app.wait_until("the scene", |_| place.saved_settings().contains("\nscene = "));
    place.cut_off(app);
    let app = open(&place, &options);
    let volume = title.split(", ").find(|note| note.contains("volume")).unwrap().trim_end_matches(')');
    app.wait_for_title("all of it", |title| title.contains("2/2") && title.contains(volume));
    app.quit();
}

#[test]
fn tracks_are_forgotten_and_hints_stay_away_where_that_was_chosen() {
    apart!();
    let place = Place::new();
    let options = ["--size", "640x360"];
    let listed = place.path("config/last tracks.m3u8");
    let songs = ["one.wav", "two.wav"].map(|name| place.quiet_song(name, 30));
    let songs = songs.each_ref().map(|song| song.to_str().unwrap());
    let app = open(&place, &[&options[..], &songs].concat());
    app.press(&["Next"]);
    app.wait_for_title("the second track", |title| title.contains("2/2"));
    app.quit();
    assert!(listed.is_file() && place.saved_settings().contains("track = 1"), "{}", place.saved_settings());
    // Switched off it is gone at once. In a show without a device the default output is the only one.
    let app = open(&place, &options);
    app.wait_for_title("what was left", |title| title.contains("2/2"));
    app.press(&["g"]);
    app.press(&["Down", "Down", "Down", "Down", "Down", "Down", "Down", "Return"]);
    wait_for_setting(&app, &place, "last_tracks = \"off\"");
    assert!(!listed.exists(), "the list is still there");
    app.press(&["Down", "Return"]);
    wait_for_setting(&app, &place, "hints = \"off\"");
    app.quit();
    assert!(!listed.exists() && place.saved_settings().contains("track = 0"), "{}", place.saved_settings());
    let app = open(&place, &options);
    app.wait_for_title("the demo track", |title| title.contains("Hadal Lanterns"));
    // No bar comes with the pointer.
    for x in [200, 230] {
        app.point_at(x, 100);
        app.run_for(Duration::from_millis(200));
    }
    let picture = app.picture();
    let pixel = picture.get_pixel(24, 338).0;
    assert!(pixel.iter().take(3).map(|value| u32::from(*value)).sum::<u32>() > 120, "there is a bar");
    app.quit();
}

#[test]
fn a_settings_file_of_another_kind_costs_a_sentence() {
    apart!();
    let place = Place::new();
    let file = place.settings();
    std::fs::create_dir_all(file.parent().unwrap()).unwrap();
    std::fs::write(&file, "mood = \"blue\"\n[choices]\nquality = \"low\"\ntone_map = \"filmic\"\n").unwrap();
    let options = ["--size", "320x180"];
    let told = open(&place, &options).quit();
    assert_eq!(told.matches("this version does not know (choices.tone_map, mood)").count(), 1, "{told}");
    assert!(told.contains("quality: Low"), "{told}");
    let kept = place.saved_settings();
    assert!(kept.contains("mood = \"blue\"") && kept.contains("tone_map = \"filmic\""), "{kept}");
    assert!(kept.contains("[last_show]"), "{kept}");
    // It can be neither read nor written.
    std::fs::remove_file(&file).unwrap();
    std::fs::create_dir(&file).unwrap();
    let app = open(&place, &options);
    app.press(&["g", "Down", "Right", "Right", "Left"]);
    let told = app.quit();
    assert_eq!(told.matches("settings.toml cannot be").count(), 1, "{told}");
}
