//! What hands do in a window, recorded and rendered again.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used)]

use std::fs;
use std::net::UdpSocket;
use std::path::PathBuf;
use std::time::Duration;

use crate::support::desktop::{App, Desktop, PROGRAM, command_in};
use crate::window_hands::Sender;
use image::RgbaImage;
use mariana_testing::process::{WAIT_LIMIT, output_of, wait_until};
use mariana_testing::wave::write_wav;

const SIZE: &str = "64x36";
const MOMENTS: usize = 20;
/// How long the song is.
const SECONDS: f64 = 120.0;
const QUIT_LIMIT: Duration = Duration::from_secs(60);

/// A wall that fills the picture, wherever the camera turns a little, and whose light shows where it looks: so softly that
/// nothing in it is an edge, of which stills take more samples.
const WALL: &str = "param red = 0.2 in 0 .. 1\nparam width = 1 in 0.5 .. 4\n\
    material paint { color = 0  roughness = 1  emission = vec3(red, 0.5 + 0.2 * sin(0.2 * width * p.x), 0.5 + 0.2 * sin(0.2 * p.y + t)) }\n\
    object wall { shape = 5 - p.z  material = paint }\nlight none { direction = vec3(0, -1, 0)  color = 0 }\n\
    camera { position = vec3(0)  target = vec3(0, 0, 5) }\ncamera aside { position = vec3(0)  target = vec3(1, 0, 5) }\nsky { color = 0  ambient = 0 }\n";

/// The picture once it is another than before and rests.
fn settled(app: &App<'_>, before: &RgbaImage, what: &str) -> RgbaImage {
    let mut last = before.clone();
    let mut rested = 0;
    wait_until(&format!("{what}: another picture that rests"), || {
        let picture = app.picture();
        rested = if picture == last && picture != *before { rested + 1 } else { 0 };
        last = picture;
        rested >= 8
    });
    last
}

/// A song of silence, and scenes.
struct Place {
    desktop: Desktop,
    song: PathBuf,
    sender: Sender,
    /// Where the program sends what it hears.
    hearer: UdpSocket,
}

impl Place {
    fn new() -> Self {
        let desktop = Desktop::start();
        let song = desktop.folder().join("song.wav");
        write_wav(&song, 8_000, 2, std::iter::repeat_n(0.0, 2 * 8_000 * SECONDS as usize));
        for (name, text) in [("wall", WALL.to_owned()), ("wool", WALL.replace("vec3(red", "vec3(1 - red"))] {
            fs::write(desktop.folder().join(format!("{name}.scene")), text).unwrap();
        }
        let hearer = UdpSocket::bind("127.0.0.1:0").unwrap();
        hearer.set_read_timeout(Some(WAIT_LIMIT)).unwrap();
        Self { desktop, song, sender: Sender::new(), hearer }
    }

