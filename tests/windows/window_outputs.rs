//! The hands on a show (blackout, freeze, clean, scenes by number, corners), and where its picture goes besides the
//! window, as performers and their other programs meet them.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use crate::support::desktop::{App, Desktop};
use image::RgbaImage;
use mariana::srgb::linear;
use mariana_testing::process::{output_of, wait_until};

const QUIT_LIMIT: Duration = Duration::from_secs(60);

/// A wall that shines by itself and fills the picture.
fn wall(emission: &str) -> String {
    format!(
        "material paint {{ color = 0  roughness = 1  emission = {emission} }}\n\
         object wall {{ shape = 5 - p.z  material = paint }}\n\
         light none {{ direction = vec3(0, -1, 0)  color = 0 }}\n\
         camera {{ position = vec3(0)  target = vec3(0, 0, 5) }}\n\
         sky {{ color = 0  ambient = 0 }}\npicture {{ tone_map = none  bloom = 0 }}\n"
    )
}

/// It never moves, is red on the left and blue on the right.
const TWO_COLOURS: &str = "mix(vec3(0.5, 0.01, 0.01), vec3(0.01, 0.01, 0.5), step(0, p.x))";
/// It becomes brighter and darker, slowly enough to be no flash.
const BREATHES: &str = "vec3(0.3 + 0.2 * sin(2 * t))";

/// A folder with scenes on a desktop.
struct Place {
    desktop: Desktop,
}

impl Place {
    fn new(scenes: &[(&str, &str)]) -> Self {
        let desktop = Desktop::start();
        for (name, emission) in scenes {
            std::fs::write(desktop.folder().join(name), wall(emission)).unwrap();
        }
        Self { desktop }
    }

    /// The window with a scene and no words, when its first picture shows.
    fn open(&self, scene: &str, options: &[&str]) -> App<'_> {
        let scene = self.path(scene);
        let own =
            ["--silent", "-v", "--size", "320x180", "--quality", "best", "--scene", scene.to_str().unwrap()];
        let mut app = self.desktop.listen(&[&own[..], options].concat());
        app.wait_until_told("first picture after");
        app
    }

    fn path(&self, name: &str) -> PathBuf {
        self.desktop.folder().join(name)
    }
}

/// The colour of the window at a place, in shares of it.
fn at(picture: &RgbaImage, x: f32, y: f32) -> [u8; 3] {
    let place = |share: f32, side: u32| ((share * side as f32) as u32).min(side - 1);
    let [red, green, blue, _] = picture.get_pixel(place(x, picture.width()), place(y, picture.height())).0;
    [red, green, blue]
}

fn is_red([red, _, blue]: [u8; 3]) -> bool {
    red > 100 && blue < 60
}

fn is_blue([red, _, blue]: [u8; 3]) -> bool {
    blue > 100 && red < 60
}

fn is_black(color: [u8; 3]) -> bool {
    color == [0; 3]
}

/// Waits until the window looks as wanted.
fn wait_for(app: &App, what: &str, wanted: impl Fn(&RgbaImage) -> bool) -> RgbaImage {
    let mut found = None;
    wait_until(what, || {
        let picture = app.picture();
        let is_there = wanted(&picture);
        found = Some(picture);
        is_there
    });
    found.unwrap()
}

fn quit(app: App<'_>) -> String {
    app.press(&["q"]);
    let (status, told) = app.wait_for_end(QUIT_LIMIT);
    assert!(status.success(), "{status}: {told}");
    assert!(!told.contains("panicked"), "{told}");
    told
}

