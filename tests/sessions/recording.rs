//! Recording of the user's actions, and renderings of the recorded show.

#![cfg(target_os = "linux")]

use crate::support::apart::apart;
use std::fs;
use std::net::UdpSocket;
use std::path::PathBuf;

use crate::support::osc::{Sender, sent_number};
use crate::support::session::{self, App};
use image::RgbaImage;
use mariana::commands::{Bind, Command};
use mariana_control::{Curve, SoundBinding};
use mariana_testing::wave::write_wav;

const SIZE: &str = "64x36";
/// Each action occurs at least twice.
const MOMENTS: usize = 12;
/// In seconds.
const SECONDS: f64 = 120.0;
/// The OSC address of the playback position, 0..1.
const PROGRESS: &str = "/sound/progress";

/// A wall that fills the frame even if the camera turns a little. Its colour depends on the direction of view. The
/// colour changes softly, so that the frame has no edges: stills take more samples at edges.
const WALL: &str = "param red = 0.2 in 0 .. 1\nparam width = 1 in 0.5 .. 4\n\
    material paint { color = 0  roughness = 1  emission = vec3(red, 0.5 + 0.2 * sin(0.2 * width * p.x), 0.5 + 0.2 * sin(0.2 * p.y + t)) }\n\
    object wall { shape = 5 - p.z  material = paint }\nlight none { direction = vec3(0, -1, 0)  color = 0 }\n\
    camera { position = vec3(0)  target = vec3(0, 0, 5) }\ncamera aside { position = vec3(0)  target = vec3(1, 0, 5) }\nsky { color = 0  ambient = 0 }\n";

struct Place {
    inner: session::Place,
    song: PathBuf,
    sender: Sender,
    /// Receives the sound features from the session.
    hearer: UdpSocket,
}

impl Place {
    fn new() -> Self {
        let inner = session::Place::new();
        let song = inner.quiet_song("song.wav", SECONDS as usize);
        inner.save("wall.scene", WALL);
        inner.save("wool.scene", &WALL.replace("vec3(red", "vec3(1 - red"));
        Self { inner, song, sender: Sender::new(), hearer: UdpSocket::bind("127.0.0.1:0").unwrap() }
    }

    fn open(&self, options: &[&str]) -> App {
        let scene = self.inner.path("wall.scene");
        let port = self.sender.port.to_string();
        let to = self.hearer.local_addr().unwrap().to_string();
        // Render at full resolution even on a busy machine.
        let usual = ["--size", SIZE, "--quality", "best", "--scene", scene.to_str().unwrap()];
        let network = ["--osc", &port, "--osc-send", &to];
        let app = self.inner.open(&self.song, &[&usual[..], &network, options].concat());
        app.wait_until_reported("first picture");
        app.wait_until_reported("receiving OSC");
        app
    }

    /// Plays the song for at least a second.
    fn hear_a_second(&self, app: &App) {
        app.wait_until("a second of the song", |_| {
            sent_number(&self.hearer, PROGRESS).is_some_and(|fraction| f64::from(fraction) * SECONDS > 1.0)
        });
    }

    fn go_to(&self, app: &App, time: f64) {
        let fraction = (time / SECONDS) as f32;
        self.sender.send("/position", &[fraction]);
        app.wait_until(&format!("the position at {time} s"), |_| {
            sent_number(&self.hearer, PROGRESS).is_some_and(|at| (at - fraction).abs() < 1e-4)
        });
    }

    fn freeze(&self, app: &App) {
        self.sender.send("/freeze", &[1.0]);
        app.wait_until("the frozen frame", |app| app.state().frozen);
    }

    fn let_go(&self) {
        self.sender.send("/freeze", &[0.0]);
    }

    /// Starts a fade with `act` while the song plays. `number` is the number of fades so far, including this fade.
    fn fade_while_it_runs(&self, app: &App, number: usize, act: impl FnOnce(&App)) {
        self.sender.send("/pause", &[0.0]);
        app.wait_for_title("runs", |title| !title.contains("paused"));
        act(app);
        app.wait_until_reported_times("a fade begins", number);
        self.rest(app);
    }

    fn rest(&self, app: &App) {
        self.sender.send("/pause", &[1.0]);
        app.wait_for_title("paused", |title| title.contains("paused"));
    }

