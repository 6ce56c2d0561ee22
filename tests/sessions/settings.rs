//! The settings panel: the session saves changes, and the next session uses them.

use crate::support::apart::apart;
#[cfg(target_os = "linux")]
use crate::support::apart::{apart_at_home, home};
use std::time::Duration;

use crate::support::session::{App, Place};
#[cfg(target_os = "linux")]
use mariana_player::device_list::DeviceWatch;
#[cfg(target_os = "linux")]
use mariana_testing::sound_server::SoundServer;

const SCENE: &str = "length(p - vec3(0, 1, 0)) - 1";

fn wait_for_setting(app: &App, place: &Place, line: &str) {
    app.wait_until(line, |_| place.saved_settings().lines().any(|found| found == line));
}

/// Waits until no line of the settings begins with `key`, because the setting has its default.
fn wait_for_default(app: &App, place: &Place, key: &str) {
    app.wait_until(key, |_| !place.saved_settings().lines().any(|line| line.starts_with(key)));
}

#[cfg(target_os = "linux")]
fn hear(place: &Place, options: &[&str]) -> App {
    let app = place.begin(&[&["--prepare-ahead", "off", "--scene", SCENE], options].concat());
    app.wait_until_reported("first picture after");
    app
}

/// The session notices a change of the output later than the server does, so the test waits for both.
#[cfg(target_os = "linux")]
fn wait_for_output(app: &App, server: &SoundServer, name: &str) {
    app.wait_until(name, |app| {
        app.meanwhile(|| {
            let sinks = server.ask(&["list", "short", "sinks"]);
            let number =
                sinks.lines().find(|line| line.contains(name)).and_then(|line| line.split('\t').next());
            let playing = server.ask(&["list", "short", "sink-inputs"]);
            playing.lines().any(|line| line.split('\t').nth(1) == number)
        })
    });
    app.wait_until("the session to know its output", |app| {
        app.reported()
            .lines()
            .rfind(|line| line.contains("the song plays on "))
            .is_some_and(|line| line.contains(name))
    });
}

#[cfg(target_os = "linux")]
fn wait_for_outputs(app: &App) {
    let watch = DeviceWatch::shared().unwrap();
    app.wait_until("both outputs", |_| watch.latest().1.outputs.len() == 2);
    app.take_steps(10);
}

/// A panel has a dark background.
#[cfg(target_os = "linux")]
fn wait_for_ground(app: &App, what: &str, x: u32, y: u32) {
    app.wait_for(what, |picture| {
        picture.get_pixel(x, y).0.iter().take(3).map(|value| u32::from(*value)).sum::<u32>() < 120
    });
}

#[cfg(target_os = "linux")]
#[test]
fn settings_are_changed_by_keys_and_pointer_and_saved() {
    apart_at_home!();
    let server = SoundServer::start(&home());
    server.plug("usb", &[]);
    server.set_default("viz");
    let place = Place::new();
    // Use keys only. The rows are the outputs (default, viz and usb), the delay, the gain, the quality and the limiter.
    let app = hear(&place, &["--size", "640x360"]);
    wait_for_output(&app, &server, "viz");
    app.press(&["g"]);
    wait_for_outputs(&app);
    app.press(&["Down", "Down", "Return"]);
    wait_for_output(&app, &server, "usb");
    app.wait_until("the output", |_| {
        place.saved_settings().contains("output = \"") && place.saved_settings().contains("usb")
    });
    app.press(&["Down", "Right", "Right", "Down", "Down", "Right", "Down", "Return"]);
    wait_for_setting(&app, &place, "quality = \"low\"");
    wait_for_setting(&app, &place, "flash_limiter = \"off\"");
    assert!(place.saved_settings().contains("usb\" = 10.0"), "{}", place.saved_settings());
    // A closed panel ignores keys.
    app.press(&["Escape", "Down", "Return", "Right"]);
    app.quit();
    assert!(place.saved_settings().contains("volume = 0.9"), "{}", place.saved_settings());

    // A flag applies only to its session.
    let app = hear(&place, &["--size", "760x540", "--quality", "best", "--device", "default"]);
    wait_for_output(&app, &server, "viz");
    let reported = app.quit();
    assert!(reported.contains("quality: Best, flash_limiter: false"), "{reported}");
    assert!(place.saved_settings().lines().any(|line| line == "quality = \"low\""));

    // Without flags, the saved choices apply again. Reset them by the pointer only.
    let app = hear(&place, &["--size", "760x540"]);
    wait_for_output(&app, &server, "usb");
    assert!(app.reported().contains("quality: Low, flash_limiter: false"), "{}", app.reported());
    app.point_at(200, 100);
    app.point_at(230, 100);
    wait_for_ground(&app, "the bar", 24, 518);
    // The settings button is the third from the right in the bar. The bar is 14 pixels from the window's edges.
    app.click_at(760 - 14 - 14 - 15 - 2 * 32, 540 - 14 - 11 - 15);
    wait_for_ground(&app, "the panel", 66, 30);
    wait_for_outputs(&app);
    // Rows are 26 pixels high, below a heading. The headings of groups are 22 pixels high: the second one is above the
    // quality. The names of values begin 170 pixels right of the rows' left edge.
    let row = |place: u32| 14 + 11 + 26 + 22 + if place > 4 { 22 } else { 0 } + 26 * place + 13;
    let (left, names) = (60 + 14, 60 + 14 + 170);
    app.click_at(left + 60, row(0));
    wait_for_output(&app, &server, "viz");
    wait_for_default(&app, &place, "output");
    app.click_at(names + 18, row(5));
    wait_for_default(&app, &place, "quality");
    app.click_at(names + 14, row(6));
    wait_for_default(&app, &place, "flash_limiter");
    // The cross closes the panel. Then a click at the panel's former position does not change a setting.
    app.click_at(760 - 60 - 14 - 13, 14 + 11 + 10);
    app.wait_for("the frame without the panel", |picture| {
        picture.get_pixel(66, 30).0.iter().take(3).map(|value| u32::from(*value)).sum::<u32>() >= 120
    });
    app.click_at(left + 60, row(2));
    app.quit();
    assert!(!place.saved_settings().contains("output ="), "a closed panel took a click");
}

