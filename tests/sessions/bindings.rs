//! Sliders that follow a sound.

#![cfg(target_os = "linux")]

use crate::support::apart::apart;
use std::fs;
use std::path::PathBuf;

use crate::controllers::{WALL, wait_for_colour};
use crate::support::osc::Sender;
use crate::support::session::{self, App};
use mariana::commands::{Bind, Command};
use mariana_control::{Curve, SoundBinding};
use mariana_testing::wave::write_wav;

const GREEN: [bool; 3] = [false, true, false];
const YELLOW: [bool; 3] = [true, true, false];

struct Place {
    inner: session::Place,
    song: PathBuf,
    scene: PathBuf,
}

impl Place {
    /// A folder with a song of loud bass.
    fn new() -> Self {
        let inner = session::Place::new();
        let song = inner.path("bass.wav");
        let bass = (0..8_000 * 60).map(|at| 0.9 * (at as f32 * 80.0 * std::f32::consts::TAU / 8_000.0).sin());
        write_wav(&song, 8_000, 2, bass.flat_map(|sample| [sample, sample]));
        let scene = inner.save("wall.scene", WALL);
        Self { inner, song, scene }
    }

    fn open(&self, size: &str, options: &[&str]) -> App {
        let scene: &[&str] =
            if options.contains(&"--scene") { &[] } else { &["--scene", self.scene.to_str().unwrap()] };
        let own = [scene, &["--size", size]].concat();
        let app = self.inner.open(&self.song, &[&own[..], options].concat());
        app.wait_until_reported("first picture");
        app
    }
}

fn bind(app: &App, name: &str, input: &str, [low, high]: [f32; 2]) {
    let (input, curve) = (input.to_owned(), Curve::Root);
    let binding = Some(SoundBinding { input, low, high, curve, smoothing: 0.0, release: None });
    app.command(Command::Bind(Bind { name: name.to_owned(), binding }));
}

fn unbind(app: &App, name: &str) {
    app.command(Command::Bind(Bind { name: name.to_owned(), binding: None }));
}

#[test]
fn a_bound_slider_follows_the_sound_until_a_controller_or_the_user_ends_it() {
    apart!();
    let place = Place::new();
    let osc = Sender::new();
    let app = place.open("160x90", &["--osc", &osc.port.to_string()]);
    app.wait_until_reported("receiving OSC");
    wait_for_colour(&app, "the scene's own values", GREEN);
    let loads = app.reported().matches("is loaded").count();
    bind(&app, "red", "bass", [0.0, 2.0]);
    wait_for_colour(&app, "red with the bass", YELLOW);
    bind(&app, "green", "bass", [1.0, -3.0]);
    wait_for_colour(&app, "no green with the bass", [true, false, false]);
    assert_eq!(app.reported().matches("is loaded").count(), loads, "binding loads no scene");
    osc.send("/param/red", &[0.0]);
    osc.send("/param/green", &[1.0]);
    wait_for_colour(&app, "the controller's values", GREEN);
    bind(&app, "red", "bass", [0.0, 2.0]);
    wait_for_colour(&app, "red again", YELLOW);
    unbind(&app, "red");
    wait_for_colour(&app, "the value before the binding", GREEN);
    // A name that does not exist, and a sound of a newer version.
    unbind(&app, "blue");
    app.wait_until_reported("this scene has no parameter 'blue'");
    bind(&app, "red", "theremin", [0.0, 2.0]);
    bind(&app, "green", "bass", [f32::NAN, 1.0]);
    app.take_steps(20);
    wait_for_colour(&app, "an unknown sound is silent", GREEN);
    app.quit();
}

#[test]
fn bindings_come_back_in_the_next_run() {
    apart!();
    let place = Place::new();
    let continued = ["--prepare-ahead", "off", "--clean", "--silent", "--size", "160x90"];
    let open = || {
        let files = [place.song.to_str().unwrap(), "--scene", place.scene.to_str().unwrap()];
        let app = place.inner.begin(&[&files[..], &continued].concat());
        app.wait_until_reported("first picture");
        app
    };
    let app = open();
    bind(&app, "red", "bass", [0.0, 2.0]);
    wait_for_colour(&app, "red with the bass", YELLOW);
    app.quit();
    let saved = place.inner.saved_settings();
    assert!(saved.contains("[bindings.wall.red]") && saved.contains("curve = \"root\""), "{saved}");
    let app = open();
    wait_for_colour(&app, "red with the bass in the next run", YELLOW);
    unbind(&app, "red");
    wait_for_colour(&app, "the text's value", GREEN);
    app.quit();
    let saved = place.inner.saved_settings();
    assert!(!saved.contains("bindings"), "{saved}");
}

#[test]
fn a_binding_is_written_into_the_text_and_one_undo_brings_the_text_back() {
    apart!();
    let place = Place::new();
    let app = place.open("760x420", &["--sdf", "interpreted"]);
    app.command(Command::WriteBinding("red".to_owned()));
    app.wait_until_reported("red follows no sound");
    bind(&app, "red", "bass", [0.0, 2.0]);
    let saved = || fs::read_to_string(&place.scene).unwrap();
    app.command(Command::WriteBinding("red".to_owned()));
    let right = |app: &App| {
        let picture = app.picture();
        let [red, green, ..] = picture.get_pixel(picture.width() - 5, picture.height() / 2).0;
        [red > 120, green > 120]
    };
    app.wait_until("the scene without the slider", |app| {
        right(app) == [true, true] && app.reported().contains("is loaded again for its draft")
    });
    assert_eq!(saved(), WALL, "nothing is saved without a command");
    app.press(&["ctrl+s"]);
    app.wait_until("the saved text", |_| saved() != WALL);
    assert_eq!(saved(), WALL.replace("param red = 0 in 0 .. 2", "let red = mix(0, 2, sqrt(bass))"));
    app.press(&["ctrl+z", "ctrl+s"]);
    app.wait_until("the text before", |_| saved() == WALL);
    app.quit();
}

#[test]
fn a_binding_of_a_shipped_scene_is_written_into_a_copy() {
    apart!();
    let place = Place::new();
    let app = place.open("760x420", &["--sdf", "interpreted", "--scene", "heart"]);
    bind(&app, "pump", "sine_16", [0.0, 2.0]);
    app.command(Command::WriteBinding("pump".to_owned()));
    app.take_steps(20);
    let copy = place.inner.path("data/scenes/heart.scene");
    assert!(!copy.exists(), "a scene cannot express a sine over 16 beats");
    bind(&app, "pump", "kick", [0.0, 2.0]);
    app.command(Command::WriteBinding("pump".to_owned()));
    app.wait_until("the copy", |_| copy.exists());
    let saved = || fs::read_to_string(&copy).unwrap_or_default();
    let original = saved();
    assert!(original.contains("\nparam pump = 1 in 0 .. 2"), "{original}");
    app.wait_until_reported("is loaded again for its draft");
    app.press(&["ctrl+s"]);
    app.wait_until("the written text", |_| saved().contains("\nlet pump = mix(0, 2, sqrt(kick))  "));
    app.quit();
}