#[test]
fn a_blackout_takes_the_light_away_and_brings_the_same_picture_back() {
    let place = Place::new(&[("two.scene", TWO_COLOURS)]);
    let app = place.open("two.scene", &["--blackout-fade", "0.4"]);
    let lit = wait_for(&app, "the picture", |picture| is_red(at(picture, 0.2, 0.5)));
    app.press(&["x"]);
    wait_for(&app, "black", |picture| picture.pixels().all(|pixel| pixel.0[..3] == [0; 3]));
    app.press(&["x"]);
    wait_for(&app, "the same picture", |picture| *picture == lit);
    quit(app);
    // A quarter of the light, by a flag.
    let app = place.open("two.scene", &["--brightness", "25"]);
    let value = |picture: &RgbaImage| linear(f32::from(at(picture, 0.2, 0.5)[0]) / 255.0);
    wait_for(&app, "a quarter of the light", |picture| (value(picture) / value(&lit) - 0.25).abs() < 0.02);
    quit(app);
}

#[test]
fn a_picture_that_is_held_stands_while_the_song_goes_on() {
    let place = Place::new(&[("breathes.scene", BREATHES), ("two.scene", TWO_COLOURS)]);
    let mut app = place.open("breathes.scene", &["--blackout-fade", "0"]);
    let first = app.picture();
    wait_for(&app, "a picture that moves", |picture| *picture != first);
    app.press(&["z"]);
    let mut held = app.picture();
    wait_until("a picture that stands", || {
        std::thread::sleep(Duration::from_millis(300));
        let now = app.picture();
        std::mem::replace(&mut held, now.clone()) == now
    });
    // The show may prepare: another scene comes on behind it, and shows when the picture is let go.
    app.press(&["2"]);
    app.wait_for_title("the other scene", |title| title.contains("two"));
    assert!(app.picture() == held, "the picture that is held has changed");
    app.press(&["z"]);
    wait_for(&app, "the other scene", |picture| {
        is_red(at(picture, 0.2, 0.5)) && is_blue(at(picture, 0.8, 0.5))
    });
    quit(app);
}

#[test]
fn numbers_show_the_scenes_of_the_list() {
    let place = Place::new(&[("a.scene", "vec3(0.1)"), ("b.scene", "vec3(0.2)"), ("c.scene", TWO_COLOURS)]);
    let mut app = place.open("a.scene", &[]);
    for (key, name) in [("3", "(c,"), ("2", "(b,"), ("1", "(a,")] {
        app.press(&[key]);
        app.wait_for_title(name, |title| title.contains(name));
    }
    // There is no ninth.
    app.press(&["9", "3"]);
    app.wait_for_title("c", |title| title.contains("(c,"));
    quit(app);
}

#[test]
fn one_key_hides_every_word_and_panel() {
    let place = Place::new(&[("two.scene", TWO_COLOURS)]);
    let app = place.open("two.scene", &["--flash-limiter", "off"]);
    let plain = wait_for(&app, "the picture", |picture| is_blue(at(picture, 0.8, 0.5)));
    app.press(&["h"]);
    wait_for(&app, "the keys", |picture| *picture != plain);
    app.press(&["w"]);
    wait_for(&app, "nothing but the picture", |picture| *picture == plain);
    // Nor does a mistake show, until the key is pressed again.
    let good = std::fs::read_to_string(place.path("two.scene")).unwrap();
    std::fs::write(place.path("two.scene"), "object o { shape = nonsense }").unwrap();
    let mut app = app;
    app.wait_until_told("has mistakes");
    assert!(app.picture() == plain, "the mistake shows");
    app.press(&["w"]);
    wait_for(&app, "the mistake", |picture| *picture != plain);
    std::fs::write(place.path("two.scene"), good).unwrap();
    wait_for(&app, "the picture", |picture| *picture == plain);
    quit(app);
}

