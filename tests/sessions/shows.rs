//! Scenes that follow the song. The director, a show file or the user chooses them.

#![cfg(target_os = "linux")]

use std::fs;
use std::net::UdpSocket;
use std::path::PathBuf;

use crate::support::apart::apart;
use crate::support::desktop::{PROGRAM, command_in};
use crate::support::osc::{Sender, sent_number};
use crate::support::session::{self, App};
use image::RgbaImage;
use mariana::commands::Command;
use mariana::scenes::shipped_names;
use mariana_testing::process::output_of;
use mariana_testing::wave::write_wav;

const SIZE: &str = "64x36";
/// The number of positions in the song to which keys can seek. The positions are 5 s apart.
const MOMENTS: usize = 20;
/// Duration of the song in most tests, in seconds.
const SECONDS: usize = 100;
/// Samples a second. Few, because each process reads the whole song.
const RATE: usize = 8_000;

struct Place {
    inner: session::Place,
    song: PathBuf,
}

impl Place {
    fn new() -> Self {
        let inner = session::Place::new();
        let song = inner.path("song.wav");
        // The song consists of clicks, so that it has a tempo.
        let samples = (0..SECONDS * RATE).flat_map(|frame| {
            let since = frame % (RATE / 2);
            [if since < RATE / 120 { 0.5 * (0.4 * since as f32).sin() } else { 0.0 }; 2]
        });
        write_wav(&song, RATE as u32, 2, samples);
        let place = Self { inner, song };
        for (name, colour) in [("red", "0.9, 0, 0"), ("green", "0, 0.9, 0"), ("blue", "0, 0, 0.9")] {
            place.write(
                &format!("{name}.scene"),
                &format!(
                    "param level = 1 in 0 .. 1\n\
                     material paint {{ color = 0  roughness = 1  emission = level * vec3({colour}) }}\n\
                     object wall {{ shape = 5 - p.z  material = paint }}\nsky {{ color = 0  ambient = 0 }}\n\
                     light none {{ direction = vec3(0, -1, 0)  color = 0 }}\n\
                     camera {{ position = vec3(0)  target = vec3(0, 0, 5) }}\n\
                     about {{ portal = box(p, vec3(0.8, 0.5, 0.3)) }}\n"
                ),
            );
        }
        place
    }

    fn path(&self, name: &str) -> String {
        self.inner.path(name).to_str().unwrap().to_owned()
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
    }

    fn open(&self, options: &[&str]) -> App {
        let own = [self.song.to_str().unwrap(), "--silent", "--new", "--clean", "--size", SIZE];
        let app = self.inner.begin(&[&own[..], options].concat());
        app.wait_until_reported("the scenes follow the song");
        app
    }

    fn still(&self, show: &str, time: &str) -> RgbaImage {
        let output = self.inner.path("still.png");
        let mut command = command_in(PROGRAM, self.inner.folder(), None);
        command
            .arg("still")
            .arg(&self.song)
            .args(["--show", show, "--at", time, "--size", SIZE, "-o"])
            .arg(&output);
        output_of(&mut command, "mariana").unwrap();
        image::open(&output).unwrap().to_rgba8()
    }
}

/// The channel that dominates in the middle of the frame, if any.
fn channel(app: &App) -> Option<usize> {
    channel_at(app, (32, 18))
}

fn channel_at(app: &App, (x, y): (u32, u32)) -> Option<usize> {
    let pixel = app.picture().get_pixel(x, y).0;
    (0..3).find(|channel| {
        (0..3)
            .all(|other| other == *channel || u32::from(pixel[*channel]) > 3 * u32::from(pixel[other].max(8)))
    })
}

/// The mean difference of two images over all channels, in steps of 0..255.
fn distance(a: &RgbaImage, b: &RgbaImage) -> f64 {
    let numbers = a.as_raw().iter().zip(b.as_raw());
    numbers.map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>() / a.as_raw().len().max(1) as f64
}

fn wait_for_channel(app: &App, wanted: usize) {
    app.wait_until("a colour", |app| channel(app) == Some(wanted));
}

fn assert_channel_stays(app: &App, wanted: usize) {
    for _ in 0..50 {
        assert_eq!(channel(app), Some(wanted), "the colour changed: {}", app.reported());
    }
}

fn pause(app: &App) {
    app.press(&["space"]);
    app.wait_for_title("paused", |title| title.contains("paused"));
}

fn go_to(app: &App, seconds: usize) {
    app.press(&["Left"; MOMENTS]);
    if seconds > 0 {
        app.press(&vec!["Right"; seconds / 5]);
    }
}

fn wait_for_time(app: &App, seconds: f32) {
    app.wait_until(&format!("{seconds} s"), |app| {
        app.state().position.is_some_and(|at| (at * SECONDS as f32 - seconds).abs() < 0.01)
    });
}

