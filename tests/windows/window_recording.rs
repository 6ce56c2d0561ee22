//! What hands do in a window, recorded and rendered again.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::PathBuf;
use std::time::Duration;

use crate::support::desktop::{App, Desktop, PROGRAM, command_in};
use crate::window_hands::Sender;
use image::RgbaImage;
use mariana_testing::process::{output_of, wait_until};
use mariana_testing::wave::write_wav;

const SIZE: &str = "64x36";
const MOMENTS: usize = 20;
const QUIT_LIMIT: Duration = Duration::from_secs(60);

/// A wall that fills the picture, wherever the camera turns a little, and whose light shows where it looks: so softly that
/// nothing in it is an edge, of which stills take more samples.
const WALL: &str = "param red = 0.2 in 0 .. 1\nparam width = 1 in 0.5 .. 4\n\
    material paint { color = 0  roughness = 1  emission = vec3(red, 0.5 + 0.2 * sin(0.2 * width * p.x), 0.5 + 0.2 * sin(0.2 * p.y + t)) }\n\
    object wall { shape = 5 - p.z  material = paint }\nlight none { direction = vec3(0, -1, 0)  color = 0 }\n\
    camera { position = vec3(0)  target = vec3(0, 0, 5) }\nsky { color = 0  ambient = 0 }\n";

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

#[test]
fn what_was_played_by_hand_is_rendered_again_bit_for_bit() {
    let desktop = Desktop::start();
    let song = desktop.folder().join("song.wav");
    write_wav(&song, 8_000, 2, std::iter::repeat_n(0.0, 2 * 8_000 * 120));
    for (name, text) in [("wall", WALL.to_owned()), ("wool", WALL.replace("vec3(red", "vec3(1 - red"))] {
        fs::write(desktop.folder().join(format!("{name}.scene")), text).unwrap();
    }
    let scene = desktop.folder().join("wall.scene");
    let sender = Sender::new();
    let port = sender.port.to_string();
    let options =
        ["--silent", "-v", "--size", SIZE, "--fade", "0", "--osc", &port, "--scene", scene.to_str().unwrap()];
    let mut app = desktop.open(&song, &options);
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
        pictures.push(after);
    }
    app.press(&["F9"]);
    app.wait_until_told("recorded: ");
    let told = app.told();
    let path = told.lines().find_map(|line| line.split_once("recorded: ")?.1.split_once(';')).unwrap().0;
    let path = PathBuf::from(path);
    app.press(&["q"]);
    assert!(app.wait_for_end(QUIT_LIMIT).0.success());
    let show = fs::read_to_string(&path).unwrap();
    for (number, picture) in pictures.iter().enumerate() {
        let output = desktop.folder().join("still.png");
        let mut still = command_in(PROGRAM, desktop.folder(), None);
        still.arg("still").arg(&song).arg("--show").arg(&path).args(["--size", SIZE, "-o"]).arg(&output);
        output_of(still.args(["--at", &(5 * number).to_string()]), "mariana").unwrap();
        let found = image::open(&output).unwrap().to_rgba8();
        assert!(found == *picture, "another picture at {} s:\n{show}", 5 * number);
    }
}