fn open(place: &Place, options: &[&str]) -> App {
    let app = place.begin(&[&["--silent", "--prepare-ahead", "off", "--scene", SCENE], options].concat());
    app.wait_until_reported("first picture after");
    app
}

#[test]
fn a_power_cut_keeps_the_track_position_scene_volume_and_list() {
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
    app.wait_for_title("the saved track and volume", |title| title.contains("2/2") && title.contains(volume));
    app.quit();
}

#[test]
fn tracks_and_hints_can_be_switched_off() {
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
    // Switching the setting off deletes the list at once. In a silent session, the panel lists only the default output.
    let app = open(&place, &options);
    app.wait_for_title("the last track", |title| title.contains("2/2"));
    app.press(&["g"]);
    app.press(&["Down", "Down", "Down", "Down", "Down", "Down", "Down", "Down", "Return"]);
    wait_for_setting(&app, &place, "last_tracks = \"off\"");
    assert!(!listed.exists(), "the list still exists");
    app.press(&["Down", "Return"]);
    wait_for_setting(&app, &place, "hints = \"off\"");
    app.quit();
    assert!(!listed.exists() && place.saved_settings().contains("track = 0"), "{}", place.saved_settings());
    let app = open(&place, &options);
    app.wait_for_title("the demo track", |title| title.contains("Hadal Lanterns"));
    // Without hints, moving the pointer does not open the bar.
    for x in [200, 230] {
        app.point_at(x, 100);
        app.run_for(Duration::from_millis(200));
    }
    let picture = app.picture();
    let pixel = picture.get_pixel(24, 338).0;
    assert!(pixel.iter().take(3).map(|value| u32::from(*value)).sum::<u32>() > 120, "the bar is shown");
    app.quit();
}

#[test]
fn unknown_or_unreadable_settings_are_reported() {
    apart!();
    let place = Place::new();
    let file = place.settings();
    std::fs::create_dir_all(file.parent().unwrap()).unwrap();
    std::fs::write(&file, "mood = \"blue\"\n[choices]\nquality = \"low\"\ntone_map = \"filmic\"\n").unwrap();
    let options = ["--size", "320x180"];
    let reported = open(&place, &options).quit();
    assert_eq!(
        reported.matches("this version does not know (choices.tone_map, mood)").count(),
        1,
        "{reported}"
    );
    assert!(reported.contains("quality: Low"), "{reported}");
    let kept = place.saved_settings();
    assert!(kept.contains("mood = \"blue\"") && kept.contains("tone_map = \"filmic\""), "{kept}");
    assert!(kept.contains("[last_show]"), "{kept}");
    // If a folder has the file's name, the session can neither read nor write the settings.
    std::fs::remove_file(&file).unwrap();
    std::fs::create_dir(&file).unwrap();
    let app = open(&place, &options);
    app.press(&["g", "Down", "Right", "Right", "Left"]);
    let reported = app.quit();
    assert_eq!(reported.matches("settings.toml cannot be").count(), 1, "{reported}");
}
