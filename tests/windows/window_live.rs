//! Live input as a user meets it: the program on a desktop of the test's own, on a sound server of the test's own.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::PathBuf;
use std::time::Duration;

use crate::support::compare::{TIGHT, difference};
use crate::support::desktop::{App, Desktop, PROGRAM};
use mariana_testing::process::{output_of, wait_until};
use mariana_testing::sound_server::SoundServer;
use mariana_testing::wave::write_wav;

const SMALL: &str = "320x180";
const QUIT_LIMIT: Duration = Duration::from_secs(60);
/// A scene that stands still without sound.
const LEVEL: &str = "min(y, max(length(p - vec3(0, 1, 0)) - 0.2 - 2 * volume.x, -1 * y))";

fn settings_file(desktop: &Desktop) -> PathBuf {
    desktop.folder().join(".config/mariana/settings.toml")
}

fn settings(desktop: &Desktop) -> String {
    std::fs::read_to_string(settings_file(desktop)).unwrap_or_default()
}

fn quit(app: App<'_>) -> String {
    app.press(&["q"]);
    let (status, told) = app.wait_for_end(QUIT_LIMIT);
    assert!(status.success(), "{status}: {told}");
    told
}

/// Whether the picture changes within a while.
fn moves(app: &App<'_>) -> bool {
    let before = app.picture();
    (0..30).any(|_| {
        std::thread::sleep(Duration::from_millis(50));
        difference(&before, &app.picture(), TIGHT.visible).share > 0.0
    })
}

#[test]
fn what_the_computer_plays_is_shown_and_silence_costs_little() {
    let desktop = Desktop::start();
    let server = SoundServer::start(desktop.folder());
    let mut app = desktop.listen(&["--system", "--size", SMALL, "--scene", LEVEL, "-v"]);
    app.wait_until_told("first picture after");
    app.wait_for_title("the monitor", |title| title.starts_with("Monitor of ") && title.contains("live"));
    // Two seconds of silence are told, and then everything rests.
    std::thread::sleep(Duration::from_secs(3));
    let load = app.load(Duration::from_secs(2));
    println!("silent input takes {:.1} % of a processor", 100.0 * load);
    assert!(load < 0.25, "silent input takes {load} of a processor");
    let silent = app.picture();
    let tone = server.play_tone("viz", 440.0);
    wait_until("the sound in the picture", || {
        difference(&silent, &app.picture(), TIGHT.visible).share > 0.02
    });
    drop(tone);
    // Paused it stands still, whatever is heard.
    app.press(&["space"]);
    app.wait_for_title("paused", |title| title.contains("paused"));
    let _tone = server.play_tone("viz", 440.0);
    wait_until("a picture that stands still", || !moves(&app));
    let told = quit(app);
    assert!(!told.contains("panicked"), "{told}");
}

#[test]
fn an_input_has_a_show_when_it_is_asked_for() {
    let desktop = Desktop::start();
    let server = SoundServer::start(desktop.folder());
    let mut app = desktop.listen(&["--system", "--size", "64x36", "--scene", LEVEL, "-v"]);
    app.wait_for_title("the formula", |title| title.contains("(formula"));
    let _tone = server.play_tone("viz", 440.0);
    app.press(&["a"]);
    app.wait_until_told("the scenes follow the song");
    app.wait_for_title("a scene of the director's choice", |title| {
        title.contains("live") && !title.contains("formula") && !title.contains("preparing")
    });
    app.press(&["a"]);
    let told = quit(app);
    assert!(!told.contains("panicked"), "{told}");
}

#[test]
fn the_source_is_changed_by_a_key_and_remembered_by_name() {
    let desktop = Desktop::start();
    let server = SoundServer::start(desktop.folder());
    server.plug("other", &["sink_properties=device.description=Other"]);
    server.set_default("viz");
    let song = desktop.folder().join("song.wav");
    write_wav(&song, 48_000, 2, (0..48_000 * 120).map(|n| (f64::from(n) * 0.02).sin() as f32 * 0.3));
    let mut app = desktop.open(&song, &["--size", SMALL]);
    app.wait_for_title("the song", |title| title.starts_with("song.wav"));
    // The computer's sound, the default input, then the inputs one by one.
    app.press(&["d"]);
    app.wait_for_title("live", |title| title.contains("live"));
    app.press(&["d", "d", "d"]);
    app.wait_for_title("the other monitor", |title| title.starts_with("Monitor of Other"));
    wait_until("the settings", || settings(&desktop).contains("system = \"pulseaudio:other.monitor\""));
    // Five milliseconds later twice, once sooner; of this device.
    app.press(&["bracketright", "bracketright", "bracketleft"]);
    wait_until("the shift", || settings(&desktop).contains("\"pulseaudio:other.monitor\" = 5.0"));
    app.press(&["d"]);
    app.wait_for_title("the song", |title| title.starts_with("song.wav") && !title.contains("live"));
    app.press(&["bracketleft"]);
    wait_until("the shift", || settings(&desktop).contains("\"pulseaudio:viz\" = -5.0"));
    assert_eq!(quit(app), "");

    let mut app = desktop.listen(&["--system", "--size", SMALL]);
    app.wait_for_title("the other monitor", |title| title.starts_with("Monitor of Other"));
    assert_eq!(quit(app), "");
}

#[test]
fn devices_that_come_and_go_are_told_and_the_picture_goes_on() {
    let desktop = Desktop::start();
    // No sound server at all, and a file of settings that holds none.
    std::fs::create_dir_all(settings_file(&desktop).parent().unwrap()).unwrap();
    std::fs::write(settings_file(&desktop), "microphone = [").unwrap();
    let mut app = desktop.listen(&["--system", "--size", SMALL]);
    app.wait_for_title("no sound", |title| title.contains("no sound"));
    assert!(moves(&app));
    let server = SoundServer::start(desktop.folder());
    app.wait_for_title("the monitor", |title| title.starts_with("Monitor of ") && title.contains("live"));
    server.kill();
    app.wait_for_title("no sound", |title| title.contains("no sound"));
    assert!(moves(&app));
    let told = quit(app);
    assert_eq!(told.matches("settings.toml cannot be understood").count(), 1, "{told}");
    assert_eq!(told.matches("nothing is heard: ").count(), 2, "{told}");
    assert!(told.contains("pipewire-pulse"), "{told}");
    assert_eq!(settings(&desktop), "microphone = [", "it was touched");
}

#[test]
fn arguments_that_contradict_each_other_are_refused() {
    let refused = |arguments: &[&str]| {
        output_of(std::process::Command::new(PROGRAM).args(arguments), "mariana").unwrap_err()
    };
    for arguments in
        [&["--mic", "--system"][..], &["song.wav", "--mic"], &["--system", "--silent"], &["--mic", "--once"]]
    {
        let told = refused(arguments);
        assert!(told.contains("cannot be used with"), "{arguments:?}: {told}");
    }
}