    fn open(&self, options: &[&str]) -> App<'_> {
        let scene = self.desktop.folder().join("wall.scene");
        let port = self.sender.port.to_string();
        let to = self.hearer.local_addr().unwrap().to_string();
        // With all pixels, however busy the machine is.
        let usual =
            ["--silent", "-v", "--size", SIZE, "--quality", "best", "--scene", scene.to_str().unwrap()];
        let network = ["--osc", &port, "--osc-send", &to];
        self.desktop.open(&self.song, &[&usual[..], &network, options].concat())
    }

    /// Goes to a moment of the song.
    fn go_to(&self, time: f64) {
        let share = (time / SECONDS) as f32;
        self.sender.send("/position", &[share]);
        wait_until(&format!("the place at {time} s"), || (self.progress() - share).abs() < 1e-4);
    }

    /// Holds the picture that shows.
    fn freeze(&self) {
        self.sender.send("/freeze", &[1.0]);
        self.sender.ask("/query/freeze", |answer| answer.starts_with(b"/freeze\0,i\0\0\0\0\0\x01"));
    }

    /// Lets the picture go that is held.
    fn let_go(&self) {
        self.sender.send("/freeze", &[0.0]);
    }

    /// Lets the song run, until what `act` does has begun the fade of that number, and rest again.
    fn fade_while_it_runs(&self, app: &mut App<'_>, number: usize, act: impl FnOnce(&App<'_>)) {
        self.sender.send("/pause", &[0.0]);
        app.wait_for_title("runs", |title| !title.contains("paused"));
        act(app);
        app.wait_until_told_times("a fade begins", number);
        self.rest(app);
    }

    /// Lets the song rest.
    fn rest(&self, app: &mut App<'_>) {
        self.sender.send("/pause", &[1.0]);
        app.wait_for_title("paused", |title| title.contains("paused"));
    }

    /// How much of the song is over, 0..1, in the next message that tells it.
    fn progress(&self) -> f32 {
        const ADDRESS: &[u8] = b"/sound/progress\0,f\0\0";
        let mut buffer = [0; 4_096];
        loop {
            let (length, _) = self.hearer.recv_from(&mut buffer).unwrap();
            let at = buffer[..length].windows(ADDRESS.len()).position(|part| part == ADDRESS);
            if let Some(number) = at.and_then(|at| buffer[at + ADDRESS.len()..length].first_chunk()) {
                return f32::from_be_bytes(*number);
            }
        }
    }

    /// Ends the recording and the program, and holds each picture to that of its moment in the recorded show. Returns the
    /// show's text.
    fn compare(&self, mut app: App<'_>, pictures: &[(f64, RgbaImage)]) -> String {
        app.press(&["F9"]);
        app.wait_until_told("recorded: ");
        let told = app.told();
        let path = told.lines().find_map(|line| line.split_once("recorded: ")?.1.split_once(';')).unwrap().0;
        app.press(&["q"]);
        assert!(app.wait_for_end(QUIT_LIMIT).0.success());
        let show = fs::read_to_string(path).unwrap();
        for (time, picture) in pictures {
            let output = self.desktop.folder().join("still.png");
            let mut still = command_in(PROGRAM, self.desktop.folder(), None);
            still.arg("still").arg(&self.song).args(["--show", path, "--size", SIZE, "-o"]).arg(&output);
            output_of(still.args(["--at", &time.to_string()]), "mariana").unwrap();
            let found = image::open(&output).unwrap().to_rgba8();
            let apart = |(a, b): (&u8, &u8)| a.abs_diff(*b);
            let most = found.as_raw().iter().zip(picture.as_raw()).map(apart).max();
            assert!(found == *picture, "another picture at {time} s, by up to {most:?} of 255:\n{show}");
        }
        show
    }
}

#[test]
fn what_was_played_by_hand_is_rendered_again_bit_for_bit() {
    let place = Place::new();
    let sender = &place.sender;
    let mut app = place.open(&["--fade", "0"]);
    app.press(&["space"]);
    app.wait_for_title("paused", |title| title.contains("paused"));
    app.press(&["Left"; 3]);
    app.press(&["F9"]);
    let mut pictures = Vec::new();
    for number in 0..MOMENTS {
        let before = app.picture();
        match number % 5 {
            0 | 3 => sender.send("/param/red", &[0.05 + 0.04 * number as f32]),
            1 => sender.send("/param/width", &[0.6 + 0.13 * number as f32]),
            2 => {
                let (x, y) = (24 + number / 8, 13 + number / 9);
                let from = ["mousemove", "--window", app.window(), "30", "18", "mousedown", "1"];
                app.xdotool(&from);
                app.xdotool(&["mousemove", "--window", app.window(), &x.to_string(), &y.to_string()]);
                app.xdotool(&["mouseup", "1"]);
            }
            _ if number % 2 == 0 => sender.send("/scene/wool", &[]),
            _ => sender.send("/scene/wall", &[]),
        }
        let after = settled(&app, &before, &format!("hand {number}"));
        app.press(&["Right"]);
        settled(&app, &after, &format!("after {number}"));
        pictures.push((5.0 * number as f64, after));
    }
    place.compare(app, &pictures);
}

