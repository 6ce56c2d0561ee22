//! "Surprise me": variations of a scene.

#![cfg(target_os = "linux")]

use crate::support::apart::apart;
use std::fs;

use crate::controllers::write_wall;
use crate::support::osc::Sender;
use crate::support::session::{self, App};
use image::RgbaImage;

fn open(place: &session::Place, osc: &Sender, options: &[&str]) -> App {
    let scene = write_wall(place);
    let own = ["--scene", scene.to_str().unwrap(), "--size", "64x36", "--osc", &osc.port.to_string()];
    let own = if options.contains(&"--scene") { &own[2..] } else { &own[..] };
    let app = place.open(&place.song(), &[own, &["--fade", "0"], options].concat());
    app.wait_until_reported("receiving OSC");
    app.wait_until_reported("first picture");
    app
}

fn variation(app: &App, osc: &Sender, number: f32) -> RgbaImage {
    osc.send("/surprise", &[number]);
    let shown = app.shown();
    let words = format!("variation {number}:");
    app.wait_until(&words, |app| app.reported().contains(&words) && app.shown() > shown);
    app.wait_until_still()
}

#[test]
fn a_surprise_is_had_again_by_its_number_and_goes_back_exactly() {
    apart!();
    let (place, osc) = (session::Place::with_song(), Sender::new());
    let app = open(&place, &osc, &[]);
    // The slider belongs to the scene itself.
    osc.send("/param/red", &[0.5]);
    app.take_steps(20);
    let itself = app.wait_until_still();
    app.press(&["F6"]);
    app.wait_until_reported("this is the scene itself");
    let first = variation(&app, &osc, 41.0);
    let second = variation(&app, &osc, 42.0);
    assert!(first != itself && second != first);
    app.press(&["F5"]);
    app.wait_until_reported_times(": F5 another", 3);
    app.press(&["F6"]);
    app.wait_for("the second variation", |picture| *picture == second);
    app.press(&["F6"]);
    app.wait_for("the first variation", |picture| *picture == first);
    app.press(&["F6"]);
    app.wait_for("the scene itself", |picture| *picture == itself);
    let files = || {
        fs::read_dir(place.folder())
            .unwrap()
            .flatten()
            .filter(|file| file.path().extension() == Some("scene".as_ref()))
    };
    assert_eq!(files().count(), 2, "nothing is saved");
    let again = variation(&app, &osc, 42.0);
    assert!(again == second, "a number makes the same variation again");
    app.press(&["F7"]);
    app.wait_until_reported("kept as ");
    let kept = fs::read_to_string(place.path("wall-42.scene")).unwrap();
    assert!(kept.contains(" in 0 .. 2\n"), "{kept}");
    let still = app.wait_until_still();
    assert!(still == second, "the kept scene looks the same");
    app.press(&["F7"]);
    app.wait_until_reported("only a variation can be kept");
    app.quit();
}

#[test]
fn a_shipped_scene_is_varied_and_kept_in_the_users_folder() {
    apart!();
    let (place, osc) = (session::Place::with_song(), Sender::new());
    let app = open(&place, &osc, &["--scene", "heart", "--sdf", "interpreted"]);
    let before = app.picture();
    osc.send("/surprise", &[7.0]);
    app.wait_until_reported("variation 7:");
    app.wait_for("another frame", |picture| *picture != before);
    app.wait_until_reported("heart-7 is shown");
    // The editor opens a saved scene.
    app.press(&["e"]);
    app.wait_until_reported("kept as ");
    assert!(place.path("data/scenes/heart-7.scene").is_file());
    app.press(&["Escape"]);
    app.quit();
}

#[test]
fn a_scene_without_numbers_is_not_varied() {
    apart!();
    let (place, osc) = (session::Place::with_song(), Sender::new());
    let plain = place.save("plain.scene", "length(p) - 1");
    let app = open(&place, &osc, &["--scene", plain.to_str().unwrap()]);
    app.press(&["F5"]);
    app.wait_until_reported("no parameter and no colour to vary");
    osc.send("/scene/wall", &[]);
    app.wait_until_reported("wall is shown");
    osc.send("/surprise", &[f32::MAX]);
    app.wait_until_reported("variation 16777216:");
    osc.send("/surprise", &[f32::NAN]);
    osc.send("/surprise", &[-7.0]);
    // Keys are faster than variations.
    app.press(&["F5", "F5", "F6", "F5", "n", "F5", "F6", "F7"]);
    app.take_steps(50);
    app.quit();
}

#[test]
fn the_scene_on_the_more_visible_deck_is_varied_and_kept_by_a_recording() {
    apart!();
    let (place, osc) = (session::Place::with_song(), Sender::new());
    let app = open(&place, &osc, &["--prepare-ahead", "on"]);
    app.press(&["F3"]);
    app.wait_until("two decks", |app| app.state().decks);
    app.wait_until_reported("is ready ahead");
    let on_a = app.wait_until_still();
    app.press(&["F8"]);
    let on_b = app.settled(&on_a, "deck B");
    let varied = variation(&app, &osc, 41.0);
    assert!(varied != on_b, "the variation is on the deck that cannot be seen");
    app.press(&["F6"]);
    app.wait_for("the scene on deck B itself", |picture| *picture == on_b);
    let again = variation(&app, &osc, 41.0);
    assert!(again == varied);
    app.press(&["F8"]);
    app.wait_for("deck A", |picture| *picture == on_a);
    // A variation of the other scene leaves the first on its deck.
    let on_a = variation(&app, &osc, 42.0);
    app.press(&["F8"]);
    app.wait_for("the variation on deck B", |picture| *picture == varied);
    app.press(&["F8"]);
    app.wait_for("the variation on deck A", |picture| *picture == on_a);
    // A recorded show names its scenes by their files.
    app.press(&["F9"]);
    app.wait_until_reported_times("kept as ", 2);
    let kept = |name: &str| place.path(name).is_file();
    assert!(
        kept("wall-42.scene")
            && fs::read_dir(place.folder())
                .unwrap()
                .flatten()
                .any(|file| { file.file_name().to_str().is_some_and(|name| name.ends_with("-41.scene")) })
    );
    app.quit();
}
