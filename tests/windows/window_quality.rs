//! How good the picture in a window is: as the frame rate allows, or as it was asked for.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::support::compare::{LOOSE, difference};
use crate::support::desktop::{App, Desktop, PROGRAM, command_in};
use crate::support::pings::{Pinger, Pings};
use image::RgbaImage;
use mariana_testing::process::{output_of, wait_until};
use mariana_testing::wave::write_wav;

/// What the log says when fewer pixels are drawn.
const FEWER: &str = "of the window's width and height are drawn";

/// Takes a processor long for each pixel, and moves.
const HEAVY: &str = "object balls {
         shape = smooth_union(for i in 0..12:
             sphere(p - 2 * vec3(sin(2.4 * i + 0.1 * t), sin(1.7 * i), sin(3.1 * i)), 0.4), 0.2)
     }
     light sun { direction = vec3(1, -2, 1) }
     camera { position = vec3(0, 1, -7)  target = vec3(0) }";

/// Smooth, the same at all times, different at every corner.
const SMOOTH: &str = "material paint { color = 0  roughness = 1\n\
     emission = 0.3 + 0.2 * vec3(sin(1.1 * p.x + 0.4), sin(0.9 * p.y - 0.5 * p.x), cos(0.7 * p.x + 1.3 * p.y)) }\n\
     object wall { shape = 5 - p.z  material = paint }\n\
     light none { direction = vec3(0, -1, 0)  color = 0 }\n\
     camera { position = vec3(0)  target = vec3(0, 0, 5) }\n\
     sky { color = 0  ambient = 0 }\n";

/// So many pictures of [`HEAVY`] tell that it is too much.
const PICTURES: usize = 20;

struct Place {
    desktop: Desktop,
    song: PathBuf,
    scene: PathBuf,
}

impl Place {
    fn new(scene: &str, seconds: usize) -> Self {
        let desktop = Desktop::start();
        let (song, path) = (desktop.folder().join("quiet.wav"), desktop.folder().join("own.scene"));
        write_wav(&song, 8_000, 2, std::iter::repeat_n(0.0, 2 * 8_000 * seconds));
        std::fs::write(&path, scene).unwrap();
        Self { desktop, song, scene: path }
    }

    /// The picture without a window.
    fn still(&self, size: (u32, u32)) -> RgbaImage {
        let output = self.desktop.folder().join("still.png");
        let mut command = command_in(PROGRAM, self.desktop.folder(), None);
        command.arg("still").arg(&self.song).arg("--scene").arg(&self.scene).arg("-o").arg(&output);
        command.args(["--size", &format!("{}x{}", size.0, size.1)]);
        output_of(&mut command, "mariana").unwrap_or_else(|error| panic!("{error}"));
        image::open(&output).unwrap().to_rgba8()
    }

    fn open(&self, size: &str, options: &[&str]) -> App<'_> {
        self.open_with(&[], size, options)
    }

    /// The same with more variables in the program's environment.
    fn open_with(&self, variables: &[(&str, &str)], size: &str, options: &[&str]) -> App<'_> {
        let scene = self.scene.to_str().unwrap();
        let all = [&["-v", "--silent", "--size", size, "--scene", scene], options].concat();
        let mut app = self.desktop.open_with(variables, &self.song, &all);
        app.wait_for_title("a scene", |title| title.contains(" - Mariana ("));
        app
    }
}

#[test]
fn a_scene_that_is_too_much_is_drawn_with_fewer_pixels_and_best_is_not() {
    let place = Place::new(HEAVY, 60);
    let mut app = place.open("640x480", &["--sdf", "compiled"]);
    app.wait_until_told(FEWER);
    drop(app);
    let app = place.open("640x480", &["--sdf", "compiled", "--quality", "best"]);
    for _ in 0..PICTURES {
        let picture = app.picture();
        wait_until("another picture", || app.picture() != picture);
    }
    let told = app.told();
    assert!(!told.contains(FEWER), "{told}");
}

#[test]
fn an_edit_is_interpreted_with_fewer_samples_until_the_text_rests_and_compiled_with_all() {
    let ball = |radius: f64| {
        format!(
            "object ball {{ shape = sphere(p - vec3(sin(t), 0, 0), {radius}) }}\n\
             light sun {{ direction = vec3(1, -2, 1) }}\n\
             camera {{ position = vec3(0, 1, -7)  target = vec3(0) }}"
        )
    };
    let (fewer, all) = ("2 further samples at edges", "4 further samples at edges");
    for (mode, saves) in [("interpreted", true), ("compiled", false)] {
        let place = Place::new(&ball(1.0), 60);
        let mut app = place.open("160x90", &["-v", "--sdf", mode]);
        let opened = app.told();
        assert!(!opened.contains(fewer), "opening is no edit: {opened}");
        std::fs::write(&place.scene, ball(1.5)).unwrap();
        let shown = format!("is shown, {mode}");
        wait_until("the edit", || app.told().matches(&shown).count() == 2);
        if saves {
            app.wait_until_told(fewer);
            app.wait_until_told(all);
            let told = app.told();
            let (fewer, all) = (told.find(fewer), told.rfind(all));
            assert!(fewer < all, "{told}");
        } else {
            for _ in 0..PICTURES {
                let picture = app.picture();
                wait_until("another picture", || app.picture() != picture);
            }
            assert!(!app.told().contains(fewer), "{}", app.told());
        }
    }
}