    /// Compares each frame with the recorded show at the same time. Returns the text of the show.
    fn compare(&self, app: App, pictures: &[(f64, RgbaImage)]) -> String {
        app.press(&["F9"]);
        app.wait_until_reported("recorded: ");
        let reported = app.reported();
        let path =
            reported.lines().find_map(|line| line.split_once("recorded: ")?.1.split_once(';')).unwrap().0;
        app.quit_by_key();
        let show = fs::read_to_string(path).unwrap();
        self.inner.compare_with_stills((&self.song, path), SIZE, pictures);
        show
    }
}

#[test]
fn recorded_actions_are_rendered_again_bit_for_bit() {
    apart!();
    let place = Place::new();
    let sender = &place.sender;
    let app = place.open(&["--fade", "0"]);
    app.pause_at_start();
    app.press(&["F9"]);
    let mut pictures = Vec::new();
    for number in 0..MOMENTS {
        let before = app.picture();
        match number % 5 {
            0 | 3 => sender.send("/param/red", &[0.05 + 0.04 * number as f32]),
            1 => sender.send("/param/width", &[0.6 + 0.13 * number as f32]),
            2 => {
                let (x, y) = (24 + number as u32 / 8, 13 + number as u32 / 9);
                app.point_at(30, 18);
                app.hold_button(true);
                app.point_at(x, y);
                app.hold_button(false);
            }
            _ if number % 2 == 0 => sender.send("/scene/wool", &[]),
            _ => sender.send("/scene/wall", &[]),
        }
        let after = app.settled(&before, &format!("hand {number}"));
        app.press(&["Right"]);
        app.settled(&after, &format!("after {number}"));
        pictures.push((5.0 * number as f64, after));
    }
    place.compare(app, &pictures);
}

#[test]
fn a_slider_that_follows_the_sound_is_rendered_again_bit_for_bit() {
    apart!();
    let place = Place::new();
    // Bass that rises and falls every eight seconds.
    let level = |at: f32| 0.8 * (0.5 - 0.5 * (at * std::f32::consts::TAU / 8.0).cos());
    let bass = (0..8_000 * SECONDS as usize).map(|at| {
        let at = at as f32 / 8_000.0;
        level(at) * (at * 80.0 * std::f32::consts::TAU).sin()
    });
    write_wav(&place.song, 8_000, 2, bass.flat_map(|sample| [sample, sample]));
    let app = place.open(&["--fade", "0"]);
    app.press(&["space"]);
    app.wait_for_title("paused", |title| title.contains("paused"));
    let (input, curve) = ("bass".to_owned(), Curve::Root);
    let binding = Some(SoundBinding { input, low: 0.0, high: 1.0, curve, smoothing: 0.0, release: None });
    app.command(Command::Bind(Bind { name: "red".to_owned(), binding }));
    app.press(&["F9"]);
    let (mut pictures, mut last) = (Vec::new(), app.picture());
    for number in 1..=6 {
        // At 1, 4, 7, ... seconds the level differs.
        let time = f64::from(3 * number - 2);
        place.go_to(&app, time);
        last = app.settled(&last, &format!("{time} s"));
        pictures.push((time, last.clone()));
    }
    let show = place.compare(app, &pictures);
    assert!(show.contains("set red = "), "{show}");
}

