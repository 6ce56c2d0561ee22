//! Stage controls: blackout, freeze, clean output, scenes by number, and corners.

use crate::support::apart::apart;
use crate::support::session::App;
use crate::walls::{BREATHES, Place, TWO_COLOURS, at, is_black, is_blue, is_red};
use image::RgbaImage;
use mariana::commands::Command;
use mariana::srgb::linear;

#[test]
fn a_blackout_ends_with_the_same_frame() {
    apart!();
    let place = Place::new(&[("two.scene", TWO_COLOURS)]);
    let app = place.open("two.scene", &["--blackout-fade", "0.4"]);
    let lit = app.wait_for("the picture", |picture| is_red(at(picture, 0.2, 0.5)));
    app.press(&["x"]);
    app.wait_for("black", |picture| picture.pixels().all(|pixel| pixel.0[..3] == [0; 3]));
    app.press(&["x"]);
    app.wait_for("the same frame", |picture| *picture == lit);
    app.quit();
    let app = place.open("two.scene", &["--brightness", "25"]);
    let value = |picture: &RgbaImage| linear(f32::from(at(picture, 0.2, 0.5)[0]) / 255.0);
    app.wait_for("a quarter of the light", |picture| (value(picture) / value(&lit) - 0.25).abs() < 0.02);
    app.quit();
}

#[test]
fn a_frozen_frame_stays_while_the_song_plays() {
    apart!();
    let place = Place::new(&[("breathes.scene", BREATHES), ("two.scene", TWO_COLOURS)]);
    let app = place.open("breathes.scene", &["--blackout-fade", "0"]);
    let first = app.picture();
    app.wait_for("a moving frame", |picture| *picture != first);
    app.press(&["z"]);
    let held = app.wait_until_still();
    // A scene that is selected during the freeze appears when the freeze ends.
    app.press(&["2"]);
    app.wait_for_title("the other scene", |title| title.contains("two"));
    assert!(app.picture() == held, "the frozen frame has changed");
    app.press(&["z"]);
    app.wait_for("the other scene", |picture| {
        is_red(at(picture, 0.2, 0.5)) && is_blue(at(picture, 0.8, 0.5))
    });
    app.quit();
}

#[test]
fn numbers_show_the_scenes_of_the_list() {
    apart!();
    let place = Place::new(&[("a.scene", "vec3(0.1)"), ("b.scene", "vec3(0.2)"), ("c.scene", TWO_COLOURS)]);
    let app = place.open("a.scene", &[]);
    for (key, name) in [("3", "(c,"), ("2", "(b,"), ("1", "(a,")] {
        app.press(&[key]);
        app.wait_for_title(name, |title| title.contains(name));
    }
    // A number without a scene has no effect.
    app.press(&["9", "3"]);
    app.wait_for_title("c", |title| title.contains("(c,"));
    app.wait_until_reported("message: c, 3 of ");
    // The message has the number by which a key shows the scene, also of a marked scene.
    app.command(Command::MarkScenes(["b".to_owned()].into()));
    app.press(&["1"]);
    app.wait_until_reported("message: b, 1 of ");
    app.press(&["2"]);
    app.wait_until_reported("message: a, 2 of ");
    app.quit();
}

fn grab_corner(app: &App) {
    app.press(&["y"]);
    app.wait_for("the panel", |picture| !is_red(at(picture, 0.4, 0.5)));
    app.move_pointer(10.0, 10.0);
    app.wait_for("the corner under the pointer", |picture| at(picture, 0.02, 0.02)[2] > 150);
    app.hold_button(true);
}

#[test]
fn one_key_hides_every_message_and_panel() {
    apart!();
    let place = Place::new(&[("two.scene", TWO_COLOURS)]);
    let app = place.open("two.scene", &["--flash-limiter", "off"]);
    let plain = app.wait_for("the picture", |picture| is_blue(at(picture, 0.8, 0.5)));
    app.press(&["g"]);
    app.wait_for("the settings", |picture| *picture != plain);
    app.press(&["w"]);
    app.wait_for("the frame without overlay", |picture| *picture == plain);
    // The key also hides errors until it is pressed again.
    let good = std::fs::read_to_string(place.path("two.scene")).unwrap();
    std::fs::write(place.path("two.scene"), "object o { shape = nonsense }").unwrap();
    app.wait_until_reported("has mistakes");
    assert!(app.picture() == plain, "the error is shown");
    app.press(&["w"]);
    app.wait_for("the mistake", |picture| *picture != plain);
    std::fs::write(place.path("two.scene"), good).unwrap();
    app.wait_for("the picture", |picture| *picture == plain);
    app.quit();
}

#[test]
fn the_output_is_mirrored_cropped_and_warped_at_its_corners() {
    apart!();
    let place = Place::new(&[("two.scene", TWO_COLOURS)]);
    let app = place.open("two.scene", &["--flip", "horizontal", "--crop", "0,0,25,0"]);
    // The crop removes a quarter at the right, so blue fills a third, and mirroring moves blue to the left.
    app.wait_for("the mirrored frame", |picture| {
        is_blue(at(picture, 0.3, 0.5)) && is_red(at(picture, 0.36, 0.5)) && is_red(at(picture, 0.95, 0.5))
    });
    app.quit();
    let app = place.open("two.scene", &["--corners", "0,0,100,50,100,100,0,100"]);
    app.wait_for("the warped frame", |picture| {
        is_black(at(picture, 0.9, 0.1)) && is_red(at(picture, 0.2, 0.5)) && is_blue(at(picture, 0.9, 0.8))
    });
    app.quit();
    let app = place.open("two.scene", &[]);
    app.wait_for("the picture", |picture| is_red(at(picture, 0.1, 0.1)));
    grab_corner(&app);
    let move_to = |x: u32, y: u32| app.move_pointer(x.into(), y.into());
    (1..=4).for_each(|step| move_to(10 + 30 * step, 10 + 10 * step));
    app.hold_button(false);
    app.wait_for("the corner", |picture| is_black(at(picture, 0.1, 0.05)) && is_red(at(picture, 0.1, 0.9)));
    app.press(&["y"]);
    app.quit();
    let app = place.open("two.scene", &[]);
    app.wait_for("the corner", |picture| is_black(at(picture, 0.1, 0.05)));
    app.press(&["y", "Home", "y"]);
    app.wait_for("the picture", |picture| is_red(at(picture, 0.02, 0.02)));
    app.quit();
}

