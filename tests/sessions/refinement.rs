//! A paused moment is refined by paths of light, in place.

#![cfg(target_os = "linux")]

use crate::support::apart::apart;
use crate::support::compare::{TIGHT, difference};
use crate::support::desktop::{PROGRAM, command_in};
use crate::support::session::{App, Place};
use image::RgbaImage;
use mariana_testing::process::output_of;

const SIZE: &str = "64x36";

/// A white corner, one wall of which is red: its light reaches the ball and the floor only by paths.
const SCENE: &str = "camera { position = vec3(0, 1.5, -5)  target = vec3(0, 1, 0) }\n\
    sky { color = vec3(0.02)  ambient = vec3(0.02) }\n\
    light lamp { position = vec3(-1, 3, -2)  color = vec3(12)  radius = 0.8 }\n\
    material white { color = vec3(0.8) }\n\
    material red { color = vec3(0.9, 0.05, 0.05) }\n\
    object floor { shape = p.y  material = white }\n\
    object wall { shape = 1.5 - p.x  material = red }\n\
    object ball { shape = sphere(p - vec3(0.2, 0.8, 0), 0.8)  material = white }";

fn mean(a: &RgbaImage, b: &RgbaImage) -> f64 {
    difference(a, b, TIGHT.visible).mean
}

/// A session that is paused on a scene, its picture, and the still of the scene by paths.
fn paused(place: &Place, mode: &str) -> (App, RgbaImage, RgbaImage) {
    place.save("corner.scene", SCENE);
    let (scene, song) = (place.path("corner.scene"), place.quiet_song("quiet.wav", 40));
    let (scene, output) = (scene.to_str().unwrap(), place.path("still.png"));
    let mut command = command_in(PROGRAM, place.folder(), None);
    command.args(["still", "--scene", scene, "--light", "path", "--size", SIZE, "-o"]).arg(&output);
    output_of(&mut command, "mariana").unwrap_or_else(|error| panic!("{error}"));
    let wanted = image::open(&output).unwrap().to_rgba8();
    let app = place.open(&song, &["--size", SIZE, "--fade", "0", "--sdf", mode, "--scene", scene]);
    app.press(&["space"]);
    app.wait_for_title("paused", |title| title.contains("paused"));
    let picture = app.wait_until_still();
    assert!(mean(&picture, &wanted) > 0.02, "paths make no difference: {}", mean(&picture, &wanted));
    (app, picture, wanted)
}

#[test]
fn a_paused_moment_becomes_the_still_of_paths_until_the_song_goes_on() {
    apart!();
    let place = Place::new();
    let (app, picture, wanted) = paused(&place, "compiled");
    app.press(&["shift+space"]);
    app.wait_for("the first paths", |now| *now != picture);
    app.wait_until_reported("refined with");
    assert!(app.reported().contains("refining: "), "{}", app.reported());
    let refined = app.wait_until_still();
    let (found, before) = (mean(&refined, &wanted), mean(&picture, &wanted));
    assert!(found < 0.05 * before, "the mean difference is {found}, and was {before}");
    app.press(&["space"]);
    app.wait_for("the scene's own light", |now| *now == picture);
}

#[test]
fn a_change_ends_the_refinement_and_the_key_begins_it_from_a_playing_song() {
    apart!();
    let place = Place::new();
    let (app, picture, _) = paused(&place, "interpreted");
    app.press(&["space"]);
    app.wait_for_title("playing", |title| !title.contains("paused"));
    app.press(&["shift+space"]);
    app.wait_for_title("paused again", |title| title.contains("paused"));
    app.wait_for("the first paths", |now| *now != picture);
    app.press(&["shift+space"]);
    app.wait_for("the scene's own light", |now| *now == picture);
    assert_eq!(app.wait_until_still(), picture);
    app.press(&["shift+space"]);
    app.wait_for("paths again", |now| *now != picture);
    place.save("corner.scene", &SCENE.replace("0.9, 0.05, 0.05", "0.05, 0.9, 0.05"));
    let green = app.settled(&picture, "the changed scene");
    assert!(mean(&green, &picture) > 0.01);
    let reported = app.reported();
    app.press(&["v"]);
    app.wait_for("a view", |now| mean(now, &green) > 0.01);
    let view = app.wait_until_still();
    app.press(&["shift+space"]);
    app.wait_until_reported("views show numbers");
    assert_eq!(app.wait_until_still(), view);
    assert!(!reported.contains("cannot draw paths"), "{reported}");
}