#[test]
fn fades_blackouts_and_frozen_frames_are_rendered_again_bit_for_bit() {
    apart!();
    let place = Place::new();
    let app = place.open(&["--fade", "20", "--blackout-fade", "3"]);
    // Wait for some frames, so that both scenes can be drawn.
    place.hear_a_second(&app);
    app.press(&["F9"]);
    // The fade begins while the song plays. Both scenes move during the fade.
    app.press(&["n"]);
    app.wait_until_reported("a fade begins");
    app.press(&["space"]);
    app.wait_for_title("paused", |title| title.contains("paused"));
    let mut pictures: Vec<(f64, RgbaImage)> = Vec::new();
    let mut last = app.picture();
    for number in 2..=5 {
        let time = 3.75 * f64::from(number);
        place.go_to(&app, time);
        let there = app.settled(&last, &format!("{time} s"));
        place.sender.send("/param/red", &[0.15 * number as f32]);
        last = app.settled(&there, &format!("a knob at {time} s"));
        pictures.push((time, last.clone()));
    }
    place.go_to(&app, 26.25);
    let there = app.settled(&last, "the frame after the fade");
    place.sender.send("/brightness", &[0.4]);
    let dim = app.settled(&there, "less light");
    pictures.push((26.25, dim.clone()));
    place.go_to(&app, 27.5);
    let dim = app.settled(&dim, "less light at another time");
    place.sender.send("/brightness", &[1.0]);
    let there = app.settled(&dim, "all light");
    place.go_to(&app, 30.0);
    let held = app.settled(&there, "the frame to freeze");
    place.freeze(&app);
    place.sender.send("/param/width", &[3.0]);
    place.go_to(&app, 33.75);
    assert!(app.picture() == held);
    pictures.push((31.875, held.clone()));
    place.sender.send("/freeze", &[0.0]);
    let last = app.settled(&held, "the frame after the freeze");
    pictures.push((33.75, last.clone()));
    // Freeze another frame. It fades out while the song plays.
    place.go_to(&app, 45.0);
    let last = app.settled(&last, "the frame to freeze");
    place.freeze(&app);
    place.sender.send("/pause", &[0.0]);
    place.sender.send("/freeze", &[0.0]);
    app.wait_until_reported_times("a fade begins", 3);
    app.press(&["space"]);
    app.wait_for_title("paused", |title| title.contains("paused"));
    place.go_to(&app, 47.8125);
    let fades = app.settled(&last, "the fade from the frozen frame");
    pictures.push((47.8125, fades.clone()));
    place.go_to(&app, 52.5);
    let behind = app.settled(&fades, "behind it");
    pictures.push((52.5, behind.clone()));
    place.go_to(&app, 56.25);
    app.settled(&behind, "the frame before the blackout");
    app.press(&["x"]);
    app.wait_until("black", |_| app.picture().pixels().all(|pixel| pixel.0[..3] == [0; 3]));
    pictures.push((56.25, app.picture()));
    let show = place.compare(app, &pictures);
    for part in ["fade over 20 s", "set picture freeze = ", "set picture brightness = "] {
        assert!(show.contains(part), "no `{part}` in\n{show}");
    }
}

#[test]
fn an_interrupted_fade_is_rendered_again_bit_for_bit() {
    apart!();
    let place = Place::new();
    let app = place.open(&["--fade", "30", "--blackout-fade", "5"]);
    place.hear_a_second(&app);
    app.press(&["F9"]);
    app.press(&["n"]);
    app.wait_until_reported("a fade begins");
    place.rest(&app);
    place.go_to(&app, 7.5);
    let first = app.picture();
    place.sender.send("/param/red", &[0.6]);
    let mut last = app.settled(&first, "the fade that will be interrupted");
    let mut pictures = vec![(7.5, last.clone())];
    place.go_to(&app, 11.25);
    last = app.settled(&last, "a later time of the fade");
    // Return to the first scene, long before the fade is complete.
    place.fade_while_it_runs(&app, 2, |app| app.press(&["p"]));
    for time in [15.0, 22.5] {
        place.go_to(&app, time);
        last = app.settled(&last, &format!("{time} s"));
        pictures.push((time, last.clone()));
    }
    // A freeze also interrupts a fade. At the end of the freeze, the frozen frame fades to the new scene.
    place.freeze(&app);
    place.sender.send("/param/width", &[3.0]);
    place.go_to(&app, 26.25);
    pictures.push((25.3125, last.clone()));
    place.fade_while_it_runs(&app, 3, |_| place.let_go());
    for time in [28.125, 37.5] {
        place.go_to(&app, time);
        last = app.settled(&last, &format!("{time} s"));
        pictures.push((time, last.clone()));
    }
    let show = place.compare(app, &pictures);
    assert!(show.matches("fade over 30 s unfinished").count() == 2, "{show}");
}

#[test]
fn a_freeze_during_a_fade_is_rendered_again_bit_for_bit() {
    apart!();
    let place = Place::new();
    let app = place.open(&["--fade", "0", "--blackout-fade", "15"]);
    app.press(&["F9"]);
    place.rest(&app);
    let mut last = app.picture();
    let mut pictures = Vec::new();
    for (number, time) in [15.0, 26.25, 37.5].into_iter().enumerate() {
        place.go_to(&app, time);
        last = app.settled(&last, "the frame to freeze");
        pictures.push((time, last.clone()));
        place.freeze(&app);
        place.sender.send("/param/width", &[1.0 + number as f32]);
        place.sender.send("/param/red", &[0.3 * number as f32]);
        place.go_to(&app, time + 3.75);
        assert!(app.picture() == last, "the frame is not frozen");
        pictures.push((time + 1.875, last.clone()));
        place.fade_while_it_runs(&app, number + 1, |_| place.let_go());
    }
    for time in [48.75, 60.0] {
        place.go_to(&app, time);
        last = app.settled(&last, &format!("{time} s"));
        pictures.push((time, last.clone()));
    }
    place.compare(app, &pictures);
}