#[test]
fn a_corner_that_is_held_when_its_panel_closes_is_saved() {
    apart!();
    let place = Place::new(&[("two.scene", TWO_COLOURS)]);
    let is_pulled = |picture: &RgbaImage| is_black(at(picture, 0.1, 0.05));
    let app = place.open("two.scene", &[]);
    app.wait_for("the picture", |picture| is_red(at(picture, 0.1, 0.1)));
    grab_corner(&app);
    let move_to = |x: u32, y: u32| app.move_pointer(x.into(), y.into());
    move_to(10, 10);
    move_to(70, 30);
    move_to(130, 50);
    app.wait_for("the corner", is_pulled);
    app.press(&["y"]);
    app.quit();
    let app = place.open("two.scene", &[]);
    app.wait_for("the corner", is_pulled);
    app.quit();
}

#[test]
fn the_preview_of_the_next_scene_moves_even_if_interpreted() {
    apart!();
    // The colour depends on the time, so that the preview at one time differs from the preview at another.
    let place = Place::new(&[
        ("a.scene", "vec3(0.5, 0.01, 0.01)"),
        ("b.scene", "vec3(0.01, 0.01, 0.35 + 0.008 * t)"),
    ]);
    let settings = place.settings();
    std::fs::create_dir_all(settings.parent().unwrap()).unwrap();
    std::fs::write(settings, "[choices]\nnext_scene = \"on\"\n").unwrap();
    let app = place.open("a.scene", &["--prepare-ahead", "on", "--sdf", "interpreted", "--fade", "0"]);
    app.wait_until_reported("b is ready ahead");
    let corner = |picture: &RgbaImage| at(picture, 0.87, 0.15);
    let mut last = corner(&app.wait_for("the next scene in the corner", |picture| is_blue(corner(picture))));
    app.press(&["space"]);
    app.wait_for_title("paused", |title| title.contains("paused"));
    for _ in 0..2 {
        app.press(&["Right"]);
        last = corner(&app.wait_for("another moment of the preview", |picture| {
            is_blue(corner(picture)) && corner(picture) != last
        }));
    }
    app.quit();
}

#[test]
fn the_preview_of_the_next_scene_uses_spare_time_only() {
    apart!();
    let red = "vec3(0.35 + 0.008 * t, 0.01, 0.01)";
    let blue = "vec3(0.01, 0.01, 0.35 + 0.008 * t)";
    let place = Place::new(&[("a.scene", red), ("b.scene", blue)]);
    let settings = place.settings();
    std::fs::create_dir_all(settings.parent().unwrap()).unwrap();
    std::fs::write(settings, "[choices]\nnext_scene = \"on\"\n").unwrap();
    let app = place.open("a.scene", &["--prepare-ahead", "on", "--sdf", "compiled", "-vv", "--fade", "0"]);
    app.wait_until_reported("b is ready ahead");
    let corner = |picture: &RgbaImage| at(picture, 0.87, 0.15);
    let first = app.wait_for("the next scene in the corner", |picture| is_blue(corner(picture)));
    assert!(is_red(at(&first, 0.3, 0.5)), "the frame itself shows another scene");
    // The preview shows the song's current time. A pause gives slow machines time to draw the preview.
    app.press(&["space"]);
    app.wait_for_title("paused", |title| title.contains("paused"));
    let before = corner(&app.picture());
    app.press(&["Right"]);
    app.wait_for("another moment of the preview", |picture| {
        is_blue(corner(picture)) && corner(picture) != before && corner(picture) != corner(&first)
    });
    // When the session shows the previewed scene, the preview shows another scene.
    app.press(&["n"]);
    app.wait_for("the next scene, and another preview", |picture| {
        is_blue(at(picture, 0.3, 0.5)) && !is_blue(corner(picture))
    });
    app.press(&["w"]);
    app.wait_for("a clean picture", |picture| is_blue(corner(picture)));
    let reported = app.quit();
    assert!(reported.contains("the next scene in "), "{reported}");
}

#[test]
fn a_window_shows_a_dome() {
    apart!();
    let place = Place::new(&[("two.scene", TWO_COLOURS)]);
    for how in ["interpreted", "compiled"] {
        let flags = ["--projection", "dome", "--dome-tilt", "90", "--sdf", how];
        let app = place.open("two.scene", &flags);
        let picture = app
            .wait_for("the disc", |picture| is_red(at(picture, 0.4, 0.5)) && is_blue(at(picture, 0.6, 0.5)));
        for x in [0.05, 0.95] {
            let around = at(&picture, x, 0.5);
            assert!(around.iter().all(|value| *value < 24), "no disc: {around:?} at {x}");
        }
        app.quit();
    }
}
