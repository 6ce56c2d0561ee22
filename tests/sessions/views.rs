//! Diagnostic views, and camera control.

use crate::support::apart::apart;
use std::time::Duration;

use crate::support::compare::{TIGHT, difference};
use crate::support::desktop::{PROGRAM, command_in};
use crate::support::session::{App, Place};
use image::RgbaImage;
use mariana::view::VIEWS;
use mariana_testing::process::output_of;

const SIZE: &str = "320x180";

fn still(place: &Place, options: &[&str]) -> RgbaImage {
    let output = place.path("still.png");
    let mut command = command_in(PROGRAM, place.folder(), None);
    command.arg("still").arg(place.path("quiet.wav")).args(options).args(["--size", SIZE, "-o"]).arg(&output);
    output_of(&mut command, "mariana").unwrap_or_else(|error| panic!("{error}"));
    image::open(&output).unwrap().to_rgba8()
}

fn paused(place: &Place, options: &[&str]) -> (App, RgbaImage) {
    let song = place.quiet_song("quiet.wav", 40);
    let app = place.open(&song, &[&["--size", SIZE, "--sdf", "compiled"], options].concat());
    app.press(&["space"]);
    app.wait_for_title("paused", |title| title.contains("paused"));
    app.press(&["Left", "Left", "Left", "Left"]);
    if !options.contains(&"--view") {
        let wanted = still(place, &[]);
        app.wait_for("the song's start", |picture| {
            let found = difference(picture, &wanted, TIGHT.visible);
            found.mean <= TIGHT.mean_max && found.fraction <= TIGHT.fraction_max
        });
    }
    let picture = app.wait_until_still();
    (app, picture)
}

fn fraction(a: &RgbaImage, b: &RgbaImage) -> f64 {
    difference(a, b, TIGHT.visible).fraction
}

fn is_dimmed(now: &RgbaImage, picture: &RgbaImage) -> bool {
    let light = |image: &RgbaImage| image.as_raw().iter().map(|byte| f64::from(*byte)).sum::<f64>();
    let bytes = || now.as_raw().iter().zip(picture.as_raw());
    let brighter = bytes().filter(|(now, byte)| **now > byte.saturating_add(8)).count();
    (brighter as f64) < 0.02 * picture.as_raw().len() as f64 && light(now) < 0.98 * light(picture)
}

fn drag(app: &App, (right, down): (i32, i32)) {
    let (x, y) = (160, 90);
    let place = |x: i32, y: i32| app.move_pointer(x.into(), y.into());
    place(x, y);
    app.hold_button(true);
    for step in 1..=4 {
        place(x + right * step / 4, y + down * step / 4);
    }
    app.hold_button(false);
}

#[test]
fn the_key_steps_through_the_views_and_the_title_names_them() {
    apart!();
    let place = Place::new();
    // Only some frames use cells. Without cells, all frames are equal bit for bit.
    let (app, picture) = paused(&place, &["--regions", "off"]);
    for row in &VIEWS {
        app.press(&["v"]);
        app.wait_for_title(row.name, |title| title.contains(&format!("view {}", row.name)));
        app.wait_until("the view", |app| fraction(&app.picture(), &picture) > 0.3);
    }
    app.press(&["shift+v"]);
    app.wait_for_title("the previous view", |title| title.contains("view materials"));
    app.press(&["v", "v"]);
    app.wait_for_title("no view", |title| !title.contains("view"));
    app.wait_until("the original frame", |app| app.picture() == picture);
    // These keys increase and decrease the number of a view.
    app.press(&["v", "v", "v"]);
    app.wait_for_title("normals", |title| title.contains("view normals"));
    app.wait_until("normals", |app| fraction(&app.picture(), &picture) > 0.3);
    app.press(&["period"]);
    app.wait_for_title("a number", |title| title.contains("view normals:0.001"));
    app.press(&["comma"]);
    app.wait_for_title("no number", |title| title.contains("view normals,"));
}

#[test]
fn quick_view_changes_are_not_dimmed_as_flashes() {
    apart!();
    let place = Place::new();
    let (app, picture) = paused(&place, &["--regions", "off"]);
    app.press(&["v"]);
    app.wait_until("the first view", |app| fraction(&app.picture(), &picture) > 0.3);
    for _ in 0..VIEWS.len() {
        app.press(&["v"]);
        app.run_for(Duration::from_millis(60));
    }
    app.wait_until("the original frame", |app| {
        let now = app.picture();
        assert!(!is_dimmed(&now, &picture), "the frame is dimmed");
        fraction(&now, &picture) < 0.1
    });
}

#[test]
fn the_camera_is_turned_and_reset() {
    apart!();
    let place = Place::new();
    let (app, picture) = paused(&place, &["--regions", "off"]);
    drag(&app, (60, 10));
    app.wait_until("the turned camera", |app| fraction(&app.picture(), &picture) > 0.2);
    app.press(&["Home"]);
    app.wait_until("the scene's own camera", |app| app.picture() == picture);
    app.move_pointer(160.0, 90.0);
    (0..4).for_each(|_| app.turn_wheel(1.0));
    app.wait_until("a nearer picture", |app| fraction(&app.picture(), &picture) > 0.2);
    app.press(&["Home"]);
    app.wait_until("the scene's own camera again", |app| app.picture() == picture);
    // A single click does not turn the camera. A double click would switch to full screen.
    app.click();
    assert!(app.wait_until_still() == picture, "a click moves the camera");
    drag(&app, (-40, 0));
    app.wait_until("the camera turned once more", |app| fraction(&app.picture(), &picture) > 0.1);
    // Another scene uses its own camera, and the first scene keeps its reset camera.
    app.press(&["n"]);
    app.wait_for_title("another scene", |title| !title.contains("speakers"));
    app.press(&["p"]);
    app.wait_for_title("the first scene", |title| title.contains("speakers"));
    app.wait_until("the scene's own camera at last", |app| app.picture() == picture);
}

#[test]
fn a_view_is_shown_from_the_start() {
    apart!();
    let place = Place::new();
    let (app, _) = paused(&place, &["--view", "materials"]);
    app.wait_for_title("the view", |title| title.contains("view materials"));
    let still = still(&place, &["--view", "materials", "--sdf", "compiled"]);
    app.wait_until("the image of the still", |app| fraction(&app.picture(), &still) < 0.001);
}

#[test]
fn the_ray_under_the_pointer_is_drawn_over_the_picture_and_follows_it() {
    apart!();
    let place = Place::new();
    let (app, picture) = paused(&place, &["--regions", "off"]);
    app.move_pointer(60.0, 60.0);
    app.press(&["shift+r"]);
    app.wait_until("the diagram", |app| fraction(&app.picture(), &picture) > 0.15);
    let first = app.wait_until_still();
    app.move_pointer(120.0, 130.0);
    app.wait_until("the diagram of another ray", |app| fraction(&app.picture(), &first) > 0.01);
    app.press(&["shift+r"]);
    app.wait_until("the original frame", |app| app.picture() == picture);
}