#[test]
fn fewer_pixels_show_the_same_picture() {
    let place = Place::new(SMOOTH, 60);
    for quality in ["low", "medium"] {
        for size in ["320x180", "790x60", "1x1"] {
            let mut app = place.open(size, &["--quality", quality]);
            app.press(&["space"]);
            app.wait_for_title("paused", |title| title.contains("paused"));
            let wanted = place.still(app.size());
            wait_until("the picture of the still", || alike(&app.picture(), &wanted));
        }
    }
}

fn alike(seen: &RgbaImage, wanted: &RgbaImage) -> bool {
    let found = difference(seen, wanted, LOOSE.visible);
    found.mean <= LOOSE.mean_max && found.share <= LOOSE.share_max
}

/// Spheres that flow together, so many that no tree of them is built in any time worth waiting for.
fn foam(count: usize) -> String {
    format!(
        "object foam {{ shape = smooth_union(for i in 0..{count}: sphere(p - vec3(3 * sin(i * 12.9898), \
         2 + 2 * sin(i * 78.233), 3 * sin(i * 37.719)), 0.25 + 0.1 * sin(t + i)), 0.2) }}"
    )
}

#[test]
fn a_scene_that_took_minutes_for_a_picture_kept_the_window_and_the_last_good_scene() {
    let place = Place::new("object ball { shape = sphere(p - vec3(0, 1, 0), 0.7 + 0.1 * sin(3 * t)) }", 200);
    std::fs::write(place.desktop.folder().join("p_foam.scene"), foam(1_500)).unwrap();
    let mut app = place.open("160x90", &[]);
    let pings = Pings::start(place.desktop.display(), app.window().parse().unwrap());
    app.press(&["n"]);
    let begun = Instant::now();
    while !app.told().contains("p_foam is too much for this machine; the last good scene stays") {
        assert!(begun.elapsed() < Duration::from_secs(150), "it was not refused: {}", app.told());
        assert!(app.runs(), "{}", app.told());
        // All the while what was shown moves.
        let picture = app.picture();
        wait_until("another picture", || app.picture() != picture);
    }
    let told = app.told();
    assert!(told.contains("clauses") && told.contains("use fewer or simpler parts"), "{told}");
    app.press(&["space"]);
    app.wait_for_title("the scene before, paused", |title| title.contains("own") && title.contains("paused"));
    let answers = pings.stop();
    assert!(answers.count > 0 && answers.worst < Duration::from_secs(10), "{answers:?}");
}

/// How often a ping arrives together with the reply that the last frame waits for.
const STOPS: usize = 12;
/// A show that stands still for 0.4 s is drawn once more. Longer than that.
const LAST_FRAME: Duration = Duration::from_millis(700);

#[test]
fn pings_lay_unread_while_the_picture_stood_still() {
    let place = Place::new("object ball { shape = sphere(p - vec3(0, 1, 0), 0.7 + 0.1 * sin(3 * t)) }", 200);
    let mut app = place.open("160x90", &[]);
    let mut pinger = Pinger::connect(place.desktop.display(), app.window().parse().unwrap());
    for stop in 0..STOPS {
        app.press(&["space"]);
        app.wait_for_title("paused", |title| title.contains("paused"));
        // The last frame waits for the X server, whose reply comes in one piece with the ping.
        place.desktop.halt_server(true);
        drop(pinger.send());
        std::thread::sleep(LAST_FRAME);
        place.desktop.halt_server(false);
        let asked = Instant::now();
        assert!(pinger.wait(|| asked.elapsed() > Duration::from_secs(2)), "stop {stop}: no answer");
        app.press(&["space"]);
        app.wait_for_title("playing", |title| !title.contains("paused"));
    }
}

#[test]
fn a_context_that_was_lost_ended_the_show() {
    let place = Place::new(SMOOTH, 200);
    let mut app = place.open_with(&[("MARIANA_FAULT", "context-lost@2")], "160x90", &["--sdf", "compiled"]);
    app.press(&["space"]);
    app.wait_for_title("paused", |title| title.contains("paused"));
    let before = app.picture();
    // A show that stands still asks the driver for nothing.
    let begun = Instant::now();
    while !app.told().contains("the driver has lost its context") {
        app.press(&["i", "i"]);
        std::thread::sleep(Duration::from_millis(100));
        assert!(app.runs() && begun.elapsed() < Duration::from_secs(30), "{}", app.told());
    }
    app.wait_for_title("the same scene, still paused", |title| title.contains("own, compiled, paused"));
    // Its notice fades.
    wait_until("the same picture", || {
        difference(&app.picture(), &before, LOOSE.visible).share <= LOOSE.share_max
    });
    app.press(&["q"]);
    let (status, told) = app.wait_for_end(Duration::from_secs(60));
    assert!(status.success(), "{status}: {told}");
}

#[test]
fn a_driver_without_room_for_a_picture_ended_the_show() {
    let place = Place::new(SMOOTH, 200);
    let mut app = place.open_with(&[("MARIANA_FAULT", "no-target@2")], "160x90", &["--sdf", "compiled"]);
    let answered = Instant::now();
    // Targets are made when the size changes.
    while !app.told().contains("could not make a render target") {
        for size in [["170", "100"], ["160", "90"]] {
            app.xdotool(&[&["windowsize", app.window()], &size[..]].concat());
            std::thread::sleep(Duration::from_millis(200));
        }
        assert!(app.runs() && answered.elapsed() < Duration::from_secs(30), "{}", app.told());
    }
    wait_until("a picture", || app.picture().pixels().any(|pixel| pixel.0[..3] != [0; 3]));
    app.press(&["q"]);
    let (status, told) = app.wait_for_end(Duration::from_secs(60));
    assert!(status.success(), "{status}: {told}");
}
