//! The window responds while the show is idle, while a scene loads for minutes, and while a driver compiles.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::time::{Duration, Instant};

use crate::support::desktop::Desktop;
use crate::support::pings::{Pinger, Pings};
use crate::walls::{ripples, wait_for, wait_for_refusal, wall};
use mariana_testing::process::wait_until;
use mariana_testing::wave::write_wav;

fn desktop() -> Desktop {
    let desktop = Desktop::start();
    write_wav(&desktop.folder().join("quiet.wav"), 8_000, 2, std::iter::repeat_n(0.0, 2 * 8_000 * 200));
    desktop
}

/// The number of attempts to deliver a ping together with the reply for the last frame.
const STOPS: usize = 12;
/// A paused show draws its last frame after 0.4 s, so this time is longer.
const LAST_FRAME: Duration = Duration::from_millis(700);

#[test]
fn pings_are_answered_while_paused_and_while_a_scene_takes_minutes() {
    let desktop = desktop();
    let (song, scene) = (desktop.folder().join("quiet.wav"), desktop.folder().join("own.scene"));
    std::fs::write(&scene, "object ball { shape = sphere(p - vec3(0, 1, 0), 0.7 + 0.1 * sin(3 * t)) }")
        .unwrap();
    std::fs::write(desktop.folder().join("p_foam.scene"), ripples()).unwrap();
    let options = ["-v", "--silent", "--size", "160x90", "--scene", scene.to_str().unwrap()];
    let mut app = desktop.open_with(&[("MARIANA_FAULT", "little-patience@0")], &song, &options);
    app.wait_for_title("a scene", |title| title.contains(" - Mariana ("));
    let mut pinger = Pinger::connect(desktop.display(), app.window().parse().unwrap());
    for stop in 0..STOPS {
        app.press(&["space"]);
        app.wait_for_title("paused", |title| title.contains("paused"));
        // The last frame waits for a reply of the stopped X server. That reply and the ping arrive together.
        desktop.halt_server(true);
        drop(pinger.send());
        std::thread::sleep(LAST_FRAME);
        desktop.halt_server(false);
        let asked = Instant::now();
        assert!(pinger.wait(|| asked.elapsed() > Duration::from_secs(2)), "stop {stop}: no answer");
        app.press(&["space"]);
        app.wait_for_title("playing", |title| !title.contains("paused"));
    }
    drop(pinger);
    let pings = Pings::start(desktop.display(), app.window().parse().unwrap());
    app.press(&["n"]);
    wait_for_refusal(
        || app.reported(),
        || {
            let picture = app.picture();
            wait_until("another picture", || app.picture() != picture);
        },
    );
    app.press(&["space"]);
    app.wait_for_title("the previous scene, paused", |title| {
        title.contains("own") && title.contains("paused")
    });
    let answers = pings.stop();
    assert!(answers.count > 0 && answers.worst < Duration::from_secs(10), "{answers:?}");
}

#[test]
fn the_window_closes_while_a_driver_is_still_compiling() {
    let desktop = desktop();
    let (song, scene) = (desktop.folder().join("quiet.wav"), desktop.folder().join("own.scene"));
    std::fs::write(&scene, wall("vec3(1, 0, 0)")).unwrap();
    // This scene is long, but a scene twice as long would be refused.
    let heavy = "object balls { shape = smooth_union(5 - p.z, union(for i in 0..600: \
                 sphere(p - vec3(sin(i), cos(1.7 * i), 9 + i), 0.3 + 0.1 * sin(t + i))), 0.1) }";
    std::fs::write(desktop.folder().join("own2.scene"), heavy).unwrap();
    let options =
        ["--silent", "--size", "32x18", "--scene", scene.to_str().unwrap(), "--sdf", "compiled", "-v"];
    let stuck = [("MARIANA_FAULT", "endless-compiler@0")];
    let mut app = desktop.open_with(&stuck, &song, &options);
    // Look only at the upper half, which error panels do not cover.
    let is_red = |picture: &image::RgbaImage| {
        let upper = picture.enumerate_pixels().filter(|(_, y, _)| 2 * y < picture.height());
        let (red, others): (Vec<_>, Vec<_>) = upper.partition(|(_, _, pixel)| {
            let [red, green, blue, _] = pixel.0;
            red > 120 && green <= 120 && blue <= 120
        });
        red.len() > others.len()
    };
    wait_for(&app, "the first scene", is_red);
    app.press(&["n"]);
    app.wait_until_reported("own2 is requested, compiled");
    // Meanwhile the window shows the first scene in another size, and the message that the driver is still compiling.
    app.xdotool(&["windowsize", app.window(), "160", "240"]);
    app.wait_for_size((160, 240));
    wait_for(&app, "the first scene in another size", |picture| {
        picture.dimensions() == (160, 240) && is_red(picture)
    });
    app.press(&["q"]);
    let (status, reported) = app.wait_for_end();
    assert!(status.success(), "{status}: {reported}");
    assert!(
        reported.contains("ends without waiting for it") && !reported.contains("own2 is shown"),
        "{reported}"
    );
}