#[test]
fn the_picture_is_mirrored_cropped_and_pulled_at_its_corners() {
    let place = Place::new(&[("two.scene", TWO_COLOURS)]);
    let app = place.open("two.scene", &["--flip", "horizontal", "--crop", "0,0,25,0"]);
    // Blue is at the left now, and takes a third.
    wait_for(&app, "the mirrored picture", |picture| {
        is_blue(at(picture, 0.3, 0.5)) && is_red(at(picture, 0.36, 0.5)) && is_red(at(picture, 0.95, 0.5))
    });
    quit(app);
    let app = place.open("two.scene", &["--corners", "0,0,100,50,100,100,0,100"]);
    wait_for(&app, "the slanted picture", |picture| {
        is_black(at(picture, 0.9, 0.1)) && is_red(at(picture, 0.2, 0.5)) && is_blue(at(picture, 0.9, 0.8))
    });
    quit(app);
    // By hand, and remembered.
    let app = place.open("two.scene", &[]);
    wait_for(&app, "the picture", |picture| is_red(at(picture, 0.1, 0.1)));
    app.press(&["y"]);
    wait_for(&app, "what says how", |picture| !is_red(at(picture, 0.4, 0.5)));
    let window = app.window().to_owned();
    let move_to = |x: u32, y: u32| {
        app.xdotool(&["mousemove", "--window", &window, &x.to_string(), &y.to_string()]);
        std::thread::sleep(Duration::from_millis(200));
    };
    move_to(10, 10);
    wait_for(&app, "the corner under the pointer", |picture| at(picture, 0.02, 0.02)[2] > 150);
    app.xdotool(&["mousedown", "1"]);
    // A press and the way from there must not come in one picture.
    move_to(10, 10);
    (1..=4).for_each(|step| move_to(10 + 30 * step, 10 + 10 * step));
    app.xdotool(&["mouseup", "1"]);
    wait_for(&app, "the corner", |picture| is_black(at(picture, 0.1, 0.05)) && is_red(at(picture, 0.1, 0.9)));
    app.press(&["y"]);
    quit(app);
    let app = place.open("two.scene", &[]);
    wait_for(&app, "the corner", |picture| is_black(at(picture, 0.1, 0.05)));
    app.press(&["y", "Home", "y"]);
    wait_for(&app, "the picture", |picture| is_red(at(picture, 0.02, 0.02)));
    quit(app);
}

fn make_fifo(path: &Path) {
    output_of(Command::new("mkfifo").arg(path), "coreutils").unwrap();
}

/// Reads the header of a stream and gives it.
fn header(stream: &mut impl BufRead) -> String {
    let mut line = Vec::new();
    stream.read_until(b'\n', &mut line).unwrap();
    String::from_utf8(line).unwrap()
}

/// Reads a picture of a stream and gives the light of its left and its right.
fn light_of_next(stream: &mut impl BufRead, (width, height): (usize, usize)) -> [u8; 2] {
    assert_eq!(header(stream), "FRAME\n");
    let mut bytes = vec![0; width * height * 3 / 2];
    stream.read_exact(&mut bytes).unwrap();
    let row = &bytes[height / 2 * width..];
    [row[width / 4], row[3 * width / 4]]
}