#[test]
fn a_show_in_a_window_equals_its_stills_and_follows_saves() {
    apart!();
    let place = Place::new();
    let show = place.path("my.show");
    // At each of the first positions to which keys can seek, a transition is in progress. Each way occurs.
    const POSITIONS: usize = 10;
    let mut text = "at start red.scene\n".to_owned();
    let ways = ["melt", "portal", "fade", "portal plane", "melt", "portal shape", "fade"];
    let scenes = ["green", "blue", "red", "blue"];
    for (number, (way, scene)) in
        ways.iter().cycle().zip(scenes.iter().cycle()).take(POSITIONS - 2).enumerate()
    {
        let start = 5 * number + 4;
        text.push_str(&format!(
            "at {start} s {scene}.scene {way} over 2 s\n set level = 0.2 -> 1 over 8 s\n"
        ));
    }
    text.push_str(&format!("at {} s red.scene fade over 4 s\n set level = 0.3\n", 5 * (POSITIONS - 1) - 1));
    place.write("my.show", &text);
    let app = place.open(&["--show", &show]);
    pause(&app);
    go_to(&app, 0);
    let wanted: Vec<RgbaImage> =
        (0..POSITIONS).map(|number| place.still(&show, &(5 * number).to_string())).collect();
    for (number, wanted) in wanted.iter().enumerate() {
        if number > 0 {
            app.press(&["Right"]);
        }
        app.wait_until(&format!("the still of {} s", 5 * number), |app| app.picture() == *wanted);
    }
    app.press(&["Left"; 4]);
    app.wait_until("the same frame after a jump", |app| app.picture() == wanted[POSITIONS - 5]);
    go_to(&app, 10);
    wait_for_channel(&app, 2);
    // When the file is saved, the session shows the change. If the saved text has mistakes, the session reports them
    // and keeps the old show.
    let still = "at start blue.scene\nat 30 s red.scene portal over 2 s\n";
    place.write("my.show", &still.replace("blue", "green"));
    wait_for_channel(&app, 1);
    place.write("my.show", &still.replace("portal", "portl"));
    app.wait_until_reported("did you mean `portal`?");
    // The error panel covers this small window except for its edges.
    app.wait_until("the frame to stay", |app| channel_at(app, (1, 1)) == Some(1));
    place.write("my.show", still);
    wait_for_channel(&app, 2);
    app.quit_by_key();
}

#[test]
fn the_director_uses_the_structure_of_a_lists_first_track() {
    apart!();
    let place = Place::new();
    // The song has a calm half and a loud half. These are two sections, and each section gets a scene.
    let rate = RATE as u32;
    let samples = (0..60 * rate).flat_map(|frame: u32| {
        let (loud, at) = (frame >= 30 * rate, (frame % (rate / 2)) as f32);
        let hiss = (frame.wrapping_mul(2_654_435_761) >> 16) as f32 / 32_768.0 - 1.0;
        let beat = (-at / 333.0).exp() * (0.12 * at).sin();
        [if loud { 0.5 * beat + 0.3 * hiss } else { 0.05 * beat }; 2]
    });
    write_wav(&place.song, rate, 2, samples);
    for (name, range) in [("red", "0 .. 0.3"), ("green", "0.3 .. 0.5"), ("blue", "0.6 .. 1")] {
        let scene = fs::read_to_string(place.path(&format!("{name}.scene"))).unwrap();
        let scene = scene.replace("about {", &format!("about {{ energy = {range} "));
        place.write(&format!("{name}.scene"), &scene);
    }
    let show = place.path("auto.show");
    let mut command = command_in(PROGRAM, place.inner.folder(), None);
    command.arg("show").arg(&place.song).args(["-o", &show]);
    // In the window, N steps through the same scenes.
    let own = ["red", "green", "blue"].map(|name| place.path(&format!("{name}.scene")));
    for scene in shipped_names().into_iter().chain(own) {
        command.args(["--scene", &scene]);
    }
    output_of(&mut command, "mariana").unwrap();
    let app = place.open(&["--show", "auto", "--scene", &place.path("red.scene")]);
    pause(&app);
    for (seconds, time) in [(10, "10"), (50, "50")] {
        go_to(&app, seconds);
        let wanted = place.still(&show, time);
        // Stills take more samples at edges, so the images are not equal.
        app.wait_until(&format!("the director's frame at {time} s"), |app| {
            distance(&app.picture(), &wanted) < 4.0
        });
    }
    app.quit_by_key();
}

#[test]
fn enter_starts_the_next_cue_of_a_show() {
    apart!();
    let place = Place::new();
    place.write("my.show", "at start red.scene\nat cue green.scene cut\nat cue blue.scene fade over 1 s\n");
    let show = place.path("my.show");
    let app = place.open(&["--show", &show, "--scene", &place.path("red.scene")]);
    app.wait_until_reported("green is ready ahead");
    wait_for_channel(&app, 0);
    app.press(&["Return"]);
    wait_for_channel(&app, 1);
    app.press(&["Return"]);
    wait_for_channel(&app, 2);
    // The first cue waits again after a seek to the time before the first press.
    pause(&app);
    go_to(&app, 0);
    wait_for_channel(&app, 0);
    app.press(&["Return"]);
    wait_for_channel(&app, 1);
    app.quit_by_key();
}