#[test]
fn scene_changes_behind_a_frozen_frame_are_rendered_again_bit_for_bit() {
    apart!();
    let place = Place::new();
    let app = place.open(&["--fade", "10", "--blackout-fade", "5"]);
    app.press(&["F9"]);
    place.rest(&app);
    let mut last = app.picture();
    let mut pictures = Vec::new();
    for (number, (time, keys)) in
        [(15.0, &["n"][..]), (30.0, &["p"]), (45.0, &["n", "p"])].into_iter().enumerate()
    {
        place.go_to(&app, time);
        last = app.settled(&last, "the frame to freeze");
        pictures.push((time, last.clone()));
        place.freeze(&app);
        for (key, scene) in keys.iter().zip(["wool", "wall"].iter().cycle().skip(number % 2)) {
            app.press(&[key]);
            app.wait_for_title(scene, |title| title.contains(scene));
        }
        place.sender.send("/param/width", &[1.5 + number as f32]);
        place.go_to(&app, time + 3.75);
        assert!(app.picture() == last, "the frame is not frozen");
        pictures.push((time + 1.875, last.clone()));
        place.fade_while_it_runs(&app, number + 1, |_| place.let_go());
        for behind in [6.5625, 11.25] {
            place.go_to(&app, time + behind);
            last = app.settled(&last, &format!("{} s", time + behind));
            pictures.push((time + behind, last.clone()));
        }
    }
    // Seek back during a freeze. The frame stays frozen until the freeze ends.
    place.freeze(&app);
    place.go_to(&app, 52.5);
    place.fade_while_it_runs(&app, 4, |_| place.let_go());
    place.go_to(&app, 60.0);
    last = app.settled(&last, "the frame after the freeze");
    pictures.retain(|(time, _)| *time < 52.5);
    pictures.push((60.0, last));
    place.compare(app, &pictures);
}

#[test]
fn a_scene_of_a_show_shown_again_by_hand_is_rendered_again_bit_for_bit() {
    apart!();
    let place = Place::new();
    let show = place.inner.path("led.show");
    let text = "at start wall.scene\n set width = 1 -> 4 over 60 s\n\
                at 20 s wool.scene camera aside cut\n set red = 0 -> 1 over 60 s\n set camera yaw = 0 -> 12 over 60 s\n\
                at 80 s wall.scene cut\n set width = 4 -> 1 over 30 s\n";
    fs::write(&show, text).unwrap();
    let app = place.open(&["--fade", "0", "--show", show.to_str().unwrap()]);
    app.wait_until_reported("the scenes follow the song");
    app.press(&["F9"]);
    place.rest(&app);
    let mut last = app.picture();
    let mut pictures = Vec::new();
    let mut see = |app: &App, time: f64| {
        place.go_to(app, time);
        last = app.settled(&last, &format!("{time} s"));
        pictures.push((time, last.clone()));
    };
    see(&app, 15.0);
    see(&app, 26.25);
    place.go_to(&app, 28.125);
    app.press(&["k", "p"]);
    see(&app, 30.0);
    place.go_to(&app, 33.75);
    app.press(&["n"]);
    for time in [37.5, 45.0] {
        see(&app, time);
    }
    // The show continues, but the chosen scene stays until the show itself switches to that scene.
    place.go_to(&app, 52.5);
    app.press(&["p"]);
    for time in [60.0, 82.5, 90.0] {
        see(&app, time);
    }
    place.compare(app, &pictures);
}

#[test]
fn a_recording_of_a_track_that_repeats_ends_with_its_first_lap() {
    apart!();
    let mut place = Place::new();
    place.song = place.inner.quiet_song("short.wav", 6);
    let app = place.open(&["--fade", "0"]);
    app.press(&["F9"]);
    app.wait_until_reported("recording: press F9 to stop");
    app.press(&["n"]);
    app.wait_until_reported("recorded: ");
    let reported = app.reported();
    let path = reported.lines().find_map(|line| line.split_once("recorded: ")?.1.split_once(';')).unwrap().0;
    // The second lap changes nothing.
    app.press(&["n"]);
    app.run_for(std::time::Duration::from_secs(2));
    let show = fs::read_to_string(path).unwrap();
    assert!(show.contains("wall.scene") && show.contains("wool.scene"), "{show}");
    assert!(!app.state().recording);
    app.quit();
}