#[test]
fn fades_blackouts_and_held_pictures_are_rendered_again_bit_for_bit() {
    let place = Place::new();
    let mut app = place.open(&["--fade", "20", "--blackout-fade", "3"]);
    app.wait_until_told("first picture");
    // Several pictures tell that both scenes can be drawn.
    wait_until("a second of the song", || f64::from(place.progress()) * SECONDS > 1.0);
    app.press(&["F9"]);
    // A fade of the user's own begins while the song plays; both scenes go on in it.
    app.press(&["n"]);
    app.wait_until_told("a fade begins");
    app.press(&["space"]);
    app.wait_for_title("paused", |title| title.contains("paused"));
    let mut pictures: Vec<(f64, RgbaImage)> = Vec::new();
    let mut last = app.picture();
    for number in 2..=5 {
        let time = 3.75 * f64::from(number);
        place.go_to(time);
        let there = settled(&app, &last, &format!("{time} s"));
        place.sender.send("/param/red", &[0.15 * number as f32]);
        last = settled(&app, &there, &format!("a knob at {time} s"));
        pictures.push((time, last.clone()));
    }
    // Less light, while nothing else moves.
    place.go_to(26.25);
    let there = settled(&app, &last, "behind the fade");
    place.sender.send("/brightness", &[0.4]);
    let dim = settled(&app, &there, "less light");
    pictures.push((26.25, dim.clone()));
    place.go_to(27.5);
    let dim = settled(&app, &dim, "less light at another moment");
    place.sender.send("/brightness", &[1.0]);
    let there = settled(&app, &dim, "all light");
    // A picture is held while the song and a knob go on.
    place.go_to(30.0);
    let held = settled(&app, &there, "what will be held");
    place.freeze();
    place.sender.send("/param/width", &[3.0]);
    place.go_to(33.75);
    assert!(app.picture() == held);
    pictures.push((31.875, held.clone()));
    place.sender.send("/freeze", &[0.0]);
    let last = settled(&app, &held, "what is let go");
    pictures.push((33.75, last.clone()));
    // Another one fades while the song plays.
    place.go_to(45.0);
    let last = settled(&app, &last, "what will be held");
    place.freeze();
    place.sender.send("/pause", &[0.0]);
    place.sender.send("/freeze", &[0.0]);
    app.wait_until_told_times("a fade begins", 3);
    app.press(&["space"]);
    app.wait_for_title("paused", |title| title.contains("paused"));
    place.go_to(47.8125);
    let fades = settled(&app, &last, "a picture that was held, and what comes after it");
    pictures.push((47.8125, fades.clone()));
    place.go_to(52.5);
    let behind = settled(&app, &fades, "behind it");
    pictures.push((52.5, behind.clone()));
    place.go_to(56.25);
    settled(&app, &behind, "before the blackout");
    app.press(&["x"]);
    wait_until("black", || app.picture().pixels().all(|pixel| pixel.0[..3] == [0; 3]));
    pictures.push((56.25, app.picture()));
    let show = place.compare(app, &pictures);
    for part in ["fade over 20 s", "set picture freeze = ", "set picture brightness = "] {
        assert!(show.contains(part), "no `{part}` in\n{show}");
    }
}

#[test]
fn a_fade_that_another_change_cut_short_is_rendered_again_bit_for_bit() {
    let place = Place::new();
    let mut app = place.open(&["--fade", "30", "--blackout-fade", "5"]);
    app.wait_until_told("first picture");
    wait_until("a second of the song", || f64::from(place.progress()) * SECONDS > 1.0);
    app.press(&["F9"]);
    app.press(&["n"]);
    app.wait_until_told("a fade begins");
    place.rest(&mut app);
    place.go_to(7.5);
    let first = app.picture();
    place.sender.send("/param/red", &[0.6]);
    let mut last = settled(&app, &first, "the fade that will be cut short");
    let mut pictures = vec![(7.5, last.clone())];
    place.go_to(11.25);
    last = settled(&app, &last, "later in it");
    // Back to where it came from, long before it was there.
    place.fade_while_it_runs(&mut app, 2, |app| app.press(&["p"]));
    for time in [15.0, 22.5] {
        place.go_to(time);
        last = settled(&app, &last, &format!("{time} s"));
        pictures.push((time, last.clone()));
    }
    // A picture that is held cuts a fade short, too: behind it the scene that came is alone.
    place.freeze();
    place.sender.send("/param/width", &[3.0]);
    place.go_to(26.25);
    pictures.push((25.3125, last.clone()));
    place.fade_while_it_runs(&mut app, 3, |_| place.let_go());
    for time in [28.125, 37.5] {
        place.go_to(time);
        last = settled(&app, &last, &format!("{time} s"));
        pictures.push((time, last.clone()));
    }
    let show = place.compare(app, &pictures);
    assert!(show.matches("fade over 30 s unfinished").count() == 2, "{show}");
}