#[test]
fn a_fifo_gets_pictures_whoever_reads_it_and_however_slowly() {
    let place = Place::new(&[("two.scene", TWO_COLOURS)]);
    let fifo = place.path("pictures");
    make_fifo(&fifo);
    let to = format!("y4m:{}", fifo.display());
    let mut app = place.open("two.scene", &["--send", &to, "--send-size", "161x90", "--send-fps", "25"]);
    let mut gone = 0;
    let mut read = |app: &App, count: usize| {
        let mut stream = BufReader::new(File::open(&fifo).unwrap());
        let told = header(&mut stream);
        assert!(told.starts_with("YUV4MPEG2 W160 H90 F25:1 ") && told.contains("C420"), "{told}");
        let pictures = (0..count).map(|_| light_of_next(&mut stream, (160, 90))).collect::<Vec<_>>();
        drop(stream);
        // Whoever opens it sooner is taken for the same reader, in the middle of the stream.
        gone += 1;
        wait_until("the reader's going", || {
            app.told().matches("has gone: the next one gets").count() == gone
        });
        pictures
    };
    // Of red more light is seen than of blue.
    let wanted = |pictures: Vec<[u8; 2]>| pictures.iter().all(|[left, right]| left > right && *right > 16);
    assert!(wanted(read(&app, 30)));
    // Another one, and what it is sent is what shows: a blackout.
    app.press(&["x"]);
    wait_for(&app, "black", |picture| is_black(at(picture, 0.5, 0.5)));
    wait_until("black pictures", || read(&app, 3).last() == Some(&[16, 16]));
    app.press(&["x"]);
    wait_until("light", || wanted(read(&app, 2)));
    // One that opens it and reads nothing holds nobody up.
    let blocks = OpenOptions::new().read(true).open(&fifo).unwrap();
    app.wait_until_told("takes no pictures: the show goes on without it");
    app.press(&["x"]);
    wait_for(&app, "black", |picture| is_black(at(picture, 0.5, 0.5)));
    drop(blocks);
    // ffprobe knows what it is.
    let mut probe = Command::new("ffprobe");
    probe.args(["-v", "error", "-f", "yuv4mpegpipe", "-read_intervals", "%+#2", "-show_entries"]);
    probe.args(["stream=width,height,r_frame_rate,pix_fmt", "-of", "csv=p=0"]).arg(&fifo);
    let told = String::from_utf8(output_of(&mut probe, "ffmpeg").unwrap()).unwrap();
    assert_eq!(told.trim(), "160,90,yuv420p,25/1");
    let blocks = OpenOptions::new().read(true).open(&fifo).unwrap();
    // A receiver that blocks does not hold the end up either.
    let told = quit(app);
    drop(blocks);
    assert_eq!(told.matches("takes no pictures").count(), 1, "{told}");
}

#[test]
fn standard_output_gets_pictures_until_it_is_closed() {
    let place = Place::new(&[("two.scene", TWO_COLOURS)]);
    let fifo = place.path("out");
    make_fifo(&fifo);
    // So that neither end waits for the other.
    let both = OpenOptions::new().read(true).write(true).open(&fifo).unwrap();
    let out = OpenOptions::new().write(true).open(&fifo).unwrap();
    let scene = place.path("two.scene");
    let options = ["--silent", "--size", "160x90", "--scene", scene.to_str().unwrap(), "--send", "y4m:-"];
    let mut app = place.desktop.listen_printing_to(out.into(), &options);
    let mut stream = BufReader::new(both);
    assert!(header(&mut stream).starts_with("YUV4MPEG2 W160 H90 F30:1 "));
    let [left, right] = light_of_next(&mut stream, (160, 90));
    assert!(left > right);
    drop(stream);
    app.wait_until_told("whoever read standard output has gone");
    wait_for(&app, "the show", |picture| is_red(at(picture, 0.2, 0.5)));
    quit(app);
}

#[test]
fn a_client_on_this_machine_gets_jpegs() {
    let place = Place::new(&[("two.scene", TWO_COLOURS)]);
    let port = 41_000 + (std::process::id() % 20_000) as u16;
    let app = place.open("two.scene", &["--send", &format!("mjpeg:{port}"), "--send-size", "160x90"]);
    let mut stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
    stream.write_all(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n").unwrap();
    let mut lines = BufReader::new(stream);
    let mut next = || {
        let length: usize = loop {
            let line = header(&mut lines);
            if let Some(length) = line.strip_prefix("Content-Length: ") {
                break length.trim().parse().unwrap();
            }
        };
        assert_eq!(header(&mut lines), "\r\n");
        let mut jpeg = vec![0; length];
        lines.read_exact(&mut jpeg).unwrap();
        image::load_from_memory(&jpeg).unwrap().to_rgba8()
    };
    let seen = next();
    assert_eq!(seen.dimensions(), (160, 90));
    assert!(is_red(at(&seen, 0.2, 0.5)) && is_blue(at(&seen, 0.8, 0.5)));
    app.press(&["x"]);
    wait_until("a black picture", || at(&next(), 0.5, 0.5).iter().all(|value| *value < 3));
    quit(app);
}