#[test]
fn a_jump_in_the_list_of_cues_presses_keys_or_seeks() {
    apart!();
    let place = Place::new();
    place.write(
        "my.show",
        "at start red.scene\nat cue green.scene cut\nat cue blue.scene cut\nat previous + 5 s green.scene cut\n\
         at 60 s red.scene cut\n",
    );
    let show = place.path("my.show");
    let app = place.open(&["--show", &show, "--scene", &place.path("red.scene"), "--fade", "0"]);
    pause(&app);
    go_to(&app, 0);
    wait_for_channel(&app, 0);
    app.command(Command::CueAt(3));
    wait_for_channel(&app, 2);
    app.press(&["Right", "Right"]);
    wait_for_channel(&app, 1);
    app.press(&["Left", "Left"]);
    wait_for_channel(&app, 2);
    app.command(Command::PreviousCue);
    wait_for_channel(&app, 1);
    app.command(Command::CueAt(5));
    wait_for_channel(&app, 0);
    app.command(Command::CueAt(9));
    app.wait_until_reported("the show cannot go there");
    app.quit_by_key();
}

#[test]
fn the_user_overrides_the_show_until_its_next_scene_or_keeps_a_scene() {
    apart!();
    let place = Place::new();
    place.write("my.show", "at start red.scene\nat 10 s green.scene cut\nat 20 s blue.scene cut\n");
    let show = place.path("my.show");
    let app = place.open(&["--show", &show, "--scene", &place.path("red.scene"), "--fade", "0"]);
    pause(&app);
    go_to(&app, 0);
    wait_for_channel(&app, 0);
    // The scenes of the folder are sorted by name, so green precedes red.
    app.press(&["p"]);
    wait_for_channel(&app, 1);
    app.press(&["Right"]);
    wait_for_time(&app, 5.0);
    assert_channel_stays(&app, 1);
    go_to(&app, 20);
    wait_for_channel(&app, 2);
    // K keeps the scene. A second K returns to the show.
    app.press(&["k"]);
    go_to(&app, 0);
    wait_for_time(&app, 0.0);
    assert_channel_stays(&app, 2);
    app.press(&["k"]);
    wait_for_channel(&app, 0);
    // A switches the show off. Then the scene is the same at any position of the song.
    app.press(&["a"]);
    go_to(&app, 10);
    wait_for_time(&app, 10.0);
    assert_channel_stays(&app, 0);
    app.press(&["a"]);
    wait_for_channel(&app, 1);
    app.quit_by_key();
}

#[test]
fn a_show_with_mistakes_starts_when_it_is_corrected() {
    apart!();
    let place = Place::new();
    let (show, song) = (place.path("my.show"), place.song.to_str().unwrap());
    place.write("my.show", "at start red.scene\nat noon green.scene\n");
    let app = place.inner.begin(&[song, "--silent", "--new", "--clean", "--size", SIZE, "--show", &show]);
    app.wait_until_reported("problem: the show has mistakes and starts when its file is corrected");
    place.write("my.show", "at start green.scene\n");
    wait_for_channel(&app, 1);
    place.write("my.show", "at noon red.scene\n");
    app.wait_until_reported("problem: the show has mistakes; the previous show continues");
    app.quit();
}

#[test]
fn a_show_keeps_the_scene_that_is_edited() {
    apart!();
    let place = Place::new();
    let show = place.path("my.show");
    place.write("my.show", "at start red.scene\nat 20 s green.scene\nat 60 s blue.scene\n");
    let (sender, lights) = (Sender::new(), UdpSocket::bind("127.0.0.1:0").unwrap());
    let lights_port = lights.local_addr().unwrap().to_string();
    let app = place.open(&["--osc", &sender.port.to_string(), "--osc-send", &lights_port, "--show", &show]);
    pause(&app);
    go_to(&app, 0);
    wait_for_channel(&app, 0);
    // On a busy computer, the song may have reached the next scene before it was paused.
    let greens = |app: &App| app.reported().matches("green is shown").count();
    let before = greens(&app);
    app.press(&["e"]);
    app.wait_until("the editor", |app| channel(app) != Some(0));
    sender.send("/position", &[0.3]);
    app.wait_until("the middle of the song", |_| {
        sent_number(&lights, "/sound/progress").is_some_and(|at| at > 0.25)
    });
    app.press(&["Escape"]);
    wait_for_channel(&app, 0);
    sender.send("/position", &[0.7]);
    wait_for_channel(&app, 2);
    assert_eq!(greens(&app), before, "{}", app.reported());
    app.quit_by_key();
}