#[test]
fn a_picture_held_while_another_gives_way_is_rendered_again_bit_for_bit() {
    let place = Place::new();
    let mut app = place.open(&["--fade", "0", "--blackout-fade", "15"]);
    app.wait_until_told("first picture");
    app.press(&["F9"]);
    place.rest(&mut app);
    let mut last = app.picture();
    let mut pictures = Vec::new();
    for (number, time) in [15.0, 26.25, 37.5].into_iter().enumerate() {
        place.go_to(time);
        last = settled(&app, &last, "what will be held");
        pictures.push((time, last.clone()));
        place.freeze();
        place.sender.send("/param/width", &[1.0 + number as f32]);
        place.sender.send("/param/red", &[0.3 * number as f32]);
        place.go_to(time + 3.75);
        assert!(app.picture() == last, "the picture is held");
        pictures.push((time + 1.875, last.clone()));
        place.fade_while_it_runs(&mut app, number + 1, |_| place.let_go());
    }
    for time in [48.75, 60.0] {
        place.go_to(time);
        last = settled(&app, &last, &format!("{time} s"));
        pictures.push((time, last.clone()));
    }
    place.compare(app, &pictures);
}

#[test]
fn scenes_that_change_and_come_back_behind_a_held_picture_are_rendered_again_bit_for_bit() {
    let place = Place::new();
    let mut app = place.open(&["--fade", "10", "--blackout-fade", "5"]);
    app.wait_until_told("first picture");
    app.press(&["F9"]);
    place.rest(&mut app);
    let mut last = app.picture();
    let mut pictures = Vec::new();
    for (number, (time, keys)) in
        [(15.0, &["n"][..]), (30.0, &["p"]), (45.0, &["n", "p"])].into_iter().enumerate()
    {
        place.go_to(time);
        last = settled(&app, &last, "what will be held");
        pictures.push((time, last.clone()));
        place.freeze();
        for (key, scene) in keys.iter().zip(["wool", "wall"].iter().cycle().skip(number % 2)) {
            app.press(&[key]);
            app.wait_for_title(scene, |title| title.contains(scene));
        }
        place.sender.send("/param/width", &[1.5 + number as f32]);
        place.go_to(time + 3.75);
        assert!(app.picture() == last, "the picture is held");
        pictures.push((time + 1.875, last.clone()));
        place.fade_while_it_runs(&mut app, number + 1, |_| place.let_go());
        for behind in [6.5625, 11.25] {
            place.go_to(time + behind);
            last = settled(&app, &last, &format!("{} s", time + behind));
            pictures.push((time + behind, last.clone()));
        }
    }
    // Back in the song while a picture is held: it shows until it is let go.
    place.freeze();
    place.go_to(52.5);
    place.fade_while_it_runs(&mut app, 4, |_| place.let_go());
    place.go_to(60.0);
    last = settled(&app, &last, "behind what was held");
    pictures.retain(|(time, _)| *time < 52.5);
    pictures.push((60.0, last));
    place.compare(app, &pictures);
}

#[test]
fn what_a_show_does_to_a_scene_that_somebody_came_back_to_is_rendered_again_bit_for_bit() {
    let place = Place::new();
    let show = place.desktop.folder().join("led.show");
    let text = "at start wall.scene\n set width = 1 -> 4 over 60 s\n\
                at 20 s wool.scene camera aside cut\n set red = 0 -> 1 over 60 s\n set camera yaw = 0 -> 12 over 60 s\n\
                at 80 s wall.scene cut\n set width = 4 -> 1 over 30 s\n";
    fs::write(&show, text).unwrap();
    let mut app = place.open(&["--fade", "0", "--show", show.to_str().unwrap()]);
    app.wait_until_told("the scenes follow the song");
    app.press(&["F9"]);
    place.rest(&mut app);
    let mut last = app.picture();
    let mut pictures = Vec::new();
    let mut see = |app: &App<'_>, time: f64| {
        place.go_to(time);
        last = settled(app, &last, &format!("{time} s"));
        pictures.push((time, last.clone()));
    };
    see(&app, 15.0);
    see(&app, 26.25);
    place.go_to(28.125);
    app.press(&["k", "p"]);
    see(&app, 30.0);
    place.go_to(33.75);
    app.press(&["n"]);
    for time in [37.5, 45.0] {
        see(&app, time);
    }
    // The show goes on, and does nothing to this scene; then it has it on again.
    place.go_to(52.5);
    app.press(&["p"]);
    for time in [60.0, 82.5, 90.0] {
        see(&app, time);
    }
    place.compare(app, &pictures);
}
