//! Render quality: adapted to the frame rate, or as the user sets it.

use crate::support::apart::apart;
use std::path::PathBuf;

use crate::support::compare::{LOOSE, difference};
use crate::support::desktop::{PROGRAM, command_in};
use crate::support::session::{self, App};
use crate::support::walls::{ripples, wait_for_refusal};
use image::RgbaImage;
use mariana_testing::process::output_of;

fn tells_fewer(reported: &str) -> bool {
    let mut fractions = reported.lines().filter_map(|line| {
        let (before, _) = line.split_once(" of the window's width and height")?;
        before.rsplit(' ').next()?.parse::<f64>().ok()
    });
    fractions.any(|fraction| fraction < 1.0)
}

/// A moving scene that needs much processor time per pixel.
const HEAVY: &str = "object balls {
         shape = smooth_union(for i in 0..12:
             sphere(p - 2 * vec3(sin(2.4 * i + 0.1 * t), sin(1.7 * i), sin(3.1 * i)), 0.4), 0.2)
     }
     light sun { direction = vec3(1, -2, 1) }
     camera { position = vec3(0, 1, -7)  target = vec3(0) }";

const SMOOTH: &str = "material paint { color = 0  roughness = 1\n\
     emission = 0.3 + 0.2 * vec3(sin(1.1 * p.x + 0.4), sin(0.9 * p.y - 0.5 * p.x), cos(0.7 * p.x + 1.3 * p.y)) }\n\
     object wall { shape = 5 - p.z  material = paint }\n\
     light none { direction = vec3(0, -1, 0)  color = 0 }\n\
     camera { position = vec3(0)  target = vec3(0, 0, 5) }\n\
     sky { color = 0  ambient = 0 }\n";

/// The session reduces the resolution of [`HEAVY`] after this number of frames.
const PICTURES: usize = 20;

struct Place {
    inner: session::Place,
    song: PathBuf,
    scene: PathBuf,
}

impl Place {
    fn new(scene: &str, seconds: usize) -> Self {
        let inner = session::Place::new();
        let song = inner.quiet_song("quiet.wav", seconds);
        let scene = inner.save("own.scene", scene);
        Self { inner, song, scene }
    }

    /// Renders the session's image with `mariana still`.
    fn still(&self, size: (u32, u32)) -> RgbaImage {
        let output = self.inner.path("still.png");
        let mut command = command_in(PROGRAM, self.inner.folder(), None);
        command.arg("still").arg(&self.song).arg("--scene").arg(&self.scene).arg("-o").arg(&output);
        command.args(["--size", &format!("{}x{}", size.0, size.1)]);
        output_of(&mut command, "mariana").unwrap_or_else(|error| panic!("{error}"));
        image::open(&output).unwrap().to_rgba8()
    }

    fn open(&self, size: &str, options: &[&str]) -> App {
        let own = ["--size", size, "--scene", self.scene.to_str().unwrap()];
        let app = self.inner.open(&self.song, &[&own[..], options].concat());
        app.wait_for_title("a scene", |title| title.contains(" - Mariana ("));
        app
    }
}

#[test]
fn a_slow_scene_is_drawn_with_fewer_pixels_except_with_best() {
    apart!();
    let place = Place::new(HEAVY, 60);
    let app = place.open("640x480", &["--sdf", "compiled"]);
    app.wait_until("fewer pixels", |app| tells_fewer(&app.reported()));
    drop(app);
    let app = place.open("640x480", &["--sdf", "compiled", "--quality", "best"]);
    for _ in 0..PICTURES {
        let picture = app.picture();
        app.wait_until("another picture", |app| app.picture() != picture);
    }
    let reported = app.reported();
    assert!(!tells_fewer(&reported), "{reported}");
}

#[test]
fn fewer_pixels_show_the_same_image() {
    apart!();
    let place = Place::new(SMOOTH, 60);
    for quality in ["low", "medium"] {
        for (width, height) in [(320, 180), (790, 60), (1, 1)] {
            let app = place.open(&format!("{width}x{height}"), &["--quality", quality]);
            app.press(&["space"]);
            app.wait_for_title("paused", |title| title.contains("paused"));
            let wanted = place.still((width, height));
            app.wait_until("the same image as the still", |app| alike(&app.picture(), &wanted));
        }
    }
}

fn alike(seen: &RgbaImage, wanted: &RgbaImage) -> bool {
    let found = difference(seen, wanted, LOOSE.visible);
    found.mean <= LOOSE.mean_max && found.fraction <= LOOSE.fraction_max
}

#[test]
fn the_last_good_scene_stays_when_a_scene_takes_minutes() {
    apart!("MARIANA_FAULT" = "little-patience@0");
    let place = Place::new("object ball { shape = sphere(p - vec3(0, 1, 0), 0.7 + 0.1 * sin(3 * t)) }", 200);
    place.inner.save("p_foam.scene", &ripples());
    let app = place.open("160x90", &[]);
    app.press(&["n"]);
    wait_for_refusal(
        || app.reported(),
        || {
            assert!(app.runs(), "{}", app.reported());
            let picture = app.picture();
            app.wait_until("another picture", |app| app.picture() != picture);
        },
    );
    let reported = app.reported();
    assert!(reported.contains("clauses") && reported.contains("use fewer or simpler parts"), "{reported}");
    app.press(&["space"]);
    app.wait_for_title("the previous scene, paused", |title| {
        title.contains("own") && title.contains("paused")
    });
}

#[test]
fn a_lost_context_is_replaced() {
    apart!("MARIANA_FAULT" = "context-lost@2");
    replace_the_context();
}

#[test]
fn a_context_whose_textures_were_lost_in_a_suspension_is_replaced() {
    apart!("MARIANA_FAULT" = "memory-purged@2");
    replace_the_context();
}

fn replace_the_context() {
    let place = Place::new(SMOOTH, 200);
    let app = place.open("160x90", &["--sdf", "compiled"]);
    app.press(&["space"]);
    app.wait_for_title("paused", |title| title.contains("paused"));
    let before = app.picture();
    // A paused show does not call the driver. These keys cause new frames.
    app.wait_until("the loss", |app| {
        app.press(&["i", "i"]);
        app.reported().contains("the driver has lost its context")
    });
    app.wait_for_title("the same scene, still paused", |title| title.contains("own, compiled, paused"));
    // A notice covers the frame until it fades out.
    app.wait_for("the same frame", |picture| {
        difference(picture, &before, LOOSE.visible).fraction <= LOOSE.fraction_max
    });
    app.quit_by_key();
}

#[test]
fn a_failed_render_target_does_not_end_the_session() {
    apart!("MARIANA_FAULT" = "no-target@2");
    let place = Place::new(SMOOTH, 200);
    let app = place.open("160x90", &["--sdf", "compiled"]);
    // A new size makes the session create render targets.
    app.wait_until("the refusal", |app| {
        [(170, 100), (160, 90)].into_iter().for_each(|size| app.resize(size));
        app.reported().contains("could not make a render target")
    });
    app.wait_for("a picture", |picture| picture.pixels().any(|pixel| pixel.0[..3] != [0; 3]));
    app.quit_by_key();
}
