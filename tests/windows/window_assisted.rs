//! The window with a screen reader, which uses Linux's accessibility interface (AT-SPI).

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used)]

use crate::support::desktop::Desktop;
use mariana_testing::process::wait_until;
use mariana_testing::screen_reader::{BUTTON, Control, LABEL, SLIDER, ScreenReader, TOGGLE};
use mariana_testing::session_bus::SessionBus;
use mariana_testing::wave::write_wav;

fn find(reader: &ScreenReader<'_>, role: u32, begin: &str) -> Option<Control> {
    reader.controls().into_iter().find(|control| control.role == role && control.name.starts_with(begin))
}

fn wait_for(reader: &ScreenReader<'_>, role: u32, begin: &str) -> Control {
    let mut found = None;
    wait_until(begin, || {
        found = find(reader, role, begin);
        found.is_some()
    });
    found.unwrap()
}

#[test]
fn a_screen_reader_finds_the_buttons_and_controls_the_song() {
    let desktop = Desktop::start();
    let bus = SessionBus::start(desktop.folder());
    let reader = ScreenReader::start(&bus);
    let song = desktop.folder().join("song.wav");
    write_wav(&song, 8_000, 2, (0..16_000 * 60).map(|n| (n as f32 * 0.02).sin() * 0.4));
    let mut app = desktop.open(&song, &["--silent", "--size", "640x360"]);
    app.wait_for_title("the song", |title| title.starts_with("song.wav"));
    assert!(!reader.controls().iter().any(|control| control.name.contains("Space")), "nobody listens");

    // The bar is hidden, but the screen reader finds its controls.
    reader.listen(true);
    let pause = wait_for(&reader, TOGGLE, "pause or resume; with Shift, refine the paused picture (Space");
    assert!(!reader.is_on(&pause));
    reader.press(&pause);
    app.wait_for_title("paused", |title| title.contains("paused"));
    wait_until("the state of the button", || reader.is_on(&pause));
    wait_for(&reader, BUTTON, "next track");
    let volume = wait_for(&reader, SLIDER, "volume");
    reader.set_value(&volume, 40.0);
    wait_until("the volume", || {
        reader.value(&volume).parse().is_ok_and(|value: f64| (value - 40.0).abs() < 0.5)
    });
    let position = wait_for(&reader, SLIDER, "position");
    reader.set_value(&position, 30.0);
    wait_until("the seek", || {
        reader.value(&position).parse().is_ok_and(|value: f64| (value - 30.0).abs() < 1.0)
    });
    // The screen reader can open a list and find the list's entries.
    reader.press(&wait_for(&reader, TOGGLE, "track list"));
    wait_until("the track in the list", || {
        reader.controls().iter().any(|control| control.name.contains("song.wav") && control.role != LABEL)
    });
    reader.press(&wait_for(&reader, TOGGLE, "track list"));

    reader.listen(false);
    wait_until("silence", || find(&reader, TOGGLE, "pause").is_none());
    app.press(&["q"]);
    let (status, reported) = app.wait_for_end();
    assert!(status.success() && reported.is_empty(), "{status}: {reported}");
}

#[test]
fn with_a_screen_reader_tab_opened_no_sliders_although_the_help_said_so() {
    let desktop = Desktop::start();
    let bus = SessionBus::start(desktop.folder());
    let reader = ScreenReader::start(&bus);
    let song = desktop.folder().join("song.wav");
    write_wav(&song, 8_000, 2, (0..16_000 * 60).map(|n| (n as f32 * 0.02).sin() * 0.4));
    let scene = desktop.folder().join("own.scene");
    std::fs::write(&scene, "param girth = 1 in 0 .. 2\nobject ball { shape = length(p) - girth }\n").unwrap();
    let options = ["--silent", "--size", "640x360", "--scene", scene.to_str().unwrap()];
    let mut app = desktop.open(&song, &options);
    app.wait_for_title("the scene", |title| title.contains("own"));
    reader.listen(true);
    // The button names a key that works with a screen reader, which needs Tab to move through the controls.
    let button = wait_for(&reader, TOGGLE, "the scene's sliders");
    assert!(button.name.contains("Backspace"), "{}", button.name);
    app.press(&["Tab", "BackSpace"]);
    wait_for(&reader, SLIDER, "girth");
    app.press(&["BackSpace"]);
    wait_until("the sliders are closed", || find(&reader, SLIDER, "girth").is_none());
    app.press(&["Escape", "q"]);
    let (status, reported) = app.wait_for_end();
    assert!(status.success() && reported.is_empty(), "{status}: {reported}");
}
