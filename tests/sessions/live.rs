//! Live input from a private sound server.

#![cfg(target_os = "linux")]

use std::fs;
use std::time::Duration;

use crate::support::apart::{apart_at_home, home};
use crate::support::compare::{TIGHT, difference};
use crate::support::desktop::load_of;
use crate::support::session::{App, Place, reported_problems};
use image::RgbaImage;
use mariana_testing::sound_server::SoundServer;
use mariana_testing::wave::write_wav;

const SMALL: &str = "320x180";
/// This scene moves only with sound.
const LEVEL: &str = "min(y, max(length(p - vec3(0, 1, 0)) - 0.2 - 2 * volume.x, -1 * y))";
/// A session counts as idle after this number of steps (of up to 20 ms) without a new frame.
const REST: usize = 60;

fn wait_for_another(app: &App, before: &RgbaImage) {
    app.wait_for("another picture", |picture| difference(before, picture, TIGHT.visible).fraction > 0.0);
}

fn wait_for_rest(app: &App) {
    let (mut shown, mut steps) = (app.shown(), 0);
    app.wait_until("rest", |app| {
        steps = if app.shown() == shown { steps + 1 } else { 0 };
        shown = app.shown();
        steps > REST
    });
}

#[test]
fn system_sound_is_shown_and_silence_needs_little_processor_time() {
    apart_at_home!();
    let server = SoundServer::start(&home());
    let place = Place::new();
    let app = place.hear(None, &["--system", "--size", SMALL, "--scene", LEVEL]);
    app.wait_until_reported("first picture after");
    app.wait_for_title("the monitor", |title| title.starts_with("Monitor of ") && title.contains("live"));
    // The session detects silence after some seconds. Then it stops drawing.
    wait_for_rest(&app);
    let load = load_of(std::process::id(), || app.run_for(Duration::from_secs(2)));
    assert!(load < 0.25, "silent input takes {load} of a processor");
    let silent = app.picture();
    let tone = server.play_tone("viz", 440.0);
    app.wait_for("the sound in the frame", |picture| {
        difference(&silent, picture, TIGHT.visible).fraction > 0.02
    });
    drop(tone);
    // A paused frame must not react to sound.
    app.press(&["space"]);
    app.wait_for_title("paused", |title| title.contains("paused"));
    let _tone = server.play_tone("viz", 440.0);
    wait_for_rest(&app);
    app.quit_by_key();
}

#[test]
fn an_input_gets_an_automatic_show_on_request() {
    apart_at_home!();
    let server = SoundServer::start(&home());
    let place = Place::new();
    let app = place.hear(None, &["--system", "--size", "64x36", "--scene", LEVEL]);
    app.wait_for_title("the formula", |title| title.contains("(formula"));
    let _tone = server.play_tone("viz", 440.0);
    app.press(&["a"]);
    app.wait_until_reported("the scenes follow the song");
    app.wait_for_title("a scene chosen by the director", |title| {
        title.contains("live") && !title.contains("formula") && !title.contains("preparing")
    });
    app.press(&["a"]);
    app.quit_by_key();
}

#[test]
fn a_key_changes_the_source_which_is_remembered_by_name() {
    apart_at_home!();
    let server = SoundServer::start(&home());
    server.plug("other", &["sink_properties=device.description=Other"]);
    server.set_default("viz");
    let place = Place::new();
    let song = place.path("song.wav");
    write_wav(&song, 8_000, 2, (0..8_000 * 120).map(|n| (f64::from(n) * 0.02).sin() as f32 * 0.3));
    let app = place.hear(Some(&song), &["--size", SMALL]);
    app.wait_for_title("the song", |title| title.starts_with("song.wav"));
    // The key steps from the computer's sound to the default input, and then through all inputs.
    app.press(&["d"]);
    app.wait_for_title("live", |title| title.contains("live"));
    app.press(&["d", "d", "d"]);
    app.wait_for_title("the other monitor", |title| title.starts_with("Monitor of Other"));
    let wait_for_setting = |what: &str| {
        app.wait_until(what, |_| place.saved_settings().contains(what));
    };
    wait_for_setting("system = \"pulseaudio:other.monitor\"");
    // Increase the delay by two steps of 5 ms, then decrease it by one. The setting belongs to this device only.
    app.press(&["bracketright", "bracketright", "bracketleft"]);
    wait_for_setting("\"pulseaudio:other.monitor\" = 5.0");
    app.press(&["d"]);
    app.wait_for_title("the song", |title| title.starts_with("song.wav") && !title.contains("live"));
    app.press(&["bracketleft"]);
    wait_for_setting("\"pulseaudio:viz\" = -5.0");
    assert_eq!(reported_problems(&app.quit_by_key()), [""; 0]);

    let app = place.hear(None, &["--system", "--size", SMALL]);
    app.wait_for_title("the other monitor", |title| title.starts_with("Monitor of Other"));
    assert_eq!(reported_problems(&app.quit_by_key()), [""; 0]);
}

#[test]
fn connected_and_lost_devices_are_reported_and_frames_continue() {
    apart_at_home!();
    let place = Place::new();
    // No sound server runs, and the settings file is damaged.
    fs::create_dir_all(place.settings().parent().unwrap()).unwrap();
    fs::write(place.settings(), "microphone = [").unwrap();
    let app = place.hear(None, &["--system", "--size", SMALL]);
    app.wait_for_title("no sound", |title| title.contains("no sound"));
    wait_for_another(&app, &app.picture());
    let server = app.meanwhile(|| SoundServer::start(&home()));
    app.wait_for_title("the monitor", |title| title.starts_with("Monitor of ") && title.contains("live"));
    server.kill();
    app.wait_for_title("no sound", |title| title.contains("no sound"));
    wait_for_another(&app, &app.picture());
    // The first attempt to open the monitor again follows within a second.
    app.wait_until("another attempt", |app| {
        app.reported_problems().join("\n").matches("no sound: the computer's own sound").count() == 2
    });
    let reported = app.quit_by_key();
    let reported_problems = reported_problems(&reported).join("\n");
    assert_eq!(
        reported_problems.matches("settings.toml cannot be understood").count(),
        1,
        "{reported_problems}"
    );
    assert_eq!(
        reported_problems.matches("no sound: the computer's own sound").count(),
        2,
        "{reported_problems}"
    );
    assert!(reported_problems.contains("pipewire-pulse"), "{reported_problems}");
    assert_eq!(place.saved_settings(), "microphone = [", "the damaged settings file was changed");
}
