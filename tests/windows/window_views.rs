//! Views and the camera by hand, in a window.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::time::Duration;

use crate::support::compare::{TIGHT, difference};
use crate::support::desktop::{App, Desktop};
use image::RgbaImage;
use mariana::view::VIEWS;
use mariana_testing::process::wait_until;
use mariana_testing::wave::write_wav;

const SIZE: &str = "320x180";

/// A paused window at the start of a silent song, and its picture.
fn paused<'d>(desktop: &'d Desktop, options: &[&str]) -> (App<'d>, RgbaImage) {
    let song = desktop.folder().join("quiet.wav");
    write_wav(&song, 48_000, 2, (0..48_000 * 40).map(|_| 0.0));
    let mut app =
        desktop.open(&song, &[&["--silent", "--size", SIZE, "--sdf", "compiled"], options].concat());
    app.press(&["space"]);
    app.wait_for_title("paused", |title| title.contains("paused"));
    app.press(&["Left", "Left", "Left", "Left"]);
    // As good as can be, as a picture is drawn that stands for a while.
    let is_view = options.contains(&"--view");
    let mut last = if is_view { app.picture() } else { app.wait_for_moment(0.0) };
    wait_until("a picture that stands", || {
        std::thread::sleep(Duration::from_millis(400));
        let now = app.picture();
        let stands = now == last;
        last = now;
        stands
    });
    (app, last)
}

fn share(a: &RgbaImage, b: &RgbaImage) -> f64 {
    difference(a, b, TIGHT.visible).share
}

/// Whether this is the picture, but darker.
fn is_dimmed(now: &RgbaImage, picture: &RgbaImage) -> bool {
    let light = |image: &RgbaImage| image.as_raw().iter().map(|byte| f64::from(*byte)).sum::<f64>();
    let bytes = || now.as_raw().iter().zip(picture.as_raw());
    let brighter = bytes().filter(|(now, byte)| **now > byte.saturating_add(8)).count();
    (brighter as f64) < 0.02 * picture.as_raw().len() as f64 && light(now) < 0.98 * light(picture)
}

/// Drags with the left button from the middle.
fn drag(app: &App, (right, down): (i32, i32)) {
    let (x, y) = (160, 90);
    let place = |x: i32, y: i32| {
        app.xdotool(&["mousemove", "--window", app.window(), &x.to_string(), &y.to_string()])
    };
    place(x, y);
    app.xdotool(&["mousedown", "1"]);
    for step in 1..=4 {
        place(x + right * step / 4, y + down * step / 4);
    }
    app.xdotool(&["mouseup", "1"]);
}

#[test]
fn the_key_goes_through_the_views_and_the_title_tells_which() {
    let desktop = Desktop::start();
    // Without cells, which some drawings wait for and others do not: the picture is the same bit for bit.
    let (mut app, picture) = paused(&desktop, &["--regions", "off"]);
    for row in &VIEWS {
        app.press(&["v"]);
        app.wait_for_title(row.name, |title| title.contains(&format!("view {}", row.name)));
        wait_until("the view", || share(&app.picture(), &picture) > 0.3);
    }
    app.press(&["shift+v"]);
    app.wait_for_title("the view before", |title| title.contains("view materials"));
    app.press(&["v", "v"]);
    app.wait_for_title("no view", |title| !title.contains("view"));
    wait_until("the picture again", || app.picture() == picture);
    // Numbers go up and down.
    app.press(&["v", "v", "v"]);
    app.wait_for_title("normals", |title| title.contains("view normals"));
    wait_until("normals", || share(&app.picture(), &picture) > 0.3);
    app.press(&["period"]);
    app.wait_for_title("a number", |title| title.contains("view normals:0.001"));
    app.press(&["comma"]);
    app.wait_for_title("no number", |title| title.contains("view normals,"));
}

#[test]
fn views_that_follow_each_other_quickly_were_dimmed_as_flashes() {
    let desktop = Desktop::start();
    let (app, picture) = paused(&desktop, &["--regions", "off"]);
    app.press(&["v"]);
    wait_until("the first view", || share(&app.picture(), &picture) > 0.3);
    for _ in 0..VIEWS.len() {
        app.press(&["v"]);
        std::thread::sleep(Duration::from_millis(60));
    }
    wait_until("the picture again", || {
        let now = app.picture();
        assert!(!is_dimmed(&now, &picture), "the picture is dimmed");
        share(&now, &picture) < 0.1
    });
}

#[test]
fn the_camera_is_turned_by_hand_and_given_back() {
    let desktop = Desktop::start();
    let (mut app, picture) = paused(&desktop, &["--regions", "off"]);
    drag(&app, (60, 10));
    wait_until("the turned picture", || share(&app.picture(), &picture) > 0.2);
    app.press(&["Home"]);
    wait_until("the scene's own picture", || app.picture() == picture);
    app.xdotool(&["mousemove", "--window", app.window(), "160", "90"]);
    app.xdotool(&["click", "--repeat", "4", "--delay", "30", "4"]);
    wait_until("a nearer picture", || share(&app.picture(), &picture) > 0.2);
    app.press(&["Home"]);
    wait_until("the scene's own picture again", || app.picture() == picture);
    // A click that does not move turns nothing, and two are a wish for full screen.
    app.xdotool(&["click", "1"]);
    std::thread::sleep(Duration::from_millis(700));
    assert!(app.picture() == picture, "a click moves the camera");
    drag(&app, (-40, 0));
    wait_until("the picture turned once more", || share(&app.picture(), &picture) > 0.1);
    // Another scene has its own camera again.
    app.press(&["n"]);
    app.wait_for_title("another scene", |title| !title.contains("speakers"));
    app.press(&["p"]);
    app.wait_for_title("the first scene", |title| title.contains("speakers"));
    wait_until("the scene's own picture at last", || app.picture() == picture);
}

#[test]
fn a_view_is_there_from_the_start() {
    let desktop = Desktop::start();
    let (mut app, _) = paused(&desktop, &["--view", "materials"]);
    app.wait_for_title("the view", |title| title.contains("view materials"));
    let still = desktop.folder().join("view.png");
    let mut command = desktop.command(crate::support::desktop::PROGRAM);
    command.args(["still", "--view", "materials", "--sdf", "compiled", "--size", SIZE, "-o"]).arg(&still);
    command.arg(desktop.folder().join("quiet.wav"));
    assert!(command.status().unwrap().success());
    let still = image::open(&still).unwrap().to_rgba8();
    wait_until("the still's picture in the window", || share(&app.picture(), &still) < 0.001);
}
